"""The structures of printed C: what a program takes, keeps and returns, with commented members."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.deploy.c99.language import TYPES
from clepsydra.deploy.c99.layout import instances
from clepsydra.deploy.printing.heading import comment, commented
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.owned_state import own_state
from clepsydra.program.program import Program

#: A line with its comment is no wider than this [characters].
WIDTH = 98
_PLACEHOLDER = "  char nothing; /* a structure of C99 has at least one member */"


class Structures:
    """Prints the structures of a program and of its blocks.

    Parameters
    ----------
    name : str
        What the names of all types begin with.
    real : str
        The type of a real number.
    origin : Origin, optional
        Where the numbers of the program come from; those of a block differ by instance.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> structures = Structures("law", "double")
    >>> print("\\n".join(structures.plain([Signal("u")], "law", "inputs", "Inputs.")))
    /* Inputs. */
    typedef struct {
      double u; /* [1] */
    } law_inputs;
    <BLANKLINE>
    """

    def __init__(self, name: str, real: str, origin: Origin | None = None) -> None:
        self._name = name
        self._origin = origin
        self._types = {**TYPES, "real": real}

    def parameters(self, program: Program) -> list[str]:
        """Return the structure of a program's parameters."""
        members = [
            line
            for entry in program.parameters
            for line in self._member(entry, comment(entry, source=self._source(entry)))
        ]
        return _structure(program.name, "parameters", "Parameters: constant or tuned.", members)

    def state(self, program: Program, name: str, title: str) -> list[str]:
        """Return the structure of what a program or a block keeps, its instances inside."""
        members = []
        counted = {ring.name: "turn" for ring in program.rings}
        for entry in own_state(program):
            about = comment(
                entry, source=self._source(entry), counted=counted.get(entry.name, "sample")
            )
            members += self._member(entry, about)
        for call in instances(program):
            kind = f"{block_name(self._name, call.program)}_state"
            line = f"  {kind} {call.identifier};"
            members += [line] if len(line) <= WIDTH else [f"  {kind}", f"      {call.identifier};"]
        return _structure(name, "state", title, members)

    def plain(self, entries: Sequence[Entry], name: str, what: str, title: str) -> list[str]:
        """Return the structure of inputs or outputs."""
        members = [line for entry in entries for line in self._member(entry, comment(entry))]
        return _structure(name, what, title, members)

    def _source(self, entry: Entry) -> str:
        return self._origin.source_of(entry) if self._origin else ""

    def _member(self, entry: Entry, about: str) -> list[str]:
        signal = signal_of(entry)
        size = f"[{entry.length}]" if is_ring(entry) else ""
        member = f"{self._types[signal.kind]} {signal.identifier}{size};"
        lines = commented(member, about, "/*", "*/", WIDTH - 2)
        if size:
            place = f"int32_t {signal.identifier}_position;"
            lines += commented(place, "[1] place of the oldest value", "/*", "*/", WIDTH - 2)
        return [f"  {line}" for line in lines]


def block_name(name: str, block: Program) -> str:
    """Return what the names of a block's types and function begin with.

    With the name of the program: two of them may stand in one file, each with blocks of its own.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> block_name("law", Program("filter", (), (), (), (), Block(0, (), ())))
    'law_filter'
    """
    return f"{name}_{block.name}"


def _structure(name: str, what: str, title: str, members: Sequence[str]) -> list[str]:
    end = f"}} {name}_{what};"
    return [f"/* {title} */", "typedef struct {", *(members or [_PLACEHOLDER]), end, ""]
