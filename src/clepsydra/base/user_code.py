"""A user's Python file: run it, and say where it fails without a traceback."""

from __future__ import annotations

import hashlib
import sys
import traceback
from pathlib import Path
from types import ModuleType

from clepsydra.base.errors import InputError

_LONGEST = 150


def run_user_code(file: Path, content: bytes, purpose: str) -> ModuleType:
    """Run what was read of a Python file, with all rights of the user.

    What was read is run, and not what lies there: Python's own cache of compiled files knows a
    change by size and second.

    Parameters
    ----------
    content : bytes
        Of the file.
    purpose : str
        An identifier, part of the module's name.

    Raises
    ------
    InputError
        The code fails.

    Examples
    --------
    >>> run_user_code(Path("law.py"), b"gain = 2.0", "law").gain
    2.0
    >>> try:
    ...     run_user_code(Path("law.py"), b"gain = 2.0 / 0", "law")
    ... except InputError as error:
    ...     print(error.place, "|", error.value)
    law.py, line 1 | ZeroDivisionError: float division by zero
    """
    module = ModuleType(_module_name(file, content, purpose))
    module.__file__ = str(file)
    sys.modules[module.__name__] = module  # dataclasses look their module up here
    try:
        exec(compile(content, str(file), "exec", dont_inherit=True), module.__dict__)
    except (Exception, SystemExit) as error:
        del sys.modules[module.__name__]
        raise InputError(
            line_of(error, file), words_of(error), "Python that runs", "correct it"
        ) from None
    return module


def known_user_code(file: Path, content: bytes, purpose: str) -> ModuleType:
    """Return the module that this content made already; else run it, as `run_user_code`.

    Examples
    --------
    >>> law = run_user_code(Path("law.py"), b"gain = 2.0", "law")
    >>> known_user_code(Path("law.py"), b"gain = 2.0", "law") is law
    True
    """
    known = sys.modules.get(_module_name(file, content, purpose))
    return run_user_code(file, content, purpose) if known is None else known


def _module_name(file: Path, content: bytes, purpose: str) -> str:
    digest = hashlib.sha256(bytes(file) + b"\0" + content).hexdigest()
    return f"clepsydra_{purpose}_{digest}"


def line_of(error: BaseException, file: Path) -> str:
    """Return the file and its line in which an error came about."""
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename) == file
    ]
    line = lines[-1] if lines else None
    # A syntax error of the file itself was found before any of its lines ran.
    if isinstance(error, SyntaxError) and Path(error.filename or "") == file:
        line = error.lineno
    return f"{file.name}, line {line}" if line else file.name


def words_of(error: BaseException) -> str:
    """Return the kind and the first line of an error; of a syntax error without its place."""
    text = error.msg or "" if isinstance(error, SyntaxError) else str(error)
    first = next(iter(text.strip().splitlines()), "")
    return shortened(f"{type(error).__name__}: {first}" if first else type(error).__name__)


def shortened(text: str) -> str:
    """Return a text that fits a message: printable, and not too long."""
    text = text if text.isprintable() else ascii(text)
    return text[:_LONGEST] + "…" if len(text) > _LONGEST else text
