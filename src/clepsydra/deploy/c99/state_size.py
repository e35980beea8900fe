"""How much memory the state of printed C takes."""

from __future__ import annotations

from collections.abc import Iterator

from clepsydra.deploy.c99.layout import instances
from clepsydra.deploy.printing.precision import Precision
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.owned_state import own_state, with_owned_state
from clepsydra.program.program import Program

_REAL = {"double": 8, "single": 4}
_POSITION = 4


def state_size(program: Program, precision: Precision = "double") -> int:
    """Return the size of the state structure, for one instance [bytes].

    As compilers lay structures out where every type stands at a multiple of its own size (64-bit
    processors, ARM): on 32-bit x86 of Unix, where doubles stand at multiples of four bytes, it
    may be four bytes less.

    Parameters
    ----------
    program : Program
    precision : {"double", "single"}

    Examples
    --------
    A state of three numbers and a truth value, and a delay by ten samples with its position:

    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.delay_ring import DelayRing
    >>> from clepsydra.program.program import Block
    >>> state = (Signal("a"), Signal("b"), Signal("c"), Signal("hand", kind="boolean"),
    ...          DelayRing(Signal("flow", "m^3/s"), 10))
    >>> program = Program("law", state, (), (), (), Block(5, (), (0, 1, 2, 3, 4)))
    >>> state_size(program), state_size(program, "single")
    (120, 60)
    """
    return _extent(with_owned_state(program), precision)[0]


def _extent(program: Program, precision: Precision) -> tuple[int, int]:
    """Return the size of a structure and that of its widest member's type [bytes]."""
    size, widest = 0, 1
    for width, aligned in _members(program, precision):
        size += -size % aligned + width
        widest = max(widest, aligned)
    return max(size + -size % widest, 1), widest


def _members(program: Program, precision: Precision) -> Iterator[tuple[int, int]]:
    """Yield of each member how much it takes, and at a multiple of what it stands [bytes]."""
    widths = {"real": _REAL[precision], "integer": 4, "boolean": 1}
    for entry in own_state(program):
        width = widths[signal_of(entry).kind]
        if is_ring(entry):
            yield width * entry.length, width
            yield _POSITION, _POSITION
        else:
            yield width, width
    for call in instances(program):
        yield _extent(call.program, precision)
