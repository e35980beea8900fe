"""What an engineer sets of a controller on the plant, read with units."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.base.arguments import require_signal, require_type
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.interface.plant import Plant
from clepsydra.interface.quantities import Quantity, arguments, with_unit
from clepsydra.process.signal_values import read_rate, read_value

#: Signal to a value of its setting.
Settings = Mapping[str, Quantity] | None
_REMEDY = "correct it, or leave it out"


def plant_shell(
    plant: Plant,
    *,
    fail_safe: Settings = None,
    sensor_delay: Settings = None,
    setpoint_rate: Settings = None,
    rate_limit: Settings = None,
) -> PlantShell:
    """Return the settings of a controller on the plant; what is not named stays as usual.

    Parameters
    ----------
    plant : Plant
    fail_safe : mapping, optional
        Input to its value while a sensor has failed, {"pump_1": "1 V"}; its low limit if left out.
    sensor_delay : mapping, optional
        Measurement to how long a fault of it is ridden through, {"level_1": "10 s"}; 4 s.
    setpoint_rate : mapping, optional
        Measurement to the fastest change of its setpoint, {"level_1": "0.1 V/s"}; none.
    rate_limit : mapping, optional
        Input to its fastest change, {"pump_1": "1 V/s"}; none. Of each, a number is in the display
        unit of the signal, in s, or in the display unit per s; percent are of the signal's range.

    Raises
    ------
    InputError
        A signal is unknown, or a quantity is none of its setting.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant_shell(cl.load("quadruple-tank"), rate_limit={"pump_1": "60 V/min"}).rate_limit
    {'pump_1': 1.0}
    """
    process = plant.process
    outputs, sensors = process.inputs, process.measurements
    settings = (
        ("fail_safe", fail_safe, outputs, "value"),
        ("sensor_delay", sensor_delay, sensors, "time"),
        ("setpoint_rate", setpoint_rate, sensors, "rate"),
        ("rate_limit", rate_limit, outputs, "rate"),
    )
    found: dict[str, dict[str, float]] = {}
    for name, given, signals, kind in settings:
        require_type(
            given if given is not None else {}, Mapping, name, "signals with their values",
            f'write as in {{"{signals[0].name}": "1 s"}}',
        )  # fmt: skip
        found[name] = {}
        for key, value in (given or {}).items():
            signal = require_signal(name, key, signals, "one of these")
            shown = {"value": signal.shown_unit, "time": "s", "rate": _a_second(signal.shown_unit)}
            table = arguments(name, {key: with_unit(value, shown[kind])})
            if kind == "value":
                found[name][key] = read_value(table, key, signal, "a value", _REMEDY)
            elif kind == "time":
                found[name][key] = table.quantity(key, "s", "a time", _REMEDY, at_least=0.0)
            else:
                found[name][key] = read_rate(table, key, signal, "a rate", _REMEDY)
    return PlantShell(**found)


def _a_second(unit: str) -> str:
    return f"({unit})/s" if "/" in unit else f"{unit}/s"
