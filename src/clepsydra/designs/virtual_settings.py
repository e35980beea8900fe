"""Settings of the PI controller of a linearised output."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.base.arguments import is_finite_number, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.rounding import rounded
from clepsydra.controllers.virtual_input import AlphaOn, VirtualAntiWindup
from clepsydra.designs.arguments.argument import flag, word
from clepsydra.designs.arguments.numbers import ALPHA
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.loops.closed_loop_time import CLOSED_LOOP_TIME
from clepsydra.designs.request import positive_number
from clepsydra.designs.sampled.sampled_process import held_over
from clepsydra.designs.sampled.setpoint_response import settled_after

#: Instants of a response in the time constant of its fastest mode.
_FINE = 0.02
#: What feedback linearisation may be asked for.
ARGUMENTS = (
    MEASUREMENTS,
    CLOSED_LOOP_TIME,
    word("anti_windup", "what integrals do while an output is at a limit", VirtualAntiWindup),
    ALPHA,
    word("alpha_on", "where α leads back", AlphaOn),
    flag("despite_unstable_internal_dynamics", "`true` shows what happens"),
)


class VirtualSettings(NamedTuple):
    """d^r y/dt^r = Kp (b r − y) + Ki ∫ (r − y) dt − Σ m_k dᵏy/dtᵏ of one output.

    Parameters
    ----------
    gain, integral_gain : float
        Kp [1/s^r] and Ki [1/s^(r+1)].
    setpoint_weight : float
        b
    damping : tuple of float
        m_1, …, m_(r−1).

    Examples
    --------
    >>> VirtualSettings(0.2, 0.01).setpoint_weight
    1.0
    """

    gain: float
    integral_gain: float
    setpoint_weight: float = 1.0
    damping: tuple[float, ...] = ()


def settings_for(time_constant: float, degree: int) -> VirtualSettings:
    """Return the settings with which y follows r as 1/(τ s + 1)^r.

    All poles stand at −1/τ, (s + 1/τ)^(r+1), and b = 1/(r + 1) puts the zero on one of them.

    Parameters
    ----------
    time_constant : float
        τ [s]
    degree : int
        r

    Examples
    --------
    >>> settings_for(10.0, 1)
    VirtualSettings(gain=0.2, integral_gain=0.01, setpoint_weight=0.5, damping=())
    """
    coefficients = [
        math.comb(degree + 1, power) / time_constant ** (degree + 1 - power)
        for power in range(degree + 1)
    ]
    return VirtualSettings(
        coefficients[1], coefficients[0], 1.0 / (degree + 1), tuple(coefficients[2:])
    )


def settling_time(settings: VirtualSettings, degree: int) -> float:
    """Return how long an output takes to settle to 2 % after a setpoint step, as designed [s].

    Of (b Kp s + Ki)/(s^(r+1) + m_(r−1) s^r + … + Kp s + Ki), which is all that is left of the
    process while no input saturates.

    Parameters
    ----------
    degree : int
        r

    Examples
    --------
    1/(10 s + 1) settles to 2 % in 10 ln 50 = 39.1 s:

    >>> round(settling_time(settings_for(10.0, 1), 1))
    39
    """
    order = degree + 1
    polynomial = np.array(
        [settings.integral_gain, settings.gain, *settings.damping], float
    )  # from s⁰ on
    A = np.diag(np.ones(order - 1), 1)
    A[-1] = -polynomial
    numerator = np.zeros(order)
    numerator[:2] = settings.integral_gain, settings.setpoint_weight * settings.gain
    driven = np.eye(order)[:, -1:]
    # Equal poles are known to a few digits only, and the time is a whole number of periods.
    period = rounded(_FINE / float(np.max(np.abs(np.linalg.eigvals(A)))), 2)
    held, moved = held_over(A, driven, period)
    return settled_after(held, moved[:, 0], numerator, period)


def checked_settings(
    settings: Sequence[VirtualSettings], names: Sequence[str], degrees: Sequence[int]
) -> list[VirtualSettings]:
    """Refuse settings with which an output would not come to rest at its setpoint.

    Parameters
    ----------
    names : sequence of str
        The outputs.
    degrees : sequence of int
        Their relative degrees.

    Raises
    ------
    InputError

    Examples
    --------
    >>> checked_settings([VirtualSettings(0.1, 0.0)], ["level"], [1])
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: settings of level, integral gain: got 0.0, \
expected a number above zero; give Ki above zero: without it a load leaves an offset.
    """
    example = "write as in [VirtualSettings(0.2, 0.01)]"
    expected = "a list of VirtualSettings"
    settings = sequence_of(settings, VirtualSettings, "settings", expected, example)
    if len(settings) != len(names):
        raise InputError("settings", len(settings), f"{len(names)} settings", "give one an output")
    for setting, degree, name in zip(settings, degrees, names, strict=True):
        place, damping, weight = f"settings of {name}", setting.damping, setting.setpoint_weight
        remedy = "give Ki above zero: without it a load leaves an offset"
        integral = setting.integral_gain
        positive_number(f"{place}, integral gain", integral, "a number above zero", remedy)
        if len(damping) != degree - 1:
            expected = f"{degree - 1} numbers: its relative degree is {degree}"
            raise InputError(f"{place}, damping", list(damping), expected, "give m_1 to m_(r−1)")
        if not is_finite_number(weight) or not 0.0 <= weight <= 1.0:
            raise InputError(f"{place}, setpoint weight", weight, "0 to 1", "give a share")
        polynomial = [1.0, *reversed(damping), setting.gain, integral]
        if not all(map(is_finite_number, polynomial)) or np.max(np.roots(polynomial).real) >= 0.0:
            expected = "settings with which the output comes to rest"
            remedy = "raise the gain, or lower the integral gain"
            raise InputError(place, setting._asdict(), expected, remedy)
    return list(settings)
