"""Printed Structured Text made to run by matiec, the compiler of OpenPLC and Beremiz."""

import ctypes
from pathlib import Path

from scanned_library import ScannedLibrary
from tools import without

from clepsydra.deploy.matiec import Absent, find_matiec
from clepsydra.deploy.matiec_block import MATIEC_HEAD as HEAD  # noqa: F401
from clepsydra.deploy.matiec_block import matiec_block
from clepsydra.deploy.structured_text.printer import print_structured_text

#: What makes its absence, or that of STruC++, a failure.
SWITCH = "CLEPSYDRA_REQUIRE_ST_COMPILERS"
#: What OpenPLC v3 calls it with, in webserver/scripts/compile_program.sh.
OPENPLC = ("-f", "-l", "-p", "-r", "-R", "-a")


class Matiec:
    """matiec as it is found; its absence skips the test."""

    def __init__(self) -> None:
        try:
            self._found = find_matiec()
        except Absent as reason:
            without(str(reason), SWITCH)
        self.translate = self._found.translate

    def build(self, source: str, folder: Path, name: str) -> ctypes.CDLL:
        """Compile C that includes what was generated, without fusing any operation."""
        return ctypes.CDLL(str(self._found.build(source, folder, folder / f"{name}.so")))


class _Block:
    """One instance of a block, with the functions that a scanned library has."""

    def __init__(self, library: ctypes.CDLL) -> None:
        library.block_size.restype = ctypes.c_ulong
        self._instance = ctypes.create_string_buffer(library.block_size())
        self._library = library

    def start(self) -> None:
        self._library.block_power(self._instance, None)

    def scan(self, given: ctypes.Array, found: ctypes.Array) -> None:
        self._library.block_scan(self._instance, given, found)


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
        source = matiec_block(program, self._signals, precision, states=True)
        block = _Block(matiec.build(source, folder, program.name))
        self._take(block, len(program.outputs) + len(program.state))
        self.begin()

    def begin(self) -> None:
        """Make the instance a new one."""
        self._library.start()
