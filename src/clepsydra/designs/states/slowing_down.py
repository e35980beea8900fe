"""Slowing a design down until its loop is robust."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.detuning import SENSITIVITY_LIMIT

#: The most that a design is slowed down by.
LARGEST_FACTOR = 1000.0
_STEP = math.sqrt(2.0)
#: The search ends with a peak this near below the limit, a share of it.
_ACCURACY = 1e-3
_ITERATIONS = 40

T = TypeVar("T")


class SlowedDown(NamedTuple, Generic[T]):
    """A design, the factor that it is slower by, and the peak of its sensitivity.

    Examples
    --------
    >>> SlowedDown("gains", 1.0, 1.6).peak
    1.6
    """

    design: T
    factor: float
    peak: float


def slow_down(
    design_at: Callable[[float], T], peak: Callable[[T], float], method: str
) -> SlowedDown[T]:
    """Return the fastest design whose loop has a sensitivity peak of 2 or less.

    An optimal regulator has wide margins where it acts on the measured state; with an observer
    it may have none at all (Doyle), so that the peak of the sensitivity is computed and not
    trusted. Feedback of less gain needs less of the model, down to none at all for a process
    that is stable by itself: a factor F ≥ 1 grows by half an octave until the peak is at most
    2, and is then brought back to where it is 2.

    Parameters
    ----------
    design_at : callable
        Takes F and returns a design that is slower by F.
    peak : callable
        Takes a design and returns the peak of its sensitivity, infinite where it is unstable.
    method : str
        For the message.

    Raises
    ------
    NotApplicable
        No factor up to 1000 is enough.

    References
    ----------
    J. C. Doyle, Guaranteed margins for LQG regulators, IEEE Transactions on Automatic Control
    23(4), 1978, 756-757, doi 10.1109/TAC.1978.1101812.

    Examples
    --------
    >>> found = slow_down(lambda factor: 3.0 / factor, lambda gain: 1.0 + gain, "by hand")
    >>> round(found.factor, 2)
    3.0
    """
    low, high = 1.0, 1.0
    best = design_at(1.0)
    value = smallest = peak(best)
    while value > SENSITIVITY_LIMIT:
        if high >= LARGEST_FACTOR:
            raise NotApplicable(method, _hopeless(smallest))
        low, high = high, min(high * _STEP, LARGEST_FACTOR)
        best = design_at(high)
        value = peak(best)
        smallest = min(smallest, value)
    for _ in range(_ITERATIONS):
        if low == high or value >= SENSITIVITY_LIMIT * (1.0 - _ACCURACY):
            break
        middle = math.sqrt(low * high)
        tried = design_at(middle)
        found = peak(tried)
        if found <= SENSITIVITY_LIMIT:
            best, value, high = tried, found, middle
        else:
            low = middle
    return SlowedDown(best, high, value)


def note_on_slowing(found: SlowedDown[T], what: str) -> tuple[str, ...]:
    """Return a note where a design was slowed down.

    Examples
    --------
    >>> note_on_slowing(SlowedDown(None, 1.0, 1.5), "the regulator")
    ()
    """
    if found.factor == 1.0:
        return ()
    return (
        f"{what[0].upper()}{what[1:]} was slowed down {found.factor:.3g} times, so that the loop "
        f"keeps a sensitivity peak of at most {SENSITIVITY_LIMIT:g}.",
    )


def _hopeless(smallest: float) -> str:
    reached = (
        "every loop is unstable"
        if math.isinf(smallest)
        else f"the best sensitivity peak is {smallest:.2f}"
    )
    return (
        f"slowing it down by up to {LARGEST_FACTOR:.0f} times does not bring the sensitivity peak "
        f"to {SENSITIVITY_LIMIT:g}: {reached}"
    )
