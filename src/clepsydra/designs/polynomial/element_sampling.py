"""Sampled transfer functions of continuous elements, their input held over each sample."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.polynomial.moment_matching import with_two_lags
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.sampled.sampled_process import held_over

#: Elements of more poles are reduced.
HIGHEST_ORDER = 2
#: The longest delay [samples]: the exact sampled loop, which holds it twice, is searched for its
#: peak many times.
LONGEST_DELAY = 60
#: A part of a sample below this counts as none.
_NOTHING = 1e-6


def sampled_transfer(
    numerator: Sequence[float], denominator: Sequence[float], delay: int, period: float
) -> SampledModel:
    """Return the sampled model of a continuous transfer function with delay.

    Parameters
    ----------
    numerator, denominator : sequence of float
        Coefficients of s, highest power first, of a strictly proper one.
    delay : int
        [samples]
    period : float
        [s]

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 2.

    Examples
    --------
    Eight tanks in series, equations (8) and (9) of Bobál et al.:

    >>> chain = np.array([1.0])
    >>> for _ in range(8):
    ...     chain = np.polymul(chain, [2.0, 1.0])
    >>> model = sampled_transfer([3.08], chain, delay=0, period=1.0)
    >>> model.order, round(model.static_gain, 6)
    (8, 3.08)
    """
    above, below = (np.trim_zeros(np.array(each), "f") for each in (numerator, denominator))
    b, a = _held(above / below[0], below / below[0], 0.0, period)
    return SampledModel(tuple(b), tuple(a), delay, period)


def sampled_element(element: TransferElement, period: float) -> SampledModel:
    """Return the sampled model of an element, of second order at most.

    An element of one or two poles is sampled exactly, with a dead time of any length: a part of
    a sample adds a coefficient to B. One of more poles is first reduced to two lags and whole
    samples of delay (`designs.polynomial.moment_matching`).

    Parameters
    ----------
    period : float
        [s]

    Raises
    ------
    NotApplicable
        The element answers at once, the input cannot hold the output, it cannot be reduced, or
        its delay is longer than 60 samples.

    Examples
    --------
    >>> model = sampled_element(TransferElement(2.0, (-0.1,), (), 0, 1.5), 1.0)
    >>> model.delay, len(model.numerator), round(model.static_gain, 9)
    (1, 2, 2.0)
    """
    order = len(element.poles) + max(element.integrators, 0)
    if element.integrators < 0:
        raise NotApplicable("the input cannot hold the output: its static gain is zero")
    if len(element.zeros) >= order:
        raise NotApplicable("the output answers at once, without a lag")
    if order > HIGHEST_ORDER:
        element = with_two_lags(element, period)
    steps = math.floor(element.dead_time / period + _NOTHING)
    late = max(element.dead_time / period - steps, 0.0)
    if steps > LONGEST_DELAY:
        raise NotApplicable(
            f"its delay of {element.dead_time:.3g} s is longer than {LONGEST_DELAY} sampling "
            f"periods of {period:g} s; sample more slowly"
        )
    above, below = _polynomials(element)
    b, a = _held(above, below, late if late > _NOTHING else 0.0, period)
    return SampledModel(tuple(b), tuple(a), steps, period)


def _polynomials(element: TransferElement) -> tuple[np.ndarray, np.ndarray]:
    """Return numerator and monic denominator of an element, highest power first."""
    above = np.real(np.poly(np.array(element.zeros))) if element.zeros else np.ones(1)
    below = np.real(np.poly(np.array([*element.poles, *[0.0] * element.integrators])))
    factor = element.gain * np.prod([-pole for pole in element.poles]).real
    factor /= np.prod([-zero for zero in element.zeros]).real if element.zeros else 1.0
    return factor * np.atleast_1d(above), np.atleast_1d(below)


def _held(
    above: np.ndarray, below: np.ndarray, late: float, period: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return b1, b2, … and a1 … an of a strictly proper transfer function.

    With a part `late` of a sample of delay the input changes within the sample, and B has one
    coefficient more (the modified z-transform). B is read off the response to an impulse.
    """
    n = len(below) - 1
    A, B = np.diag(np.ones(n - 1), 1), np.zeros((n, 1))
    A[-1], B[-1] = -below[:0:-1], 1.0
    C = np.zeros(n)
    C[: len(above)] = above[::-1]
    whole, first = held_over(A, B, period)
    if late:
        # What was held before acts for the part `late`, and then moves on by itself.
        rest, first = held_over(A, B, (1.0 - late) * period)
        _, before = held_over(A, B, late * period)
    poles = np.exp(np.roots(below) * period)
    a = np.real(np.poly(poles))
    state, count = first, n + (1 if late else 0)
    response = [float(C @ state[:, 0])]
    for step in range(1, count):
        state = whole @ state + (rest @ before if step == 1 and late else 0.0)
        response.append(float(C @ state[:, 0]))
    b = np.convolve(a, response)[:count]
    return b, a[1:]
