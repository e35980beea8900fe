"""The half rule: models of first and second order with delay for elements with real roots."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from clepsydra.designs.applicability import NotApplicable

if TYPE_CHECKING:
    from clepsydra.designs.models.transfer_element import TransferElement

_ROUNDS = 100
#: A root turns into a time constant when its imaginary part is below this share of its size.
#: Multiple poles come out of an eigenvalue routine as a close ring around the true value.
_REAL = 1e-3
#: A lag below a lead is close to it when their ratio is below 1.6; at 1.6 itself it is not.
_CLOSE = 1.6 * (1.0 - 1e-9)


@dataclass(frozen=True)
class DelayedLags:
    """g(s) ≈ slope · e^(−θs) / ((s + 1/τ1)(τ2 s + 1)), that is gain k = slope·τ1.

    Parameters
    ----------
    slope : float
        k/τ1, [output unit / (input unit · s)]; it stays finite for an integrating element.
    time_constant : float
        τ1 [s], infinite for an integrating element.
    delay : float
        Effective delay θ [s].
    second_time_constant : float
        τ2 [s], zero for a model of first order.

    Examples
    --------
    >>> DelayedLags(slope=0.5, time_constant=4.0, delay=1.0).gain
    2.0
    """

    slope: float
    time_constant: float
    delay: float
    second_time_constant: float = 0.0

    @property
    def gain(self) -> float:
        """Static gain k."""
        return self.slope * self.time_constant


def half_rule(element: TransferElement, delay: float = 0.0, order: int = 1) -> DelayedLags:
    """Reduce an element to first or second order with delay by Skogestad's rules.

    Positive numerator time constants are paired with a denominator time constant and replaced
    by a gain, or by a shorter lag, in order of size (rules T1 to T3). The largest lags left are
    kept and half of the next is added to the last of them; the other half, all further lags, and
    the numerator time constants of zeros in the right half-plane become delay. Rules T1 to T3
    look at the effective delay, which they change: they are repeated until it stands still.

    Parameters
    ----------
    element : TransferElement
        Its dead time counts as delay.
    delay : float
        Delay of the loop outside the element: half a sampling period [s].
    order : {1, 2}
        How many lags are kept; there may be fewer.

    Raises
    ------
    NotApplicable
        The element is unstable, oscillates, has no lag, has more than one integrator, or has
        a zero at the origin.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309, section 2,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    1/((s + 1)(0.2 s + 1)), example E1 there, and four lags of 1 s as two:

    >>> from clepsydra.designs.models.transfer_element import TransferElement
    >>> model = half_rule(TransferElement(1.0, (-1.0, -5.0), (), 0))
    >>> model.time_constant, model.delay
    (1.1, 0.1)
    >>> half_rule(TransferElement(1.0, (-1.0,) * 4, (), 0), order=2)
    DelayedLags(slope=1.0, time_constant=1.0, delay=1.5, second_time_constant=1.5)
    """
    _check(element)
    lags = sorted((-1.0 / root.real for root in element.poles), reverse=True)
    leads = sorted((-1.0 / root.real for root in element.zeros if root.real < 0.0), reverse=True)
    inverse = sum(1.0 / root.real for root in element.zeros if root.real > 0.0)
    if element.integrators == 1:
        lags = [math.inf, *lags]
    fixed = delay + element.dead_time + inverse
    effective, delays = fixed, set()
    for _ in range(_ROUNDS):
        factor, left = _without_leads(lags, leads, effective)
        if not left:
            raise NotApplicable("no lag is left once its zeros are accounted for")
        shared = left[order] if len(left) > order else 0.0
        new = fixed + shared / 2.0 + sum(left[order + 1 :])
        if new == effective:
            break
        # Two answers that imply each other: the longer delay is the safer one.
        effective = max(new, effective) if new in delays else new
        delays.add(new)
    kept = left[:order]
    kept[-1] += shared / 2.0
    gain = element.gain * factor  # of an integrating element it is the slope already
    slope = gain if math.isinf(kept[0]) else gain / kept[0]
    return DelayedLags(slope, kept[0], effective, *kept[1:])


def _without_leads(
    lags: list[float], leads: list[float], delay: float
) -> tuple[float, list[float]]:
    """Return the gain factor and the lags that stand for Π(T0 s + 1)/Π(τ0 s + 1)."""
    factor, left = 1.0, list(lags)
    for lead in leads:
        if not left:
            break
        partner = _partner(lead, left)
        left.remove(partner)
        size = 1.0 if math.isinf(partner) else partner  # k/s is kτ/(τ s + 1) for τ → ∞
        if lead >= partner:  # rules T1, T1a, T1b
            factor *= max(lead, delay) / max(partner, delay)
        elif lead >= 5.0 * delay:  # rule T2
            factor *= lead / size
        else:  # rule T3
            capped = min(partner, 5.0 * delay)
            factor *= capped / size
            left = sorted([*left, capped - lead], reverse=True)
    return factor, left


def _partner(lead: float, lags: list[float]) -> float:
    """Return the lag that a lead is paired with: the next larger, or a close smaller one."""
    larger = min((lag for lag in lags if lag > lead), default=None)
    smaller = max((lag for lag in lags if lag <= lead), default=None)
    if larger is None:
        return max(lags)
    if smaller is not None and lead / smaller < larger / lead and lead / smaller < _CLOSE:
        return smaller
    return larger


def _check(element: TransferElement) -> None:
    element.check()
    if any(abs(root.imag) > _REAL * abs(root) for root in (*element.poles, *element.zeros)):
        raise NotApplicable("the element oscillates, the half rule needs real roots")
    if not element.poles and element.integrators == 0:
        raise NotApplicable("the element answers at once, it has no lag")
