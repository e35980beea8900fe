"""Diagnosis of a sensor by its range, and the delay after which a fault counts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.validity import is_number
from clepsydra.program.step_law import Symbols

#: Currents in which a transmitter tells a fault, and between which it measures [mA].
FAULT_BELOW, UNCERTAIN_BELOW, UNCERTAIN_ABOVE, FAULT_ABOVE = 3.6, 3.8, 20.5, 21.0
#: How long a fault is ridden through if nothing else is said [s].
SENSOR_DELAY = 4.0

#: A delay this share of a scan above a whole number of scans is that number.
_ROUNDING = 1e-4
#: Scans are counted no further; single precision holds every whole number up to it.
_LARGEST_COUNT = 1e7


@dataclass(frozen=True)
class Diagnosis:
    """What is known of a sensor in a scan.

    Parameters
    ----------
    value : casadi.SX
        The measurement, or while it is faulty the last good one.
    number : casadi.SX
        Whether the measurement is a number.
    good : casadi.SX
        Whether it may be used.
    uncertain : casadi.SX
        Whether it is good and its current close to that of a fault.
    failed : casadi.SX
        Whether it has been faulty for longer than its delay.
    next_state, named : dict

    Examples
    --------
    >>> true, false = ca.SX(1), ca.SX(0)
    >>> bool(Diagnosis(ca.SX(3.0), true, true, false, false, {}, {}).good)
    True
    """

    value: ca.SX
    number: ca.SX
    good: ca.SX
    uncertain: ca.SX
    failed: ca.SX
    next_state: dict[str, ca.SX]
    named: dict[str, ca.SX]


@dataclass(frozen=True)
class MonitoredSensor:
    """A measurement that the shell watches.

    The measurement is in its own unit, as the analogue input card scales it from 4 to 20 mA,
    also beyond the ends. The current that it stands for is judged as NAMUR NE 43 says: below 3.6
    and above 21 mA it tells a fault, from 3.8 to 20.5 mA it measures, between these it is
    uncertain. A range of no width, which a mistake at run time may make, tells nothing and counts
    as a fault.

    Parameters
    ----------
    number : int
        j of measurement_j.
    signal : Signal
        The measurement: name, unit, initial value.
    range : tuple of float or None
        At 4 and 20 mA; None where it is not known, so that no current can be told.
    delay : float
        [s]

    References
    ----------
    NAMUR NE 43, Standardization of the signal level for the failure information of digital
    transmitters.

    Examples
    --------
    >>> sensor = MonitoredSensor(1, Signal("level_1", "V"), (0.0, 10.0), 4.0)
    >>> [parameter.name for parameter in sensor.parameters()]
    ['range_low_1', 'range_high_1', 'sensor_delay_1']
    """

    number: int
    signal: Signal
    range: tuple[float, float] | None
    delay: float

    def parameters(self) -> list[Signal]:
        """The range, where it is known, and the delay."""
        j, y, found = self.number, self.signal, []
        if self.range is not None:
            for end, current, value in zip(("low", "high"), (4, 20), self.range, strict=True):
                found.append(
                    signals.gain(f"range_{end}_{j}", y.unit, value, f"{y.name} at {current} mA")
                )
        found.append(
            Signal(
                f"sensor_delay_{j}",
                "s",
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                initial=self.delay,
                description=f"time for which a fault of {y.name} is ridden through",
            )
        )
        return found

    def unwired(self) -> dict[str, float]:
        """What its inputs are until somebody wires them: no current, and not good."""
        found = {f"sensor_{self.number}": 0.0}
        if self.range is not None:
            low, high = self.range
            found[f"measurement_{self.number}"] = low - 4.0 * (high - low) / 16.0
        return found

    def state(self) -> list[Signal]:
        """The last good value, and for how many scans there is a fault."""
        j, y = self.number, self.signal
        initial = y.initial if math.isfinite(y.initial) else 0.0
        return [
            Signal(
                f"good_measurement_{j}", y.unit, y.display_unit, y.low, y.high, initial,
                description=f"{y.name} when it was good the last time",
            ),
            Signal(
                f"fault_scans_{j}", low=0.0, high=_LARGEST_COUNT, kind="integer",
                description=f"scans since a fault of {y.name} was seen",
            ),
        ]  # fmt: skip

    def diagnosed(self, symbols: Symbols, anew: ca.SX) -> Diagnosis:
        """Judge the sensor; a start forgets how long a fault has lasted.

        A fault first seen in scan k has failed in scan k + n, with n the delay in whole scans,
        rounded up.
        """
        j = self.number
        raw, kept = symbols[f"measurement_{j}"], symbols[f"good_measurement_{j}"]
        number = is_number(raw)
        good, named = ca.logic_and(number, symbols[f"sensor_{j}"]), {f"value_is_number_{j}": number}
        uncertain = ca.SX(0)
        if self.range is not None:
            current = self._current(symbols, raw, named)
            inside = ca.logic_and(current >= FAULT_BELOW, current <= FAULT_ABOVE)
            good = ca.logic_and(good, inside)
            measures = ca.logic_and(current >= UNCERTAIN_BELOW, current <= UNCERTAIN_ABOVE)
            uncertain = ca.logic_and(good, ca.logic_not(measures))
        before = ca.if_else(anew, 0, symbols[f"fault_scans_{j}"])
        count = ca.fmin(_LARGEST_COUNT - 1.0, ca.fmax(0, before)) + 1
        count = ca.if_else(good, 0, count)
        # A delay that is not a number, set at run time, is over at once.
        delay = self._scans(symbols, named)
        waits = ca.logic_and(count <= delay, count < _LARGEST_COUNT)
        bad = ca.logic_not(good)
        failed = ca.logic_and(bad, ca.logic_not(waits))
        value = ca.if_else(good, raw, kept)
        named |= {
            f"measurement_good_{j}": good,
            f"sensor_bad_{j}": bad,
            f"sensor_uncertain_{j}": uncertain,
            f"fault_scans_used_{j}": before,
            f"delay_scans_{j}": delay,
            f"fault_waits_{j}": waits,
            f"sensor_failed_{j}": failed,
        }
        following = {f"good_measurement_{j}": value, f"fault_scans_{j}": count}
        return Diagnosis(value, number, good, uncertain, failed, following, named)

    def _current(self, symbols: Symbols, raw: ca.SX, named: dict[str, ca.SX]) -> ca.SX:
        """Return the current that a measurement stands for [mA]; 0 in a range of no width."""
        low, high = symbols[f"range_low_{self.number}"], symbols[f"range_high_{self.number}"]
        wide = high != low
        width = ca.if_else(wide, high - low, 1)
        current = ca.if_else(wide, 4.0 + 16.0 * (raw - low) / width, 0)
        j = self.number
        named |= {f"range_is_wide_{j}": wide, f"range_width_{j}": width, f"current_{j}": current}
        return current

    def _scans(self, symbols: Symbols, named: dict[str, ca.SX]) -> ca.SX:
        """Return the delay in whole scans, rounded up."""
        period = symbols["sampling_period"]
        period = ca.if_else(period > 0, period, 1)
        scans = symbols[f"sensor_delay_{self.number}"] / period - _ROUNDING
        named |= {"sampling_period_used": period, f"delay_in_scans_{self.number}": scans}
        return ca.ceil(scans)
