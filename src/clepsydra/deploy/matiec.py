"""matiec, the compiler of OpenPLC and Beremiz: Structured Text to C, and that to a library."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.base.standing import Standing, standing_at
from clepsydra.deploy.compiler import CompilationError, Compiler, find_compiler

#: Names the compiler where it is not on the path.
PLACE = "CLEPSYDRA_MATIEC"
#: What it makes is C that no strict warning would pass; no operation may be fused.
_FLAGS = ("-std=gnu99", "-O1", "-w", "-ffp-contract=off")
_SAID = 2000
#: A text takes a second; a compiler that hangs is stopped [s].
_PATIENCE = 600.0


class Absent(ClepsydraError):
    """A tool that this machine does not have; the message is the reason, in words.

    Examples
    --------
    >>> raise Absent("matiec's iec2c is missing")
    Traceback (most recent call last):
        ...
    clepsydra.deploy.matiec.Absent: matiec's iec2c is missing
    """


@dataclass(frozen=True)
class Matiec:
    """The compiler `iec2c` with its library, and the C compiler behind it.

    Parameters
    ----------
    program : Path
        iec2c.
    library : Path
        The folder with ieclib.txt; its C is in the folder C there.
    compiler : Compiler
    """

    program: Path
    library: Path
    compiler: Compiler

    def translate(self, text: str, folder: Path, options: tuple[str, ...] = ("-f",)) -> None:
        """Translate a text into C.

        Parameters
        ----------
        text : str
            Structured Text in the dialect "matiec".
        folder : Path
            Where the C is written; made if it is not there.
        options : tuple of str
            Of iec2c.

        Raises
        ------
        CompilationError
            It refuses the text; the message is what it says.
        """
        folder.mkdir(parents=True, exist_ok=True)
        source = folder / "printed.st"
        source.write_text(text, encoding="utf-8")
        places = ["-I", str(self.library), "-T", str(folder)]
        command = [str(self.program), *options, *places, str(source)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, errors="replace", timeout=_PATIENCE
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise CompilationError(f"{self.program}: {error}") from None
        if done.returncode != 0 or "error" in done.stderr:
            raise CompilationError(f"matiec refuses {source}: {done.stderr[:_SAID]}")

    def build(self, source: str, folder: Path, target: Path) -> Path:
        """Compile C that includes what was generated in a folder to a shared library.

        Raises
        ------
        CompilationError
            The C compiler does not accept it.
        """
        wrapper = folder / f"{target.stem}_wrapper.c"
        wrapper.write_text(source, encoding="utf-8")
        places = (f"-I{folder}", f"-I{self.library / 'C'}")
        return replace(self.compiler, flags=(*_FLAGS, *places)).build([wrapper], target)


def find_matiec() -> Matiec:
    """Return matiec as the environment names it by CLEPSYDRA_MATIEC, or as it is on the path.

    Raises
    ------
    Absent
        It is not there, its library is not beside it, or there is no C compiler.
    """
    named = os.environ.get(PLACE)
    found = named if named and _is_file(Path(named)) else shutil.which("iec2c")
    if not found:
        raise Absent(
            f"matiec's iec2c is neither where {PLACE} says nor on the path: build it from "
            "https://github.com/beremiz/matiec (autoreconf -i, ./configure, make)"
        )
    program = Path(found).resolve()
    beside = (program.parent / "lib", program.parents[1] / "lib",
              program.parents[1] / "share/matiec/lib")  # fmt: skip
    library = next((folder for folder in beside if _is_file(folder / "ieclib.txt")), None)
    if library is None:
        raise Absent(f"the library of {program}, lib/ieclib.txt, is not beside it")
    try:
        return Matiec(program, library, find_compiler("matiec"))
    except InputError as missing:
        raise Absent(str(missing)) from None


def _is_file(path: Path) -> bool:
    return standing_at(path, PLACE, "matiec's iec2c with its library") is Standing.FILE
