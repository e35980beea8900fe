"""Printed Structured Text made to run by matiec, the compiler of OpenPLC and Beremiz."""

import ctypes
import os
import shutil
import subprocess
from pathlib import Path

from scanned_library import ScannedLibrary
from tools import without

from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.instances import with_block_names
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.entries import is_ring
from clepsydra.program.owned_state import state_paths, with_owned_state

#: What makes its absence, or that of STruC++, a failure.
SWITCH = "CLEPSYDRA_REQUIRE_ST_COMPILERS"
#: What OpenPLC v3 calls it with, in webserver/scripts/compile_program.sh.
OPENPLC = ("-f", "-l", "-p", "-r", "-R", "-a")
_CTYPES = {"LREAL": "double", "REAL": "float", "DINT": "int32_t", "BOOL": "uint8_t"}


class Matiec:
    """The compiler `iec2c` with its library, named by CLEPSYDRA_MATIEC or found on the path."""

    def __init__(self) -> None:
        named = os.environ.get("CLEPSYDRA_MATIEC")
        found = named if named and Path(named).is_file() else shutil.which("iec2c")
        self.compiler = shutil.which("gcc") or shutil.which("cc")
        if not found or not self.compiler:
            without(
                "matiec's iec2c (CLEPSYDRA_MATIEC or on the path) or a C compiler is missing",
                SWITCH,
            )
        self.program = Path(found).resolve()
        self.library = next(
            (folder for folder in (self.program.parent / "lib", self.program.parents[1] / "lib",
                                   self.program.parents[1] / "share/matiec/lib")
             if (folder / "ieclib.txt").is_file()), None,
        )  # fmt: skip
        if self.library is None:
            without(f"the library of {self.program} is not beside it", SWITCH)

    def translate(self, text: str, folder: Path, options: tuple[str, ...] = ("-f",)) -> None:
        """Translate a text into C; what the compiler says fails the test."""
        folder.mkdir(parents=True, exist_ok=True)
        source = folder / "printed.st"
        source.write_text(text, encoding="utf-8")
        command = [
            str(self.program),
            *options,
            "-I",
            str(self.library),
            "-T",
            str(folder),
            str(source),
        ]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0 and "error" not in done.stderr, done.stderr[:2000] + text

    def build(self, source: str, folder: Path, name: str) -> ctypes.CDLL:
        """Compile C that includes what was generated, without fusing any operation."""
        path, target = folder / f"{name}_wrapper.c", folder / f"{name}.so"
        path.write_text(source, encoding="utf-8")
        options = ["-std=gnu99", "-O1", "-w", "-ffp-contract=off", "-shared", "-fPIC"]
        places = [f"-I{folder}", f"-I{self.library / 'C'}"]
        command = [self.compiler, *options, *places, "-o", str(target), str(path), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[:2000]
        return ctypes.CDLL(str(target))


HEAD = """#include "iec_std_lib.h"
TIME __CURRENT_TIME;
BOOL __DEBUG = 0;
"""

BLOCK = (
    HEAD
    + """#include "accessor.h"
#include "POUS.h"
#include "POUS.c"
static {block} instance;
void start(void) {{ {block}_init__(&instance, 0); }}
void scan(const double *given, double *found)
{{
{writes}
    {block}_body__(&instance);
{reads}
}}
"""
)


class CompiledByMatiec(ScannedLibrary):
    """A function block of matiec's C as a shared library, one instance of its state."""

    def __init__(
        self, program, folder: Path, precision="double", *, text="", options=("-f",)
    ) -> None:
        """Compile the text of the block, or another one that holds it."""
        super().__init__(program)
        matiec = Matiec()
        text = text or print_structured_text(program, precision=precision, dialect="matiec")
        matiec.translate(text, folder, options)
        writes = [
            f"    instance.{signal.identifier.upper()}.value = given[{place}];"
            for place, signal in enumerate(self._signals)
        ]
        # A structure is one value with members; a scalar is one.
        shown = [
            f"instance.{s.variable.upper()}.value{f'.{s.part.upper()}' if s.record else ''}"
            for s in program.outputs
        ]
        words = dialect_of("matiec").all_words
        paths = state_paths(with_block_names(with_owned_state(program), words))
        for entry, path in zip(program.state, paths, strict=True):
            name = f"instance.{'.'.join(path).upper()}"
            place = f".table[{name}_POSITION.value]" if is_ring(entry) else ""
            shown.append(f"{name}.value{place}")
        reads = [f"    found[{place}] = {value};" for place, value in enumerate(shown)]
        source = BLOCK.format(
            block=program.name.upper(), writes="\n".join(writes), reads="\n".join(reads)
        )
        self._take(matiec.build(source, folder, program.name), len(shown))
        self.begin()

    def begin(self) -> None:
        """Make the instance a new one."""
        self._library.start()
