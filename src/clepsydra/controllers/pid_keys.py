"""The quantities of one PID loop, each declared once."""

from __future__ import annotations

from clepsydra.base.key import Key
from clepsydra.controllers.signals import (
    LARGEST_PARAMETER,
    SHORTEST_TIME,
    TRACKING_TIME,
    amount,
    signed,
)
from clepsydra.process.joined_unit import Time

#: The gains of a loop, with what their unit has beside those of the signals.
GAINS: dict[str, Time] = {"proportional_gain": "1", "integral_gain": "1/s", "derivative_gain": "s"}
#: What a reader calls a parameter of a loop, where it is not the same.
SHORT_NAMES = {
    "proportional_gain": "gain",
    "setpoint_low_limit": "setpoint_low",
    "setpoint_high_limit": "setpoint_high",
}
_WAY, _RATIO, _PER = "from {measurement} to {output}", "{output}/{measurement}", "{measurement}/s"
_RATE = "{output}/({measurement} s)"
_FILTER = "derivative time over the time constant of its filter"
_GAP = "half the width of the gap around the setpoint of {measurement}"
_SQUARED = "error of {measurement} at which the gain is the nominal one"
_RAMP = "largest rate of change of the setpoint of {measurement}"
_WINDS = "α: rate at which an excess over the limits of {output} dies away"
_DECLARED = (
    signed("proportional_gain", _RATIO, f"proportional gain {_WAY}", 1.0, bolder=1.0),
    signed("integral_gain", _RATE, f"integral gain {_WAY}", bolder=1.0),
    signed("derivative_gain", f"s {_RATIO}", f"derivative gain {_WAY}", bolder=1.0),
    amount("integral_time", "s", "integral time", 60.0, low=SHORTEST_TIME),
    amount("derivative_time", "s", "derivative time"),
    amount("filter_time", "s", "time constant of the derivative's filter", 60.0, low=SHORTEST_TIME),
    Key("derivative_filter", "1", _FILTER, 1.0, 1000.0, 10.0),
    Key("setpoint_weight", "1", "share of the setpoint in the proportional part", 0.0, 1.0, 1.0),
    amount("gap", "{measurement}", _GAP),
    Key("gap_gain", "1", "share of the error that acts within the gap", 0.0, 1.0, 0.1),
    amount("squared_error_scale", "{measurement}", _SQUARED, 1.0, low=SHORTEST_TIME),
    amount("setpoint_ramp", _PER, _RAMP, LARGEST_PARAMETER),
    TRACKING_TIME,
    amount("saturation_rate", "1/s", _WINDS, 0.1),
)
#: The parameters of a loop; each form has those that `PidForm.parameters` names.
PARAMETERS = {key.name: key for key in _DECLARED}


def _choice(name: str) -> Key:
    """Return the key of a choice of setpoints."""
    words = "source of the setpoint of {measurement}: 0 local, 1 remote"
    return Key(name, "1", words, 0.0, 1.0, kind="integer")


def _measured(name: str, words: str) -> Key:
    """Return the key of a value of the measurement."""
    return Key(name, "{measurement}", words, like="measurement")


#: What a loop may remember, and what it may choose its setpoint from.
LAST_SETPOINT = _measured("last_setpoint", "setpoint of {measurement} in the last sample")
LAST_MEASUREMENT = _measured("last_measurement", "{measurement} in the last sample")
LAST_DERIVATIVE = Key("last_derivative", _PER)
FILTERED_SIGNAL = _measured("filtered_signal", "what is differentiated, filtered")
WORKING_SETPOINT = _measured("working_setpoint", "setpoint that {measurement} follows")
LAST_SETPOINT_SOURCE = _choice("last_setpoint_source")
LAST_APPLIED = Key("last_applied", "{output}", "what was applied of its output", like="output")
LOCAL_SETPOINT = _measured("local_setpoint", "local setpoint of {measurement}")
REMOTE_SETPOINT = _measured("remote_setpoint", "remote setpoint of {measurement}")
SETPOINT_SOURCE = _choice("setpoint_source")


def _moved(name: str, words: str) -> Key:
    """Return the key of a value of the output, or of a share in it."""
    return Key(f"faceplate.{name}", "{output}", words, like="output")


#: What an operator sees of a loop in any form, of one that has terms, and of its derivative.
FACEPLATE: tuple[Key, ...] = (
    _measured("faceplate.pv", "{measurement} as the loop uses it"),
    Key(
        "faceplate.pv_bad",
        "1",
        "pv is not measured: it is the last good {measurement}",
        0.0,
        1.0,
        kind="boolean",
    ),
    _measured("faceplate.sp", "setpoint that {measurement} follows"),
    Key("faceplate.error", "{measurement}", "setpoint less measurement, {measurement}"),
    _moved("op", "value of {output}"),
)
TERMS = (
    _moved("p_part", "P part of {output}"),
    _moved("i_part", "I part of {output}, the bias of a loop without integral action"),
)
D_PART = _moved("d_part", "D part of {output}")
