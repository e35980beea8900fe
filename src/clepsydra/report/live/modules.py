"""The modules of a page: each program once."""

from __future__ import annotations

from clepsydra.engine.web_assembly import web_assembly
from clepsydra.program.program import Program
from clepsydra.report.live.packed import packed


class Modules:
    """WebAssembly modules, of which equal ones are one.

    Attributes
    ----------
    held : list of str
        As a page holds them.
    """

    def __init__(self) -> None:
        self.held: list[str] = []

    def add(self, program: Program, *, record: bool = True) -> int:
        """Return the number of the module of a program."""
        module = packed(web_assembly(program, record=record))
        if module not in self.held:
            self.held.append(module)
        return self.held.index(module)
