"""A user's own step law, from a Python file: expressions, or any Python."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.signal import Signal
from clepsydra.base.user_code import (
    known_user_code,
    line_of,
    run_user_code,
    shortened,
    words_of,
)
from clepsydra.base.vanishing import vanishing
from clepsydra.controllers import signals
from clepsydra.controllers.own_signals import OwnSignals
from clepsydra.controllers.python_law import Step, python_law
from clepsydra.program.step_law import StepLaw

#: What the file of a law is run for.
_PURPOSE = "own_law"
_EXAMPLE = "law = step_law(…), or a function step(state, inputs, parameters, time_step)"


def load_law(path: str | Path) -> StepLaw:
    """Run a Python file and return the step law that it writes.

    To load a law is to run the file with all rights of the user: open only files that you trust.
    The file holds one of these:

    - ``law = step_law(…)``, a law of expressions: it is compiled, batched and exported;
    - a function ``step(state, inputs, parameters, time_step)`` that returns the next state and the
      outputs, and beside it ``inputs``, ``outputs``, ``parameters`` and ``state``, each a list of
      signals or names, or a dictionary of names with their values: a law in Python, the slow path;
    - ``law``, a class or an object with such a method and such attributes.

    A law that gives pump.status beside pump.out is taken as it is. All others give what is asked
    for in automatic, and mode, limits, sensor faults and the status word are added
    (`OwnSignals`). An idiom that vanishes where a law is written as expressions is among its notes
    (`vanishing`).

    Raises InputError: there is no such file, it fails, or it holds no proper law.

    Examples
    --------
    >>> load_law("no-such-law.py")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: no-such-law.py: got no such file, expected a Python file \
with a step law; check the path.
    """
    require_type(path, (str, Path), "law", "the path of a Python file", "give it as text or Path")
    file = Path(path)
    content = read_input(file, "a Python file with a step law", inside="the .py file")
    file = file.resolve()
    module = run_user_code(file, content, _PURPOSE)
    law = getattr(module, "law", None)
    if isinstance(law, StepLaw):
        notes = (each.told(file.name) for each in vanishing(content))
        return replace(_whole(law, file), notes=(*law.notes, *notes))
    if law is None and not callable(getattr(module, "step", None)):
        raise InputError(file.name, Finding("no law"), _EXAMPLE, "add one of the two")
    return _python(module if law is None else law, file, content)


def _whole(law: StepLaw, file: Path) -> StepLaw:
    """Return a law of expressions with what a plant needs."""
    moved, told = (signals.owners(law.outputs, part) for part in ("out", "status"))
    if told:
        if moved != told or len(law.outputs) > 2 * len(moved):
            raise InputError(
                f"{file.name}, outputs", ", ".join(signal.name for signal in law.outputs),
                "out and status of each output, or no status at all",
                "give both, or leave the status to be added",
            )  # fmt: skip
        return law
    return OwnSignals(file.name, law.inputs, law.parameters, law.outputs, law.state).whole_law(law)


class _StepOfFile:
    """The step that a Python file writes; pickled, it is the file, which runs where it arrives."""

    def __init__(self, file: Path, content: bytes, step: Step | None = None) -> None:
        self._file, self._content = file, content
        if step is None:
            module = known_user_code(file, content, _PURPOSE)
            step = _made(getattr(module, "law", module), file).step
        self.__wrapped__ = step

    def __call__(self, *given: Any) -> Any:
        return self.__wrapped__(*given)

    def __reduce__(self) -> tuple[type[_StepOfFile], tuple[Path, bytes]]:
        return _StepOfFile, (self._file, self._content)


def _made(holder: Any, file: Path) -> Any:
    """Return what declares a law in Python: a module or an object, of a class one of its kind."""
    if not inspect.isclass(holder):
        return holder
    try:
        return holder()
    except Exception as error:
        raise InputError(
            f"{line_of(error, file)}, law", words_of(error),
            "a class that is made without arguments", "give its arguments default values",
        ) from None  # fmt: skip


def _python(holder: Any, file: Path, content: bytes) -> StepLaw:
    """Return a law in Python from what declares it: a module, a class or an object."""
    holder = _made(holder, file)
    step = getattr(holder, "step", None)
    if not callable(step):
        raise InputError(f"{file.name}, law", shortened(repr(holder)), _EXAMPLE, "add its step")
    found = {
        what: _declared(getattr(holder, what, ()), f"{file.name}, {what}")
        for what in ("inputs", "outputs", "parameters", "state")
    }
    name = re.sub(r"\W", "_", file.stem)
    name = name if name[0].isalpha() else f"law_{name}"
    return python_law(name, _StepOfFile(file, content, step), **found, file=file)


def _declared(declared: object, place: str) -> tuple[Signal, ...]:
    """Return signals from a list of signals or names, or names with values."""
    if isinstance(declared, Mapping):
        entries: list[object] = []
        for name, value in declared.items():
            proper = isinstance(name, str) and isinstance(value, (int, float))
            entries.append(Signal(name, initial=float(value)) if proper else (name, value))
    elif isinstance(declared, (list, tuple)):
        entries = [Signal(entry) if isinstance(entry, str) else entry for entry in declared]
    else:
        entries = [declared]
    found = []
    for entry in entries:
        if not isinstance(entry, Signal) or not all(map(str.isidentifier, entry.name.split("."))):
            raise InputError(
                place, shortened(entry.name if isinstance(entry, Signal) else repr(entry)),
                "a list of names or signals, or a dictionary of names and numbers",
                'write as in parameters = {"gain": 2.0}',
            )  # fmt: skip
        found.append(entry)
    return tuple(found)
