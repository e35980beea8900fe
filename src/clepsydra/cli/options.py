"""Arguments and options that several verbs share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from clepsydra.base.errors import InputError
from clepsydra.base.words import with_article
from clepsydra.cli.subject import name_of


def _on_plant(words: str) -> Any:
    return typer.Option(metavar="SIGNAL=VALUE", help=words, rich_help_panel="On the plant")


def all_option(words: str) -> Any:
    """Return the option `--all`, which shows more than the first screen."""
    return typer.Option(False, "--all", help=words)


def controller_option(words: str) -> Any:
    """Return the option `--controller`, which chooses one of a study."""
    return typer.Option(None, metavar="NAME", callback=name_of, help=words)


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
_SHELL = ("fail_safe", "sensor_delay", "setpoint_rate", "rate_limit")
FailSafeOption = Annotated[
    list[str] | None,
    _on_plant("Output while a sensor has failed, as in pump_1='0 V'; its low limit."),
]
SensorDelayOption = Annotated[
    list[str] | None,
    _on_plant("Time that a sensor fault is ridden through, level_1='4 s'; 4 s."),
]
SetpointRateOption = Annotated[
    list[str] | None,
    _on_plant("Fastest change of a setpoint, as in level_1='0.1 V/s'; none."),
]
RateLimitOption = Annotated[
    list[str] | None,
    _on_plant("Fastest change of an output, as in pump_1='1 V/s'; none."),
]


def shell_options(*given: Sequence[str] | None) -> dict[str, dict[str, str]]:
    """Return what the options of the shell ask for: each with its signals and their values."""
    found = {}
    for name, texts in zip(_SHELL, given, strict=True):
        option = f"--{name.replace('_', '-')}"
        remedy = f"write as in {option} SIGNAL='1 s', in the unit that its help says"
        found[name] = named_values(texts, "signal", option, remedy)
    return found


def named_values(texts: Sequence[str] | None, what: str, place: str, remedy: str) -> dict[str, str]:
    """Return names with their values from NAME=VALUE; what is none, or a name twice, is refused."""
    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        if not equals or name.strip() in found:
            words = f"each {what} once" if equals else f"{with_article(what)}, '=' and its value"
            raise InputError(place.format(text[:60]), text[:60], words, remedy)
        found[name.strip()] = value.strip()
    return found
