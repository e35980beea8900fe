"""Which elements of arrays an innermost loop of a routine keeps in registers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from clepsydra.program.routine import Element, Index, Step, Turns


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


def apart(one: Index, other: Index, around: Sequence[Turns]) -> bool:
    """Return whether two indices are known to differ in every turn of the loops around.

    Examples
    --------
    >>> i, j = Index(0, (("i", 1),)), Index(0, (("j", 1),))
    >>> loops = [Turns("i", Index(0), Index(5), ()), Turns("j", Index(0), i, ())]
    >>> apart(i, j, loops), apart(i, j + 1, loops)
    (True, False)
    """
    return _above_zero(one - other, around) or _above_zero(other - one, around)


def _above_zero(index: Index, around: Sequence[Turns]) -> bool:
    """Return whether an index is above zero where it is least."""
    for turns in reversed(around):
        factor = dict(index.factors).get(turns.index, 0)
        least = turns.first if factor > 0 else turns.stop - 1
        index = index + factor * (least - Index(0, ((turns.index, 1),)))
    return not index.factors and index.constant > 0


def _stays(element: Element, turns: Turns) -> bool:
    return turns.index not in dict(element.index.factors)


def _steps(turns: Turns) -> Iterator[Step]:
    return (each for each in turns.steps if isinstance(each, Step))


def _touched(turns: Turns) -> Iterator[Element]:
    for step in _steps(turns):
        yield from (*step.read, step.written)
