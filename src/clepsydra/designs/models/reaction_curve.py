"""The reaction curve: the steepest tangent of a step response, and where it gets to 63 %."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.models.brent import lowest_between, root_between
from clepsydra.designs.models.delayed_lags import DelayedLags

if TYPE_CHECKING:
    from clepsydra.designs.models.transfer_element import TransferElement

_POINTS = 2000
#: The response is looked at for this many times the sum of its lags.
_LAGS = 12.0


class ReactionCurve(NamedTuple):
    """What Ziegler and Nichols, and Åström and Hägglund, read off a step response.

    Parameters
    ----------
    slope : float
        R, of the steepest tangent to the response to a unit step [output unit/(input unit·s)].
    delay : float
        L, where that tangent leaves the starting value [s].
    gain : float
        Static gain; infinite for an integrating element.
    time_constant : float
        T = T63 − L, with T63 the time to 63.2 % of the final value [s]; infinite for an
        integrating element.

    Examples
    --------
    >>> ReactionCurve(0.5, 1.0, 2.0, 4.0).model
    DelayedLags(slope=0.5, time_constant=4.0, delay=1.0, second_time_constant=0.0)
    """

    slope: float
    delay: float
    gain: float
    time_constant: float

    @property
    def model(self) -> DelayedLags:
        """The first-order model with delay of Åström and Hägglund, k/(T s + 1) e^(−Ls)."""
        if math.isinf(self.time_constant):
            return DelayedLags(self.slope, math.inf, self.delay)
        return DelayedLags(self.gain / self.time_constant, self.time_constant, self.delay)


def reaction_curve(element: TransferElement, delay: float) -> ReactionCurve:
    """Return the reaction curve of an element, from its exact step response.

    Of an integrating element the steepest tangent is the line that the response runs into.

    Parameters
    ----------
    element : TransferElement
        Stable, or integrating once, and no jump at the start of its response.
    delay : float
        Of the loop outside the element: half a sampling period [s].

    Raises
    ------
    NotApplicable
        The element is unstable, answers at once, holds no output, integrates more than once,
        or is without any delay or second lag, so that L is zero.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 2.

    Examples
    --------
    1/(s + 1)³ is steepest at 2 s, with a slope of 2/e²:

    >>> from clepsydra.designs.models.transfer_element import TransferElement
    >>> curve = reaction_curve(TransferElement(1.0, (-1.0, -1.0, -1.0), (), 0), 0.0)
    >>> round(curve.slope * math.exp(2.0), 6), round(curve.delay, 3)
    (2.0, 0.805)
    """
    element.check()
    if len(element.poles) + element.integrators <= len(element.zeros):
        raise NotApplicable("the element answers at once, it has no lag")
    late = delay + element.dead_time
    if element.integrators:
        lag = sum((-1.0 / root).real for root in map(complex, element.poles))
        lead = sum((-1.0 / root).real for root in map(complex, element.zeros))
        found = ReactionCurve(element.gain, late + lag - lead, math.inf, math.inf)
    else:
        found = _of_lags(element, late)
    if found.delay <= 0.0:
        raise NotApplicable("its step response has no delay to go by")
    return found


@lru_cache(maxsize=16)
def _of_lags(element: TransferElement, late: float) -> ReactionCurve:
    from scipy.linalg import expm

    A, B, C = _cascade(element)
    size = abs(element.gain)
    n = len(A)
    block = np.zeros((n + 1, n + 1), complex)
    block[:n, :n], block[:n, n] = A, B

    def response(time: float) -> tuple[float, float]:
        """Return the response to a unit step and its slope, per unit of static gain."""
        whole = expm(block * time)
        return float((C @ whole[:n, n]).real), float((C @ whole[:n, :n] @ B).real)

    span = _LAGS * sum(-1.0 / complex(root).real for root in element.poles)
    step = span / _POINTS
    advance = expm(block * step)
    states = np.zeros((_POINTS + 1, n + 1), complex)
    states[0, n] = 1.0
    for before, state in pairwise(states):
        np.matmul(advance, before, out=state)
    heights, slopes = (states[:, :n] @ C).real, (states @ block[:n].T @ C).real
    top = int(np.argmax(slopes))
    around = (max(top - 1, 0) * step, (top + 1) * step)
    at = lowest_between(lambda time: -response(time)[1], *around, 1e-9 * step)
    # The search stays off the ends of its interval, and a single lag is steepest at the start.
    at = at if response(at)[1] > slopes[0] else 0.0
    height, slope = response(at)
    aim = 1.0 - math.exp(-1.0)
    first = int(np.argmax(heights >= aim))
    to_63 = root_between(lambda time: response(time)[0] - aim, (first - 1) * step, first * step)
    early = at - height / slope
    return ReactionCurve(element.sign * size * slope, late + early, element.gain, to_63 - early)


def _cascade(element: TransferElement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A, B, C of Π(1 − s/z)/Π(1 − s/p) as a row of first-order sections.

    Each section is through + (1 − through)/(1 − s/p), with through = p/z where it has a zero.
    The coefficients are complex where the roots are; what leaves the last one is real.
    """
    poles, zeros = list(map(complex, element.poles)), list(map(complex, element.zeros))
    n = len(poles)
    A, B, C = np.zeros((n, n), complex), np.zeros(n, complex), np.zeros(n, complex)
    through = 1.0 + 0.0j  # from the input to the section
    for place, pole in enumerate(poles):
        A[place, :place] = -pole * C[:place]
        A[place, place] = pole
        B[place] = -pole * through
        passed = pole / zeros[place] if place < len(zeros) else 0.0
        C[:place] *= passed
        C[place] = 1.0 - passed
        through *= passed
    return A, B, C
