"""Options that set the plant shell: each names a signal and a quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer


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


def shell_options(
    *,
    fail_safe: Sequence[str] | None,
    sensor_delay: Sequence[str] | None,
    setpoint_rate: Sequence[str] | None,
    rate_limit: Sequence[str] | None,
) -> dict[str, dict[str, str]]:
    """Return what the options ask for: each setting with its signals and their values."""
    return {
        "fail_safe": _read("--fail-safe", fail_safe),
        "sensor_delay": _read("--sensor-delay", sensor_delay),
        "setpoint_rate": _read("--setpoint-rate", setpoint_rate),
        "rate_limit": _read("--rate-limit", rate_limit),
    }


def _read(option: str, texts: Sequence[str] | None) -> dict[str, str]:
    from clepsydra.base.errors import InputError

    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        name = name.strip()
        if not equals or name in found:
            raise InputError(
                option, text[:60],
                "each signal once" if equals else "a signal, '=' and its value",
                f"write as in {option} SIGNAL='1 s', in the unit that its help says",
            )  # fmt: skip
        found[name] = value.strip()
    return found
