"""Which elements of arrays an innermost loop of a routine keeps in registers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from clepsydra.program.apart import apart
from clepsydra.program.routine import Element, Step, Turns


def accumulated(turns: Turns, around: Sequence[Turns]) -> list[Element]:
    """Return the elements that every turn may read and write in a register.

    They stand in the same place in each turn, and no turn reaches for them by another index.

    Parameters
    ----------
    turns : Turns
        A loop without loops inside.
    around : sequence of Turns
        The loops around it, the outermost first.
    """
    touched = list(_touched(turns))
    return [
        element
        for element in dict.fromkeys(step.written for step in _steps(turns))
        if _stays(element, turns)
        and all(
            other == element or apart(element.index, other.index, [*around, turns])
            for other in touched
            if other.array == element.array
        )
    ]


def unchanged(turns: Turns) -> list[Element]:
    """Return the elements that every turn reads in the same place, and whose array none writes."""
    written = {step.written.array for step in _steps(turns)}
    return [
        element
        for element in dict.fromkeys(each for step in _steps(turns) for each in step.read)
        if _stays(element, turns) and element.array not in written
    ]


def _stays(element: Element, turns: Turns) -> bool:
    return turns.index not in dict(element.index.factors)


def _steps(turns: Turns) -> Iterator[Step]:
    return (each for each in turns.steps if isinstance(each, Step))


def _touched(turns: Turns) -> Iterator[Element]:
    for step in _steps(turns):
        yield from (*step.read, step.written)
