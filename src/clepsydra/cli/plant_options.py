"""Options that set the plant shell: each names a signal and a quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from clepsydra.controllers.plant_shell.settings import PlantShell
    from clepsydra.process.process import Process


def _option(name: str, words: str) -> typer.models.OptionInfo:
    return typer.Option(name, metavar="SIGNAL=VALUE", help=words, rich_help_panel="On the plant")


FailSafeOption = Annotated[
    list[str] | None,
    _option("--fail-safe", "Output while a sensor has failed, as in pump_1='0 V'; its low limit."),
]
SensorDelayOption = Annotated[
    list[str] | None,
    _option("--sensor-delay", "Time that a sensor fault is ridden through, level_1='4 s'; 4 s."),
]
SetpointRateOption = Annotated[
    list[str] | None,
    _option("--setpoint-rate", "Fastest change of a setpoint, as in level_1='0.1 V/s'; none."),
]
RateLimitOption = Annotated[
    list[str] | None,
    _option("--rate-limit", "Fastest change of an output, as in pump_1='1 V/s'; none."),
]


def read_plant_shell(
    process: Process,
    *,
    fail_safe: Sequence[str] | None,
    sensor_delay: Sequence[str] | None,
    setpoint_rate: Sequence[str] | None,
    rate_limit: Sequence[str] | None,
) -> PlantShell:
    """Return the settings that the options ask for; what none names stays as usual."""
    from clepsydra.controllers.plant_shell.settings import PlantShell

    outputs = {signal.name: signal.unit for signal in process.inputs}
    sensors = {signal.name: signal.unit for signal in process.measurements}
    return PlantShell(
        fail_safe=_read("--fail-safe", fail_safe, outputs),
        sensor_delay=_read("--sensor-delay", sensor_delay, dict.fromkeys(sensors, "s")),
        setpoint_rate=_read("--setpoint-rate", setpoint_rate, _per_second(sensors)),
        rate_limit=_read("--rate-limit", rate_limit, _per_second(outputs)),
    )


def _per_second(units: dict[str, str]) -> dict[str, str]:
    return {name: f"({unit})/s" if "/" in unit else f"{unit}/s" for name, unit in units.items()}


def _read(option: str, texts: Sequence[str] | None, units: dict[str, str]) -> dict[str, float]:
    from clepsydra.base.errors import InputError
    from clepsydra.base.suggestion import suggestion
    from clepsydra.base.units import to_si

    found: dict[str, float] = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        name = name.strip()
        if not equals or name in found:
            raise InputError(
                option, text[:60],
                "each signal once" if equals else "a signal, '=' and its value",
                f"write as in {option} {next(iter(units))}='1 {next(iter(units.values()))}'",
            )  # fmt: skip
        if name not in units:
            raise InputError(
                option, name[:60], f"one of {', '.join(units)}",
                suggestion(name, units, "choose one of them"),
            )  # fmt: skip
        found[name] = to_si(value.strip(), units[name], f"{option} {name}")
    return found
