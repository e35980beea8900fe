"""Printed Structured Text made to run by STruC++, the newer compiler of OpenPLC."""

import ctypes
import os
import shutil
import subprocess
from pathlib import Path

from matiec import SWITCH
from scanned_library import ScannedLibrary
from tools import without

from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.instances import with_block_names
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.owned_state import state_paths, with_owned_state

BLOCK = """#include "printed.cpp"
static strucpp::{block} instance;
extern "C" void scan(const double *given, double *found)
{{
{writes}
    instance();
{reads}
}}
"""


class Strucpp:
    """The compiler's `cli.js`, named by CLEPSYDRA_STRUCPP, with Node and a compiler of C++."""

    def __init__(self) -> None:
        named = os.environ.get("CLEPSYDRA_STRUCPP", "")
        self.node, self.compiler = shutil.which("node"), shutil.which("g++")
        if not (Path(named).is_file() and self.node and self.compiler):
            without("STruC++ (cli.js, named by CLEPSYDRA_STRUCPP), node or g++ is missing", SWITCH)
        self.program = Path(named).resolve()
        self.headers = self.program.parents[2] / "src" / "runtime" / "include"

    def translate(self, text: str, folder: Path) -> None:
        """Translate a text into C++; what the compiler says fails the test."""
        folder.mkdir(parents=True, exist_ok=True)
        source = folder / "printed.st"
        source.write_text(text, encoding="utf-8")
        command = [self.node, str(self.program), str(source), "-o", str(folder / "printed.cpp")]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr

    def build(self, source: str, folder: Path) -> ctypes.CDLL:
        """Compile C++ that includes what was generated, without fusing any operation."""
        path, target = folder / "wrapper.cpp", folder / "printed.so"
        path.write_text(source, encoding="utf-8")
        options = ["-std=c++17", "-O1", "-w", "-ffp-contract=off", "-shared", "-fPIC"]
        places = [f"-I{folder}", f"-I{self.headers}"]
        command = [self.compiler, *options, *places, "-o", str(target), str(path)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[:2000]
        return ctypes.CDLL(str(target))


class CompiledByStrucpp(ScannedLibrary):
    """A function block of STruC++'s C++ as a shared library, one instance of its state."""

    def __init__(self, program, folder: Path, dialect: str = "matiec") -> None:
        super().__init__(program)
        compiler = Strucpp()
        compiler.translate(print_structured_text(program, dialect=dialect), folder)
        kinds = {"real": "double", "integer": "int32_t", "boolean": "bool"}
        writes = [
            f"    instance.{signal.identifier.upper()} = ({kinds[signal.kind]})given[{place}];"
            for place, signal in enumerate(self._signals)
        ]
        shown = [(f"instance.{s.identifier.upper()}", s.kind) for s in program.outputs]
        words = dialect_of(dialect).all_words
        paths = state_paths(with_block_names(with_owned_state(program), words))
        for entry, path in zip(program.state, paths, strict=True):
            signal = signal_of(entry)
            name = f"instance.{'.'.join(path).upper()}"
            place = f"[(int32_t){name}_POSITION]" if is_ring(entry) else ""
            shown.append((f"{name}{place}", signal.kind))
        reads = [
            f"    found[{place}] = (double)({kinds[kind]}){value};"
            for place, (value, kind) in enumerate(shown)
        ]
        source = BLOCK.format(
            block=program.name.upper(), writes="\n".join(writes), reads="\n".join(reads)
        )
        self._take(compiler.build(source, folder), len(shown))
