"""Arguments and options that several verbs share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from clepsydra.base.errors import InputError


def _on_plant(name: str, words: str) -> typer.models.OptionInfo:
    return typer.Option(name, metavar="SIGNAL=VALUE", help=words, rich_help_panel="On the plant")


_PROCESS = "A process of the catalogue, or the path of a process file."
ProcessArgument = Annotated[str, typer.Argument(metavar="PROCESS", help=_PROCESS)]
_SUBJECT = "A process of the catalogue, a process file, or a study file."
SubjectArgument = Annotated[str, typer.Argument(metavar="PROCESS|STUDY.toml", help=_SUBJECT)]
_JSON = "Print one JSON document and nothing else."
JsonOption = Annotated[bool, typer.Option("--json", help=_JSON)]
_OUTPUT = "Where files are written: here if left out, with --json nowhere."
OutputOption = Annotated[
    Path | None, typer.Option("--output", "-o", metavar="FOLDER", help=_OUTPUT)
]
#: What sets the plant shell: each names a signal and a quantity.
FailSafeOption = Annotated[
    list[str] | None,
    _on_plant(
        "--fail-safe", "Output while a sensor has failed, as in pump_1='0 V'; its low limit."
    ),
]
SensorDelayOption = Annotated[
    list[str] | None,
    _on_plant("--sensor-delay", "Time that a sensor fault is ridden through, level_1='4 s'; 4 s."),
]
SetpointRateOption = Annotated[
    list[str] | None,
    _on_plant("--setpoint-rate", "Fastest change of a setpoint, as in level_1='0.1 V/s'; none."),
]
RateLimitOption = Annotated[
    list[str] | None,
    _on_plant("--rate-limit", "Fastest change of an output, as in pump_1='1 V/s'; none."),
]


def shell_options(**given: Sequence[str] | None) -> dict[str, dict[str, str]]:
    """Return what the options of the shell ask for: each with its signals and their values."""

    def values(option: str, texts: Sequence[str] | None) -> dict[str, str]:
        remedy = f"write as in {option} SIGNAL='1 s', in the unit that its help says"
        return named_values(texts, "signal", lambda text: option, remedy)

    return {name: values(f"--{name.replace('_', '-')}", texts) for name, texts in given.items()}


def named_values(
    texts: Sequence[str] | None, what: str, place: Callable[[str], str], remedy: str
) -> dict[str, str]:
    """Return names with their values from NAME=VALUE; what is none, or a name twice, is refused."""
    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        if not equals or name.strip() in found:
            words = f"each {what} once" if equals else f"a {what}, '=' and its value"
            raise InputError(place(text[:60]), text[:60], words, remedy)
        found[name.strip()] = value.strip()
    return found
