"""Whether two indices of a routine can be the same number."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.program.routine import Index, Turns


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
