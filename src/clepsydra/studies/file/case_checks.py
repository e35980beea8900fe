"""What has to hold of a case of a study, whether a file or a call asks for it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from clepsydra.base.errors import Finding, InputError
from clepsydra.linear.analysis import Analysis
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.studies.file.request import Settings
from clepsydra.studies.result import BASE_CASE
from clepsydra.studies.warnings.out_of_reach import out_of_reach

_LONGEST_NAME = 40


def check_case_name(name: str, place: str) -> None:
    """Refuse the name of a case that no line of a table could show, or that is taken."""
    if not name.strip() or not name.isprintable() or len(name) > _LONGEST_NAME:
        expected = f"a name of 1 to {_LONGEST_NAME} characters in one line"
        raise InputError(place, name[:_LONGEST_NAME], expected, "rename the case")
    if name == BASE_CASE:
        expected = f"another name: {BASE_CASE!r} is the study's own operating point"
        raise InputError(place, name, expected, "rename the case")


def check_same_loops(own: Process, there: Process, settings: Settings, place: str) -> None:
    """Refuse a process whose scores or settings say nothing beside those of the study."""
    if there.controlled != own.controlled:
        raise InputError(
            place, f"{there.address}, which controls {', '.join(there.controlled)}",
            f"a process that controls {', '.join(own.controlled)}, as the study does",
            "choose another variant, or write a study of its own",
        )  # fmt: skip
    if there.sampling_period != own.sampling_period and settings == "frozen":
        raise InputError(
            place, f"{there.address}, sampled every {there.sampling_period:g} s",
            f"the sampling period of the study, {own.sampling_period:g} s, where settings are "
            "frozen",
            "choose another variant, or let the controllers be designed anew",
        )  # fmt: skip


def check_held(analysis: Analysis, scenario: Scenario, place: str) -> None:
    """Refuse a setpoint step that the process cannot hold there, whatever controls it."""
    segments = tuple(each for each in scenario.segments if each.kind == "setpoint")
    for remark in out_of_reach(analysis.model, replace(scenario, segments=segments)):
        raise InputError(
            place, Finding(remark.brief.rstrip(".")), "setpoint steps that can be held there",
            "make the step smaller, or ask for another operating point",
        )  # fmt: skip


@contextmanager
def errors_in_case(name: str) -> Iterator[None]:
    """Say of what is wrong with a part of a study that it is so in a case."""
    try:
        yield
    except InputError as error:
        place = f"{error.place}, in the case {name}"
        raise InputError(place, error.value, error.expected, error.remedy) from None
