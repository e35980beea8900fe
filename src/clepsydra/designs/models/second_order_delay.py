"""The half rule for PID: a second-order model with delay for an element with real roots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from clepsydra.designs.models.first_order_delay import reduced_lags

if TYPE_CHECKING:
    from clepsydra.designs.models.transfer_element import TransferElement


@dataclass(frozen=True)
class SecondOrderDelay:
    """g(s) ≈ slope · e^(−θs) / ((s + 1/τ1)(τ2 s + 1)).

    Parameters
    ----------
    slope : float
        k/τ1 [output unit / (input unit · s)]
    time_constant : float
        τ1 [s], infinite for an integrating element.
    second_time_constant : float
        τ2 [s], zero where the element has one lag only.
    delay : float
        Effective delay θ [s].
    """

    slope: float
    time_constant: float
    second_time_constant: float
    delay: float


def half_rule_of_second_order(element: TransferElement, delay: float = 0.0) -> SecondOrderDelay:
    """Reduce an element to second order with delay by Skogestad's rules.

    As `first_order_delay.half_rule`, but the two largest lags are kept, and half of the third
    is added to the second.

    Parameters
    ----------
    delay : float
        Of the loop outside the element: half a sampling period [s].

    Raises
    ------
    NotApplicable
        As for the half rule of first order.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309, section 2,
    doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    >>> from clepsydra.designs.models.transfer_element import TransferElement
    >>> model = half_rule_of_second_order(TransferElement(1.0, (-1.0,) * 4, (), 0))
    >>> model.second_time_constant, model.delay
    (1.5, 1.5)
    """
    slope, lags, effective = reduced_lags(element, delay, 2)
    return SecondOrderDelay(slope, lags[0], lags[1] if len(lags) > 1 else 0.0, effective)
