"""What comes in: sensors judged by their range, setpoints within theirs on a ramp."""

from __future__ import annotations

from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import GOOD, PV, SP, truth, words_for
from clepsydra.controllers.blocks.validity import is_number, limit
from clepsydra.controllers.plant_shell.scan import ANEW, ELAPSED, FIRST, SAMPLING_PERIOD
from clepsydra.controllers.signals import LARGEST_PARAMETER, amount, signed
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

#: Currents in which a transmitter tells a fault, and between which it measures [mA].
FAULT_BELOW, UNCERTAIN_BELOW, UNCERTAIN_ABOVE, FAULT_ABOVE = 3.6, 3.8, 20.5, 21.0
RANGE = (
    signed("range_low", "{measurement}", "{measurement} at 4 mA"),
    signed("range_high", "{measurement}", "{measurement} at 20 mA"),
)
_RIDDEN = "time for which a fault of {measurement} is ridden through"
SENSOR_DELAY = amount("sensor_delay", "s", _RIDDEN, 4.0)
_CURRENTS = [
    Signal(name, "mA", initial=value, description=f"{words}; NAMUR NE 43")
    for name, value, words in (
        ("fault_low", FAULT_BELOW, "below it a transmitter tells a fault"),
        ("uncertain_low", UNCERTAIN_BELOW, "below it the measurement is uncertain"),
        ("uncertain_high", UNCERTAIN_ABOVE, "above it the measurement is uncertain"),
        ("fault_high", FAULT_ABOVE, "above it a transmitter tells a fault"),
    )
]

#: A delay this share of a sampling period above a fault's time is over.
_ROUNDING = 1e-4
_MARGIN = Signal(
    "rounding", initial=_ROUNDING, description="tolerance of the delay, in sampling periods"
)
#: A sensor that is bad for more than a third of the time fails.
_RECOVERY = Signal(
    "recovery", initial=0.5, description="share of the good time that makes up for bad time"
)


@cache
def signal_check(*, ranged: bool) -> Block:
    """Return the block that judges a transmitter.

    The measurement is in its own unit, as the analogue input card scales it from 4 to 20 mA,
    also beyond the ends. The current that it stands for is judged as NAMUR NE 43 says: below 3.6
    and above 21 mA it tells a fault, from 3.8 to 20.5 mA it measures, between these it is
    uncertain.

    The time of a fault goes up with the measured time while the sensor is bad, and down at half
    that rate while it is good, so that a sensor that comes and goes fails too. What is seen in a
    scan counts until the next one; a start forgets it. A fault is ridden through until its time
    reaches the delay, if there was a good measurement before; it is counted to twice the delay, so
    that a sound sensor is trusted again in a time of that size.

    `ranged`: whether the values at 4 and 20 mA are known, so that its current can be told.

    References
    ----------
    NAMUR NE 43, Standardization of the signal level for the failure information of digital
    transmitters.

    Examples
    --------
    5 mA in a range from 0 to 16:

    >>> given = dict(measurement=1, sensor=1, sensor_delay=4, sampling_period=1, anew=0, elapsed=1,
    ...              range_low=0, range_high=16)
    >>> symbols = {name: ca.DM(value) for name, value in given.items()}
    >>> kept = dict.fromkeys(["good_measurement", "fault_time", "was_bad", "was_good"], ca.DM(0))
    >>> found = signal_check(ranged=True)("level_1_check", symbols, kept)
    >>> float(found.intermediates["current"]), bool(found.outputs["good"])
    (5.0, True)
    """
    return Block(
        "signal_check" if ranged else "signal_check_without_range",
        (
            Signal("measurement", description="as the card gives it, in its unit"),
            truth("sensor", "the input card reports no fault"),
            *(key.port for key in RANGE if ranged),
            SENSOR_DELAY.port,
            SAMPLING_PERIOD.port,
            ELAPSED,
            ANEW,
        ),
        (
            Signal(
                "good_measurement", description="the measurement when it was good the last time"
            ),
            Signal("fault_time", "s", description="for how long it has been bad"),
            truth("was_bad", "it was bad in the last scan"),
            truth("was_good", "there was a good measurement"),
        ),
        (
            PV,
            GOOD,
            truth("invalid", "the measurement is not a number"),
            truth("uncertain", "it is good, and its current close to that of a fault"),
            truth("failed", "bad for longer than its delay, or never good"),
        ),
        lambda symbols: _checked(symbols, ranged=ranged),
        ("Transmitter of 4 to 20 mA, judged as NAMUR NE 43 says.",),
        (*(_CURRENTS if ranged else ()), _MARGIN, _RECOVERY),
    )


