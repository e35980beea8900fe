"""The C compiler of this machine, and a shared library by it under strict warnings."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.base.standing import Standing, standing_at

#: Printed C must pass these; no multiplication may be fused into an addition.
STRICT = (
    "-std=c99", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror",
    "-ffp-contract=off",
)  # fmt: skip
_NAMES = ("gcc", "clang", "cc")
_LONGEST = 20
#: One library takes seconds; a compiler that hangs is stopped [s].
_PATIENCE = 600.0


class CompilationError(ClepsydraError):
    """The compiler refused a printed source; the message is the compiler's.

    Examples
    --------
    >>> raise CompilationError("law.c:3:1: error: expected ';'")
    Traceback (most recent call last):
        ...
    clepsydra.deploy.compiler.CompilationError: law.c:3:1: error: expected ';'
    """


@dataclass(frozen=True)
class Compiler:
    """A C compiler.

    Parameters
    ----------
    command : tuple of str
        How it is called.
    version : str
        What it says of itself.
    flags : tuple of str

    Examples
    --------
    >>> Compiler(("gcc",), "gcc 13.2.0").flags[0]
    '-std=c99'
    """

    command: tuple[str, ...]
    version: str
    flags: tuple[str, ...] = STRICT

    def build(self, sources: Sequence[Path], target: Path) -> Path:
        """Compile sources to a shared library and return its path.

        Raises
        ------
        CompilationError
            The compiler does not accept a source: an error, or a warning of the strict set.
        """
        target.unlink(missing_ok=True)
        # Windows has neither position-independent code nor a library of mathematics of its own.
        plain = sys.platform == "win32"
        position, mathematics = ([], []) if plain else (["-fPIC"], ["-lm"])
        command = [*self.command, *self.flags, "-shared", *position, "-o", str(target)]
        command += [*map(str, sources), *mathematics]
        done = _run(command)
        if done.returncode != 0 or (
            standing_at(target, "compiler", "a shared library") is not Standing.FILE
        ):
            said = (done.stderr or done.stdout).strip().splitlines()
            more = [f"… and {len(said) - _LONGEST} lines more"] if len(said) > _LONGEST else []
            raise CompilationError(
                "\n".join([f"{self.version} refuses {sources[0].name}:", *said[:_LONGEST], *more])
            )
        return target


def library_name(name: str) -> str:
    """Return the file name of a shared library on this system.

    Examples
    --------
    >>> library_name("law").startswith("law.")
    True
    """
    ending = {"win32": "dll", "darwin": "dylib"}.get(sys.platform, "so")
    return f"{name}.{ending}"


def find_compiler(place: str) -> Compiler:
    """Return gcc, clang or cc of this machine, else the compiler of the package ziglang.

    Parameters
    ----------
    place : str
        What needs it, for the message.

    Raises
    ------
    InputError
        There is none, or it does not run.

    Examples
    --------
    >>> find_compiler("proof").version != ""
    True
    """
    path = next(filter(None, map(shutil.which, _NAMES)), None)
    if path is not None:
        command: tuple[str, ...] = (path,)
    elif importlib.util.find_spec("ziglang") is not None:
        command = (sys.executable, "-m", "ziglang", "cc")
    else:
        raise InputError(
            place,
            "no C compiler",
            "gcc, clang or cc, or the package ziglang",
            "install gcc, or pip install 'clepsydra[zig]'",
        )
    done = _run([*command, "--version"])
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip().splitlines()[-1:]
        raise InputError(
            place, ": ".join([" ".join(command), *said]), "a C compiler that runs",
            "mend it, or install gcc, or pip install 'clepsydra[zig]'",
        )  # fmt: skip
    first, *_ = done.stdout.strip().splitlines() or [Path(command[0]).name]
    return Compiler(command, first if path else f"zig cc, {first}")


def _run(command: list[str]) -> subprocess.CompletedProcess[str]:
    # In the C locale a message is the same everywhere.
    try:
        return subprocess.run(
            command,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PATIENCE,
            env={**os.environ, "LC_ALL": "C"},
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return subprocess.CompletedProcess(command, 1, "", f"{command[0]}: {error}")
