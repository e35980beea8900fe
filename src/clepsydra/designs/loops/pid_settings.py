"""The settings of one PID controller, and its three algebraic forms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

from clepsydra.base.errors import InputError

Action = Literal["reverse", "direct"]


class PidSettings(NamedTuple):
    """Settings in ISA form, C(s) = K (1 + 1/(Ti s) + Td s).

    Parameters
    ----------
    gain : float
        K [input unit / output unit]; positive where the input must rise when the measurement
        falls (reverse acting), negative where it must fall (direct acting).
    integral_time : float
        Ti [s]; infinite without integral action.
    derivative_time : float
        Td [s]; zero without derivative action.

    Examples
    --------
    >>> PidSettings(3.0, 30.0).derivative_time
    0.0
    """

    gain: float
    integral_time: float = math.inf
    derivative_time: float = 0.0

    @property
    def action(self) -> Action:
        """Whether the input rises or falls when the measurement falls: the sign of the gain.

        People read and write a gain without its sign, and the action beside it.
        """
        return "direct" if self.gain < 0.0 else "reverse"


class SeriesSettings(NamedTuple):
    """Settings in series (interacting) form, C(s) = K' (1 + 1/(Ti' s)) (1 + Td' s)."""

    gain: float
    integral_time: float = math.inf
    derivative_time: float = 0.0


class ParallelSettings(NamedTuple):
    """Settings in parallel form, C(s) = K + Ki/s + Kd s.

    Parameters
    ----------
    gain : float
        K [input unit / output unit]
    integral_gain : float
        Ki [input unit / (output unit · s)]
    derivative_gain : float
        Kd [input unit · s / output unit]
    """

    gain: float
    integral_gain: float = 0.0
    derivative_gain: float = 0.0


def from_series(settings: SeriesSettings) -> PidSettings:
    """Return the ISA form of a series form.

    With f = 1 + Td'/Ti': K = K' f, Ti = Ti' f, Td = Td'/f.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 3.

    Examples
    --------
    >>> from_series(SeriesSettings(2.0, 10.0, 2.5))
    PidSettings(gain=2.5, integral_time=12.5, derivative_time=2.0)
    """
    factor = 1.0 + settings.derivative_time / settings.integral_time
    return PidSettings(
        settings.gain * factor,
        settings.integral_time * factor,
        settings.derivative_time / factor,
    )


def to_series(settings: PidSettings, place: str = "series form") -> SeriesSettings:
    """Return the series form of an ISA form, Ti' the larger of its two times.

    With r = √(1 − 4 Td/Ti): K' = K (1 + r)/2, Ti' = Ti (1 + r)/2, Td' = Ti (1 − r)/2.

    Parameters
    ----------
    place : str
        For the message.

    Raises
    ------
    InputError
        Ti < 4 Td: the zeros of the controller are complex, and the series form has real ones.

    Examples
    --------
    >>> to_series(PidSettings(2.5, 12.5, 2.0))
    SeriesSettings(gain=2.0, integral_time=10.0, derivative_time=2.5)
    """
    gain, integral_time, derivative_time = settings
    if derivative_time == 0.0 or math.isinf(integral_time):
        return SeriesSettings(gain, integral_time, derivative_time)
    inside = 1.0 - 4.0 * derivative_time / integral_time
    if inside < 0.0:
        given = f"Ti = {integral_time:.4g} s with Td = {derivative_time:.4g} s"
        expected = "an integral time of at least four times the derivative time"
        remedy = "use the ISA or the parallel form, or shorten the derivative time"
        raise InputError(place, given, expected, remedy)
    half = 0.5 * (1.0 + math.sqrt(inside))
    # Ti' Td' = Ti Td, which loses no digits where Td is small.
    return SeriesSettings(gain * half, integral_time * half, derivative_time / half)


def to_parallel(settings: PidSettings) -> ParallelSettings:
    """Return the parallel form: Ki = K/Ti, Kd = K Td.

    Examples
    --------
    >>> to_parallel(PidSettings(2.0, 10.0, 2.5))
    ParallelSettings(gain=2.0, integral_gain=0.2, derivative_gain=5.0)
    """
    gain, integral_time, derivative_time = settings
    return ParallelSettings(gain, gain / integral_time, gain * derivative_time)


def from_parallel(settings: ParallelSettings, place: str = "parallel form") -> PidSettings:
    """Return the ISA form of a parallel form: Ti = K/Ki, Td = Kd/K.

    Raises
    ------
    InputError
        K is zero, or the three gains have not one sign: there is no ISA form.

    Examples
    --------
    >>> from_parallel(ParallelSettings(2.0, 0.2, 5.0))
    PidSettings(gain=2.0, integral_time=10.0, derivative_time=2.5)
    """
    gain, integral_gain, derivative_gain = settings
    if gain == 0.0 or gain * integral_gain < 0.0 or gain * derivative_gain < 0.0:
        expected = "a proportional gain that is not zero and other gains of its sign"
        remedy = "correct the gains, or keep the parallel form"
        raise InputError(place, tuple(settings), expected, remedy)
    integral_time = gain / integral_gain if integral_gain else math.inf
    return PidSettings(gain, integral_time, derivative_gain / gain)


def slowed_down(settings: Sequence[PidSettings], factor: float) -> tuple[PidSettings, ...]:
    """Return the settings with K/F and F·Ti, Luyben's detuning; Td stays.

    Examples
    --------
    >>> slowed_down([PidSettings(3.0, 30.0)], 2.0)
    (PidSettings(gain=1.5, integral_time=60.0, derivative_time=0.0),)
    """
    return tuple(
        PidSettings(each.gain / factor, each.integral_time * factor, each.derivative_time)
        for each in settings
    )
