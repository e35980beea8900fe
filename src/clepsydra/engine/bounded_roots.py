"""Finds the roots of what is larger than a number by its form."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from clepsydra.engine.refined_root import LARGEST, SMALLEST_ENDLESS
from clepsydra.engine.steps import Bounded, Step
from clepsydra.program.operation import Operation


def with_bounded_roots(steps: Iterable[Step], made: Mapping[int, Operation]) -> Iterator[Step]:
    """Yield the steps, and of each root of a maximum with a constant that it is bounded.

    Parameters
    ----------
    steps : iterable of Step
    made : mapping
        Value to the operation that makes it.

    Examples
    --------
    >>> one, larger = Operation(1, "constant", (), 1.0), Operation(2, "maximum", (0, 1))
    >>> [root] = with_bounded_roots([Operation(3, "square_root", (2,))], {1: one, 2: larger})
    >>> root.endless
    True
    """
    for step in steps:
        if isinstance(step, Operation) and _is_bounded(step, made):
            yield Bounded(step, endless=True)
        else:
            yield step


def _is_bounded(operation: Operation, made: Mapping[int, Operation]) -> bool:
    larger = made.get(operation.arguments[0]) if operation.code == "square_root" else None
    if larger is None or larger.code != "maximum":
        return False
    found = (made.get(value) for value in larger.arguments)
    return any(
        each is not None
        and each.code == "constant"
        and SMALLEST_ENDLESS <= each.constant <= LARGEST
        for each in found
    )
