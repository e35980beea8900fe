"""What happens in a study: steps of setpoints and loads at their times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any, Literal, cast, get_args

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.linear.analysis import Analysis
from clepsydra.loop.begin import ControllerStart, begin_from
from clepsydra.loop.beginning import with_beginning
from clepsydra.loop.default_scenario import MOST_SAMPLES, default_scenario
from clepsydra.loop.open_loop_plan import Start
from clepsydra.loop.profile import samples_before
from clepsydra.loop.scenario import Scenario, Segment
from clepsydra.loop.with_noise import with_noise
from clepsydra.process import told
from clepsydra.process.averaging import check_at_rest
from clepsydra.process.declared import OWN, keys_of, part, read_fields, table_schema
from clepsydra.process.known_names import known_name
from clepsydra.process.process import Process
from clepsydra.process.signal_values import read_in_range
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.course import CourseRow

_STEPS = "add a step, as in [[scenario.setpoint]], or leave [scenario] out for the usual one"
_KINDS: tuple[Literal["setpoint", "load"], ...] = ("setpoint", "load")


def _instant(
    table: TableReader, key: str, known: Mapping[str, Any], of: str, remedy: str, **bounds: float
) -> int:
    """Return the later one of the two samples around a time, one before an end.

    What nothing follows is judged by two samples or more.
    """
    period, samples = known["process"].sampling_period, known["samples"]
    fewest = known.get("fewest", 2)
    sample = samples_before(table.quantity(key, "s", "a time", remedy, **bounds), period)
    if sample > samples - fewest:
        late = "let the noise begin earlier" if key == "noise" else "let it step earlier"
        raise table.wrong(
            key,
            f"a time before the end of the {of} at {time_text(samples * period, 4)}"
            + (", by two samples" if sample < samples else ""),
            f"lengthen the duration, or {late}",
        )
    return sample


def _signal(row: TableReader, key: str, known: Mapping[str, Any]) -> Signal:
    process: Process = known["process"]
    words, names = "a disturbance", [signal.name for signal in process.disturbances]
    if known["kind"] == "setpoint":
        words, names = "a controlled measurement", [*process.controlled]
    name = row.name(key, f"the name of {words}")
    return process.signal(known_name(row, key, name, names, f"{words} of {process.name}"))


@dataclass(frozen=True)
class Step:
    """A step, ramp, pulse or profile of a signal: from which sample, and what its table says."""

    kind: Literal["setpoint", "load"]
    signal: Signal = part(
        _signal, required=(OWN,), **told.text("a controlled measurement, or a disturbance")
    )
    sample: int = part(
        lambda row, key, known: _instant(
            row, "at", known, "steps", "say when it steps", at_least=0.0
        ),
        {"at": told.quantity("when, at the later one of two samples", "s")},
        required=("at",),
    )
    table: TableReader = part(
        lambda row, key, known: row,
        {
            "to": told.quantity("the value after the step"),
            "by": told.quantity("the size of the step"),
            "over": told.quantity("how long a ramp takes to that value; a step if left out", "s"),
            "lasts": told.quantity(
                "of a load, how long until it goes back, as after water is poured in; it stays if "
                "left out",
                "s",
            ),
            "profile": told.text(
                "in place of a value: a CSV file, from the folder of the study file, with a column "
                "of time from `at` on and one of the signal; each row holds until the next one"
            ),
        },
        checks=(
            {"oneOf": [{"required": [key]} for key in ("to", "by", "profile")]},
            *(
                {"not": {"required": list(pair)}}
                for pair in combinations(("over", "lasts", "profile"), 2)
            ),
        ),
    )


def _samples(table: TableReader, name: str, known: Mapping[str, Any]) -> int:
    """Return how many samples a scenario has."""
    duration = table.quantity(
        "duration", "s", "a length of time", "say how long the scenario lasts", above=0.0
    )
    period = known["process"].sampling_period
    samples = samples_before(duration, period)
    if samples < 2:
        expected = f"at least {time_text(2 * period, 4)}, two samples"
        remedy = "lengthen it, or shorten the sampling period of the process"
        raise table.wrong("duration", expected, remedy)
    if samples > MOST_SAMPLES:
        raise table.wrong(
            "duration",
            f"at most {time_text(MOST_SAMPLES * period, 4)}, {MOST_SAMPLES:,} sampling periods",
            "shorten it, or lengthen the sampling period of the process",
        )
    return samples


def _state(table: TableReader, key: str, known: Mapping[str, Any]) -> dict[str, float]:
    """Return states and inputs of the process that stand elsewhere at the start [SI]."""
    if not table.has(key):
        return {}
    process: Process = known["process"]
    signals = {signal.name: signal for signal in (*process.state, *process.inputs)}
    words = f"a state or an input of {process.name}"
    remedy = f'write as in state = {{ "{process.state[0].name}" = "10 %" }}'
    below, found = table.table(key, "a table of states with their values", remedy), {}
    for name in below.present:
        signal = signals[known_name(below, name, name, signals, words)]
        found[name] = read_in_range(below, name, signal, "a value", "give one")
    return found


def _controller_start(
    table: TableReader, key: str, known: Mapping[str, Any]
) -> ControllerStart | None:
    if not table.has(key):
        return None
    found: Any = table.choice(key, get_args(ControllerStart), "")
    return cast(ControllerStart, found)


def _noise_begins(table: TableReader, name: str, known: Mapping[str, Any]) -> int | None:
    """Return the sample from which on there is noise and nothing else; None without such a time."""
    if not table.has("noise") or isinstance(table.raw("noise"), bool):
        return None
    remedy = 'write true, false, or when a stretch of noise without steps begins, as in "5 h"'
    return _instant(table, "noise", known, "scenario", remedy, above=0.0)


def _steps(table: TableReader, name: str, known: Mapping[str, Any]) -> list[Step]:
    """Return the steps in order of time, all of them before the noise."""
    end = {"samples": known["samples"]}
    if known["quiet"] is not None:  # which begins with another sample of the last step
        end = {"samples": known["quiet"], "fewest": 1}
    steps = [
        Step(kind, **read_fields(Step, row, kind=kind, process=known["process"], **end))
        for kind in _KINDS
        for row in table.tables(
            kind, "a list of steps", f"write each as [[scenario.{kind}]]", keys_of(Step)
        )
    ]
    begins = known["start"] != "rest" or known["state"]
    if not (steps or begins):
        raise InputError(table.place(), Finding("no step"), "at least one step", _STEPS)
    steps.sort(key=lambda step: step.sample)
    for first, second in pairwise(steps):
        if first.sample == second.sample and not (begins and first.sample == 0):
            raise second.table.wrong(
                "at",
                f"a time at which {first.signal.name} does not step as well, so that it is known "
                "what the response is to",
                "let one step follow the other",
            )
    return steps


@dataclass(frozen=True)
class ScenarioTable:
    """What a study file says of its scenario.

    Parameters
    ----------
    start : {"rest", "empty"}
    state : dict
        States and inputs of the process that stand elsewhere at the start [SI].
    controller_start : {"bumpless", "cold"} or None
        None where it is not said.
    quiet : int or None
        The sample from which on there is noise and nothing else; None without such a time.
    steps : list of Step
        In order of time, all of them before the noise.
    """

    samples: int = part(
        _samples, {"duration": told.quantity("its length", "s")}, required=("duration",)
    )
    start: Start = part(
        lambda table, key, known: table.choice(key, get_args(Start), "rest"),
        **told.choice(
            'where it begins: `"rest"`, at the operating point of the process, or `"empty"`, with '
            "empty tanks",
            get_args(Start),
        ),
    )
    state: dict[str, float] = part(
        _state,
        **told.by_name(
            "table of states of the process that begin elsewhere, and of inputs that stand "
            'elsewhere when the controllers start, `{ "tank_1.level" = "5 cm", pump_1 = "0 V" }`'
        ),
    )
    controller_start: ControllerStart | None = part(
        _controller_start,
        **told.choice(
            'how controllers start away from rest: `"bumpless"`, as after a time in manual, or '
            '`"cold"`, with the states that their laws declare, integrals at zero',
            get_args(ControllerStart),
        ),
    )
    quiet: int | None = part(
        _noise_begins,
        {
            "noise": {
                "description": "`true`, `false`, or a time: then there is noise from that time on, "
                "without steps, and it is judged how quiet a controller is. The noise of sensors "
                "and flows is that of the process file, of a sensor without one 0.5 % of its range",
                "type": ["boolean", "string"],
            }
        },
    )
    steps: list[Step] = part(
        _steps,
        {
            "setpoint": told.listed(
                "list of steps of controlled measurements, each as `[[scenario.setpoint]]`",
                table_schema(Step),
            ),
            "load": told.listed(
                "list of steps of disturbances, each as `[[scenario.load]]`", table_schema(Step)
            ),
        },
    )


def read_scenario(
    table: TableReader | None, analysis: Analysis, seed: int, folder: Path
) -> Scenario:
    """Read the scenario of a study file, the default scenario where it has none.

    Steps come one at a time: each begins a segment that lasts until the next one, whatever its
    signal, so that every score knows what it is of. A step between two samples acts from the
    later one on. Noise is that of the process, over the whole scenario, or in a stretch of its
    own after the last step, by which it is judged how quiet a controller is.

    Parameters
    ----------
    folder : Path
        Of the study file, where the paths of profiles begin.

    Raises
    ------
    InputError
        There is no step; a signal is unknown; a step changes nothing, leaves the range of its
        signal, comes after the end, or together with another one; a ramp has not ended when the
        next step comes, or a profile cannot be read.
    """
    if table is None:
        return default_scenario(analysis.model, seed)
    process = analysis.operating_point.process
    period = process.sampling_period
    read = ScenarioTable(**read_fields(ScenarioTable, table, process=process))
    samples, quiet, steps = read.samples, read.quiet, read.steps
    at = analysis.operating_point.as_dict()
    check_at_rest(process, at)
    setpoints = np.tile([at[name] for name in process.controlled], (samples, 1))
    disturbances = np.tile([at[signal.name] for signal in process.disturbances], (samples, 1))
    noise = np.zeros((samples, len(process.measurements)))
    begin = begin_from(
        analysis.operating_point,
        read.start,
        given=read.state,
        controller_start=read.controller_start,
    )
    last = samples if quiet is None else quiet
    times = [step.sample for step in steps]
    ends = [min((other for other in times if other > time), default=last) for time in times]
    segments: list[Segment] = []
    for step, end in zip(steps, ends, strict=True):
        if step.kind == "setpoint":
            column = setpoints[:, process.controlled.index(step.signal.name)]
        else:
            place = [signal.name for signal in process.disturbances].index(step.signal.name)
            column = disturbances[:, place]
        before = float(column[step.sample])
        row = CourseRow(step.table, step.kind, step.signal, process, folder)
        course = row.course(before, end - step.sample)
        column[step.sample :] = course.values[-1]
        column[step.sample : end] = course.values
        start, stop = step.sample * period, end * period
        over = course.settled * period
        segments.append(Segment(step.kind, step.signal.name, start, stop, course.size, over))
    if begin is not None:
        segments = with_beginning(process, begin, setpoints[0], segments, last * period)
    if quiet is not None:
        segments.append(Segment("noise", "", quiet * period, samples * period, 0.0))
    scenario = Scenario(period, setpoints, disturbances, noise, tuple(segments), seed, begin)
    if quiet is not None or table.flag("noise", default=True):
        return with_noise(scenario, process, quiet or 0)
    return scenario
