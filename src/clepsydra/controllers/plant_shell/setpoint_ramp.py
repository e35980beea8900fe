"""A setpoint that is always a number within its range and moves no faster than its ramp."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.controllers.plant_shell.sensor_diagnosis import Diagnosis
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class RampedValue:
    """The setpoint that the law gets in a scan.

    Parameters
    ----------
    value : casadi.SX
    number : casadi.SX
        Whether what was asked for is a number.
    limited : casadi.SX
        Whether what was asked for is a number outside the range.
    ramps : casadi.SX
        Whether the value is still on its way.
    next_state, named : dict

    Examples
    --------
    >>> bool(RampedValue(ca.SX(3.0), ca.SX(1), ca.SX(0), ca.SX(0), {}, {}).ramps)
    False
    """

    value: ca.SX
    number: ca.SX
    limited: ca.SX
    ramps: ca.SX
    next_state: dict[str, ca.SX]
    named: dict[str, ca.SX]


@dataclass(frozen=True)
class RampedSetpoint:
    """A setpoint of the law behind the shell.

    Parameters
    ----------
    number : int
        j of setpoint_j.
    signal : Signal
        What it is the setpoint of.
    measurement : int or None
        k of measurement_k that it is the setpoint of, if the law measures it.
    sensor_range : int or None
        k of the parameters range_low_k and range_high_k within which it is held, if there are
        such; else it is held within the range of its signal.
    rate : float
        [unit/s]; the largest parameter is none.

    Examples
    --------
    >>> ramp = RampedSetpoint(1, Signal("level_1", "V"), 1, 1, 0.5)
    >>> [parameter.unit for parameter in ramp.parameters()]
    ['V/s']
    """

    number: int
    signal: Signal
    measurement: int | None
    sensor_range: int | None
    rate: float

    def parameters(self) -> list[Signal]:
        """The largest rate."""
        return [
            Signal(
                f"setpoint_rate_{self.number}",
                signals.ratio_of_units(self.signal.unit, "s"),
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                initial=self.rate,
                description=f"largest rate of the setpoint of {self.signal.name}, "
                f"{signals.LARGEST_PARAMETER:g} for none",
            )
        ]

    def state(self) -> list[Signal]:
        """The setpoint of the last scan."""
        y = self.signal
        initial = y.initial if math.isfinite(y.initial) else 0.0
        return [
            Signal(
                f"ramped_setpoint_{self.number}", y.unit, y.display_unit, y.low, y.high, initial,
                description=f"setpoint of {y.name} that was followed in the last scan",
            )
        ]  # fmt: skip

    def ramped(
        self,
        symbols: Symbols,
        measured: Diagnosis | None,
        in_force: ca.SX,
        held: ca.SX,
        first: ca.SX,
    ) -> RampedValue:
        """Return the setpoint of this scan.

        One outside the range is held at the end of it: what it asks for cannot be measured, and one
        scan of it would fill an integral. A setpoint that is not a number leaves the last one.
        While no output that needs it is in automatic the ramp stands at the measurement, and there
        it begins in the first scan. While a fault is ridden through it stands where it is: the
        output is held, and would jump by what the ramp had gone meanwhile.

        Parameters
        ----------
        symbols : mapping
            setpoint_j, ramped_setpoint_j, setpoint_rate_j, time_step and the range.
        measured : Diagnosis or None
            The measurement it belongs to.
        in_force : casadi.SX
            Whether an output that needs it is in automatic.
        held : casadi.SX
            Whether a sensor is bad that such an output needs.
        first : casadi.SX
            Whether nothing was remembered before this scan.
        """
        j = self.number
        raw, last = symbols[f"setpoint_{j}"], symbols[f"ramped_setpoint_{j}"]
        rate, step = symbols[f"setpoint_rate_{j}"], symbols["time_step"]
        number = is_number(raw)
        asked = self._within_range(raw, symbols)
        beyond = ca.logic_and(number, asked != raw)
        begin = ca.if_else(number, asked, last)
        if measured is not None:
            begin = ca.if_else(measured.good, measured.value, begin)
        kept = ca.if_else(first, begin, last)
        target = ca.if_else(number, asked, kept)
        way = rate * ca.if_else(is_time_step(step), step, 0)
        on_its_way = ca.if_else(held, kept, limit(target, kept - way, kept + way))
        if measured is not None:
            stands = ca.if_else(measured.good, measured.value, kept)
            on_its_way = ca.if_else(in_force, on_its_way, stands)
        value = ca.if_else(rate < signals.LARGEST_PARAMETER, on_its_way, target)
        ramps = ca.logic_and(in_force, value != target)
        named = {
            f"setpoint_used_{j}": value,
            f"setpoint_given_{j}": number,
            f"setpoint_in_range_{j}": asked,
            f"setpoint_limited_{j}": beyond,
            f"setpoint_wanted_{j}": target,
            f"setpoint_before_{j}": kept,
            f"setpoint_move_{j}": way,
            f"setpoint_on_its_way_{j}": on_its_way,
            f"setpoint_held_{j}": held,
            f"setpoint_in_force_{j}": in_force,
        }
        following = {f"ramped_setpoint_{j}": value}
        return RampedValue(value, number, beyond, ramps, following, named)

    def _within_range(self, value: ca.SX, symbols: Symbols) -> ca.SX:
        """Return a setpoint held in the range; a transmitter may be scaled the other way round."""
        if self.sensor_range is not None:
            ends = [symbols[f"range_{end}_{self.sensor_range}"] for end in ("low", "high")]
            return limit(value, ca.fmin(*ends), ca.fmax(*ends))
        if math.isfinite(self.signal.low):
            value = ca.fmax(self.signal.low, value)
        if math.isfinite(self.signal.high):
            value = ca.fmin(self.signal.high, value)
        return value
