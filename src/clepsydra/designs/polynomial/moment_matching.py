"""Reduction to second order with whole samples of delay, by the moments of the step response."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.models.transfer_element import TransferElement


def with_two_lags(element: TransferElement, period: float) -> TransferElement:
    """Return two lags, real or as a pair, and a delay of whole samples for a stable element.

    ln g(s) = ln k − m1 s + m2 s²/2 − m3 s³/3 + …, where every lag τ and the delay count in
    m1, and τ² and τ³ in m2 and m3; those of zeros with the other sign. With s = τ1 + τ2,
    two lags and a delay have the same three numbers where

        s³ − 3 m2 s + 2 m3 = 0,   delay = m1 − s.

    The delay is then rounded to samples, and the lags are chosen anew for m1 and m2. An
    integrator is kept, and what is left becomes one lag and a delay.

    Parameters
    ----------
    period : float
        [s]

    Raises
    ------
    NotApplicable
        The element is unstable, integrates more than once, or has zeros that outweigh its lags.

    References
    ----------
    F. P. Lees, The derivation of simple transfer function models of oscillating and inverting
    processes from the basic transformed equations using the method of moments, Chemical
    Engineering Science 26, 1971, doi 10.1016/0009-2509(71)87004-5.

    Examples
    --------
    Eight lags of 2 s become a pair of natural frequency 0.2 rad/s and seven samples of delay:

    >>> chain = TransferElement(3.08, (-0.5,) * 8, (), 0)
    >>> reduced = with_two_lags(chain, 1.0)
    >>> reduced.dead_time, round(float(abs(reduced.poles[0])), 3)
    (7.0, 0.202)
    """
    if any(pole.real >= 0.0 for pole in map(complex, element.poles)):
        raise NotApplicable("the element is unstable without control")
    if element.integrators > 1:
        raise NotApplicable(f"the element integrates {element.integrators} times")
    first, second, third = (_moment(element, power) for power in (1, 2, 3))
    first += element.dead_time
    if element.integrators == 1:
        lags, samples = _one(first, second, period)
    else:
        lags, samples = _two(first, second, third, period)
    if not lags:
        raise NotApplicable(
            "the zeros of the element outweigh its lags: no lags and delay stand for it"
        )
    return TransferElement(
        element.gain,
        tuple(-1.0 / lag for lag in lags),
        (),
        element.integrators,
        samples * period,
    )


def _moment(element: TransferElement, power: int) -> float:
    """Return the sum of the lags' powers less that of the zeros'."""
    total = sum((-1.0 / complex(pole)) ** power for pole in element.poles)
    total -= sum((-1.0 / complex(zero)) ** power for zero in element.zeros)
    return complex(total).real


def _one(first: float, second: float, period: float) -> tuple[list[complex], int]:
    lag = math.sqrt(max(second, 0.0))
    samples = max(math.floor((first - lag) / period + 0.5), 0)
    lag = first - samples * period
    return ([complex(lag)] if lag > 0.0 else []), samples


def _two(first: float, second: float, third: float, period: float) -> tuple[list[complex], int]:
    """Return the lags and the samples of delay; no lags where there are none."""
    sums = np.roots([1.0, 0.0, -3.0 * second, 2.0 * third])
    real = [root.real for root in sums if abs(root.imag) < 1e-6 * abs(root) and root.real > 0.0]
    if not real:
        return [], 0
    samples = max(math.floor((first - max(real)) / period + 0.5), 0)
    # Rounded up, the delay may leave less than two lags need: their product is 0 at the least.
    while samples and (first - samples * period) ** 2 < second:
        samples -= 1
    total = first - samples * period
    product = max(0.5 * (total**2 - second), 0.0)
    if total <= 0.0:
        return [], 0
    root = np.sqrt(complex(total**2 - 4.0 * product))
    larger = 0.5 * (total + root)
    smaller = product / larger
    return [larger, smaller] if abs(smaller) > 1e-9 * abs(larger) else [larger], samples