def _checked(s: Symbols, *, ranged: bool) -> Equations:
    raw = s["measurement"]
    number = is_number(raw)
    good, uncertain = ca.logic_and(number, s["sensor"]), ca.SX(0)
    between: dict[str, ca.SX] = {}
    if ranged:
        low, high = s["range_low"], s["range_high"]
        current = 4.0 + 16.0 * (raw - low) / (high - low)
        inside = ca.logic_and(current >= FAULT_BELOW, current <= FAULT_ABOVE)
        good = ca.logic_and(good, inside)
        measures = ca.logic_and(current >= UNCERTAIN_BELOW, current <= UNCERTAIN_ABOVE)
        uncertain = ca.logic_and(good, ca.logic_not(measures))
        between = {"current": current}
    bad, elapsed, delay = ca.logic_not(good), s["elapsed"], s["sensor_delay"]
    before = s["fault_time"]
    counted = ca.if_else(s["was_bad"], before + elapsed, before - _RECOVERY.initial * elapsed)
    time = ca.if_else(s["anew"], 0, limit(counted, ca.SX(0), 2.0 * delay + elapsed))
    waits = ca.logic_and(time < delay - _ROUNDING * s["sampling_period"], s["was_good"])
    value = ca.if_else(good, raw, s["good_measurement"])
    state = {
        "good_measurement": value,
        "fault_time": time,
        "was_bad": bad,
        "was_good": ca.logic_or(good, s["was_good"]),
    }
    told = {
        "pv": value,
        "good": good,
        "invalid": ca.logic_not(number),
        "uncertain": uncertain,
        "failed": ca.logic_and(bad, ca.logic_not(waits)),
    }
    between |= {"counted_time": counted, "waits": waits}
    return Equations(state, told, between, words_for(_WORDS, state, told, between))


#: What a reader is told above the steps.
_WORDS = {
    "invalid": "not a number, or infinite",
    "current": "current of the transmitter [mA]",
    "good": "good: a number, no fault of the card and no fault current",
    "good_measurement": "the last good value is held",
    "fault_time": "for how long the sensor has been bad, less half the time for which it was good",
    "waits": "a fault is ridden through for its delay, if there was a good measurement before",
    "uncertain": "good, but near a fault current",
    "failed": "the fault has lasted for its delay",
}


_RATE = f"{{measurement}}: largest rate, {LARGEST_PARAMETER:g} for none"
SETPOINT_RATE = amount("setpoint_rate", "{measurement}/s", _RATE, LARGEST_PARAMETER)


def _ramped(s: Symbols) -> Equations:
    raw, last, rate = s["asked"], s["ramped_setpoint"], s["setpoint_rate"]
    good, measured, in_force = s["good"], s["pv"], s["in_force"]
    number = is_number(raw)
    # A transmitter may be scaled the other way round.
    ends = s["range_low"], s["range_high"]
    bounded = limit(raw, ca.fmin(*ends), ca.fmax(*ends))
    begin = ca.if_else(good, measured, ca.if_else(number, bounded, last))
    before = ca.if_else(s["first"], begin, last)
    target = ca.if_else(number, bounded, before)
    change = rate * s["elapsed"]
    ramped = ca.if_else(s["held"], before, limit(target, before - change, before + change))
    ramped = ca.if_else(in_force, ramped, ca.if_else(good, measured, before))
    value = ca.if_else(rate < LARGEST_PARAMETER, ramped, target)
    return Equations(
        {"ramped_setpoint": value},
        {
            "sp": value,
            "invalid": ca.logic_not(number),
            "limited": ca.logic_and(number, bounded != raw),
            "ramps": ca.logic_and(in_force, value != target),
        },
        {
            "bounded": bounded,
            "before": before,
            "target": target,
            "largest_change": change,
            "ramped": ramped,
        },
    )


#: The setpoint of a scan. One outside the range is held at the end of it: what it asks for cannot
#: be measured, and one scan of it would fill an integral. A setpoint that is not a number leaves
#: the last one. While no output that needs it is in automatic the ramp stands at the measurement,
#: and there it begins in the first scan. While a fault is ridden through it stands where it is:
#: the output is held, and would jump by what the ramp had gone meanwhile.
RAMP = Block(
    "setpoint_ramp",
    (
        Signal("asked", description="requested setpoint, in the unit of the measurement"),
        *(key.port for key in RANGE),
        SETPOINT_RATE.port,
        ELAPSED,
        PV,
        GOOD,
        truth("in_force", "an output that needs the setpoint is in automatic"),
        truth("held", "a bad sensor holds such an output"),
        FIRST,
    ),
    (Signal("ramped_setpoint", description="the setpoint that was followed in the last scan"),),
    (
        SP,
        truth("invalid", "the requested setpoint is not a number"),
        truth("limited", "the requested setpoint is outside the range"),
        truth("ramps", "the setpoint has not reached the requested one"),
    ),
    _ramped,
    ("A setpoint within its range: ramped in automatic, at the measurement otherwise.",),
)
