"""The settings of a PI or PID controller that an identified model leads to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.base.words import time_text
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.models.delayed_lags import DelayedLags
from clepsydra.designs.simc import simc_settings
from clepsydra.identification.estimate import ratio_signal

SIMC = "SIMC (S. Skogestad, 2003, doi 10.1016/S0959-1524(02)00062-8)"


@dataclass(frozen=True)
class ControlSettings:
    """Settings by SIMC in ISA form, for a controller that is sampled as the record was."""

    settings: PidSettings
    gain: Signal  # unit of the gain
    delay: float  # θ, dead time and half a sampling period [s]
    closed_loop_time_constant: float  # τc [s]
    tightest: ControlSettings | None = None  # those with τc = θ, where these are calmer

    def as_values(self) -> dict[str, str]:
        """Return them as a loop's table takes them, with units: K without its sign, Ti and Td."""
        gain, integral, derivative = self.settings
        values = {
            "K": f"{abs(gain)!r} {self.gain.unit}".removesuffix(" 1"),
            "Ti": f"{integral!r} s",
        }
        return values | ({"Td": f"{derivative!r} s"} if derivative else {})

    @property
    def words(self) -> str:
        """The settings in words."""
        gain, integral, derivative = self.settings
        shown = from_si(abs(gain), self.gain.unit, self.gain.shown_unit)
        unit = "" if self.gain.shown_unit == "1" else f" {self.gain.shown_unit}"
        parts = [f"a gain of {shown:.4g}{unit}"]
        parts.append(f"an integral time of {time_text(integral)}")
        if derivative:
            parts.append(f"a derivative time of {time_text(derivative)}")
        form = "PID" if derivative else "PI"
        return f"{self.settings.action}-acting {form} with {', '.join(parts[:-1])} and {parts[-1]}"

    def as_dict(self) -> dict[str, Any]:
        """Return the settings [SI], for JSON."""
        gain, integral, derivative = self.settings
        return {
            "rule": SIMC,
            "gain": gain,
            "gain_unit": self.gain.unit,
            "integral_time": integral,
            "derivative_time": derivative,
            "closed_loop_time_constant": self.closed_loop_time_constant,
            "tightest": None if self.tightest is None else self.tightest.as_dict(),
        }


def control_settings(
    model: DelayedLags,
    output: Signal,
    manipulated: Signal,
    period: float,
    reach: tuple[float, float],
) -> ControlSettings:
    """Return SIMC's settings of a fitted model that stay within what the record saw.

    The closed-loop time constant is the shortest from θ on with a proportional gain of at most
    Δu/Δy, so that a setpoint step over all that the output moved asks the input for no more than
    it moved: beyond that the model has not been seen to hold. The reach is (Δy, Δu); half a
    sampling period [s] is added to the dead time of the model.

    Examples
    --------
    >>> model = DelayedLags(slope=0.02, time_constant=50.0, delay=2.0)
    >>> found = control_settings(model, Signal("level", "m"), Signal("pump", "V"), 1.0, (0.5, 1.0))
    >>> found.settings.gain, found.closed_loop_time_constant
    (2.0, 22.5)
    >>> found.tightest.settings
    PidSettings(gain=10.0, integral_time=20.0, derivative_time=0.0)
    """
    delay = model.delay + 0.5 * period
    moved, asked = reach
    shortest = max(delay, moved / (abs(model.slope) * asked) - delay)
    gain = ratio_signal("gain", manipulated, output, "gain of the controller")
    tightest = ControlSettings(_settings(model, delay, delay), gain, delay, delay)
    if shortest <= delay:
        return tightest
    return ControlSettings(_settings(model, delay, shortest), gain, delay, shortest, tightest)


def _settings(model: DelayedLags, delay: float, closed_loop_time_constant: float) -> PidSettings:
    return simc_settings(replace(model, delay=delay), closed_loop_time_constant)
