"""The ultimate gain and period of a loop: where proportional control alone swings for ever."""

from __future__ import annotations

import math
from functools import lru_cache, partial  # several rules ask for the point of the same element
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.models.brent import root_between

if TYPE_CHECKING:
    from clepsydra.designs.models.transfer_element import TransferElement

_POINTS_A_DECADE = 60


class UltimatePoint(NamedTuple):
    """The gain at which a proportional loop swings with constant amplitude, and its period.

    Parameters
    ----------
    gain : float
        Ku, signed as the controller's [input unit / output unit].
    period : float
        Tu [s]
    """

    gain: float
    period: float


@lru_cache(maxsize=16)
def ultimate_point(element: TransferElement, delay: float) -> UltimatePoint:
    """Return the ultimate gain and period of an element, exact with its dead time.

    At the ultimate frequency ω the loop is delayed by half a turn, arg g(jω) − ω θ = −π
    (or whole turns more), and Ku = 1/|g(jω)|, Tu = 2π/ω. Of several such frequencies it is
    the one where |g| is largest, which limits the gain first.

    Parameters
    ----------
    element : TransferElement
        Stable, or integrating.
    delay : float
        θ of the loop outside the element: half a sampling period [s].

    Raises
    ------
    NotApplicable
        The element is unstable, holds no output, or is never late by half a turn.

    References
    ----------
    J. G. Ziegler and N. B. Nichols, Optimum settings for automatic controllers,
    Transactions of the ASME 64(8), 1942, 759-765, doi 10.1115/1.4019264.

    Examples
    --------
    1/(s + 1)³ has Ku = 8 and Tu = 2π/√3:

    >>> from clepsydra.designs.models.transfer_element import TransferElement
    >>> lags = TransferElement(1.0, (-1.0, -1.0, -1.0), (), 0)
    >>> found = ultimate_point(lags, 0.0)
    >>> round(found.gain, 9), round(found.period * math.sqrt(3.0) / math.tau, 9)
    (8.0, 1.0)
    """
    element.check()

    def half_turns_late(omega: float, turn: int = 0) -> float:
        """Return how far the loop is behind −π, in whole turns and beyond one of them."""
        return (-math.pi - element.phase(omega) + omega * delay) / math.tau - turn

    grid = element.frequencies(delay, 1e4, _POINTS_A_DECADE)
    found: list[float] = []
    for (low, high), ends in zip(pairwise(grid), pairwise(map(half_turns_late, grid)), strict=True):
        # Whole numbers between the two are crossings; the first is enough of many.
        crossed = math.ceil(min(ends))
        if 0 <= crossed <= max(ends):
            late = partial(half_turns_late, turn=crossed)
            found.append(root_between(late, low, high, absolute=1e-15 * low, relative=1e-15))
    if not found:
        raise NotApplicable(
            "the element is never late by half a turn, so no gain is too large for it"
        )
    omega = max(found, key=element.magnitude)
    return UltimatePoint(element.sign / element.magnitude(omega), math.tau / omega)
