"""PI and PID settings from a phase margin at a crossover frequency, and the way back."""

from __future__ import annotations

import cmath
import math
from functools import cache

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.multiloop import DERIVATIVE_FILTER
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.models.bisection import last_before
from clepsydra.designs.models.brent import lowest_between
from clepsydra.designs.models.transfer_element import TransferElement


def pi_for_margin(
    element: TransferElement, delay: float, phase_margin: float, crossover: float
) -> PidSettings:
    """Return the PI that gives an element this phase margin at this crossover.

    The PI must lag by φ = π − φm + arg g(jω) − ωθ at the crossover ω, and make |g C| one there.
    Since arg C = −atan(1/(ω Ti)) and \\|C| = K/cos φ::

        Ti = 1/(ω tan φ),   K = cos φ/|g(jω)|

    Parameters
    ----------
    element : TransferElement
        Stable, or integrating.
    delay : float
        θ [s]
    phase_margin : float
        φm [rad]
    crossover : float
        ω [rad/s]

    Raises
    ------
    NotApplicable
        φ is not between 0° and 90°: no PI has that phase.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 6.

    Examples
    --------
    An integrator 1/s, 45° at 1 rad/s: the PI lags by 45° itself.

    >>> setting = pi_for_margin(TransferElement(1.0, (), (), 1), 0.0, math.pi / 4, 1.0)
    >>> round(setting.gain, 6), round(setting.integral_time, 6)
    (0.707107, 1.0)
    """
    lag = lag_needed(element, delay, phase_margin, crossover)
    if not 0.0 < lag < math.pi / 2.0:
        needed = "lead by" if lag <= 0.0 else "lag by"
        raise NotApplicable(
            f"at {crossover:.3g} rad/s the controller would have to {needed} "
            f"{abs(math.degrees(lag)):.0f}° for a margin of {math.degrees(phase_margin):.0f}°, and "
            f"a PI lags by 0° to 90°; choose a {'lower' if lag <= 0.0 else 'higher'} crossover"
            + (" or a PID" if lag <= 0.0 else "")
        )
    gain = element.sign * math.cos(lag) / element.magnitude(crossover)
    return PidSettings(gain, 1.0 / (crossover * math.tan(lag)))


def pid_for_margin(
    element: TransferElement, delay: float, phase_margin: float, crossover: float
) -> PidSettings:
    """Return the PID with Ti = 4 Td that gives an element this phase margin at this crossover.

    With x = ω Td and the filter Td/N of its derivative, the controller at the crossover ω is::

        C/K = 1 + 1/(4 j x) + j x/(1 + j x/N)

    Its phase grows with x up to some 56°, and must be φm − π − arg g(jω) + ωθ; K makes |g C|
    one. Ti = 4 Td gives two equal zeros, the fastest integral for the lead asked of it.

    Parameters
    ----------
    element : TransferElement
        Stable, or integrating.
    delay : float
        θ [s]
    phase_margin : float
        φm [rad]
    crossover : float
        ω [rad/s]

    Raises
    ------
    NotApplicable
        The controller would have to lead by more than that, or lag by 90° or more.

    References
    ----------
    K. J. Åström and T. Hägglund, Automatic tuning of simple regulators with specifications on
    phase and amplitude margins, Automatica 20(5), 1984, 645-651,
    doi 10.1016/0005-1098(84)90014-1.

    Examples
    --------
    Two integrators' worth of lag, 1/(s + 1)² at 10 rad/s, and 45° of margin:

    >>> lags = TransferElement(1.0, (-1.0, -1.0), (), 0)
    >>> setting = pid_for_margin(lags, 0.0, math.pi / 4, 10.0)
    >>> setting.integral_time / setting.derivative_time
    4.0
    >>> [round(value, 9) for value in margin_of(lags, 0.0, setting)]
    [10.0, 0.785398163]
    """
    lead = -lag_needed(element, delay, phase_margin, crossover)
    high = _place_of_largest_lead()
    if not -0.5 * math.pi < lead < phase_of_pid(high):
        too_fast = lead > 0.0
        raise NotApplicable(
            f"at {crossover:.3g} rad/s the controller would have to "
            f"{'lead' if too_fast else 'lag'} by {abs(math.degrees(lead)):.0f}° for a margin of "
            f"{math.degrees(phase_margin):.0f}°, and a PID leads by "
            f"{math.degrees(phase_of_pid(high)):.0f}° at most and lags by less than 90°; choose a "
            f"{'lower' if too_fast else 'higher'} crossover"
        )
    turned = last_before(1e-9, high, lambda x: phase_of_pid(x) < lead)
    derivative_time = turned / crossover
    unit = PidSettings(1.0, 4.0 * derivative_time, derivative_time)
    size = element.magnitude(crossover) * abs(_response(unit, crossover))
    return unit._replace(gain=element.sign / size)


def _response(setting: PidSettings, omega: float) -> complex:
    """Return C(jω) of a PID controller with the filter Td/10 of its derivative."""
    gain, integral_time, derivative_time = setting
    s = 1j * omega
    filtered = 1.0 + s * derivative_time / DERIVATIVE_FILTER
    return gain * (1.0 + 1.0 / (s * integral_time) + s * derivative_time / filtered)


def phase_of_pid(x: float) -> float:
    """Return the phase [rad] of a PID with Ti = 4 Td at ω = x/Td."""
    return cmath.phase(_response(PidSettings(1.0, 4.0 * x, x), 1.0))


@cache
def _place_of_largest_lead() -> float:
    """Return the x at which the phase of the PID is largest."""
    return math.exp(
        lowest_between(lambda x: -phase_of_pid(math.exp(x)), 0.0, math.log(100.0), 1e-10)
    )


def margin_of(element: TransferElement, delay: float, setting: PidSettings) -> tuple[float, float]:
    """Return the crossover [rad/s] and phase margin [rad] of one loop by itself.

    The crossover is where |g C| falls through one; it is unique for an element without
    resonance, whose magnitude falls with frequency.

    Examples
    --------
    >>> integrator = TransferElement(1.0, (), (), 1)
    >>> crossover, margin = margin_of(integrator, 0.0, PidSettings(0.5**0.5, 1.0))
    >>> round(crossover, 6), round(math.degrees(margin), 6)
    (1.0, 45.0)
    """

    def above_one(omega: float) -> bool:
        return abs(_response(setting, omega)) * element.magnitude(omega) > 1.0

    high = 1e-9
    while above_one(high) and high < 1e9:
        high *= 2.0
    crossover = last_before(0.5 * high, high, above_one)
    turned = cmath.phase(_response(setting._replace(gain=1.0), crossover))
    return crossover, math.pi + element.phase(crossover) - crossover * delay + turned


def lag_needed(element: TransferElement, delay: float, phase_margin: float, omega: float) -> float:
    """Return how far the controller may lag at a frequency for a phase margin [rad].

    Examples
    --------
    >>> math.degrees(lag_needed(TransferElement(1.0, (), (), 1), 0.0, math.pi / 4, 1.0))
    45.0
    """
    return math.pi - phase_margin + element.phase(omega) - omega * delay
