"""How good a controller is, in physical numbers: the worst signal of each kind."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clepsydra.base.words import listed
from clepsydra.process.averaging import band_text
from clepsydra.process.process import Process
from clepsydra.report.quantities import (
    DEVIATION,
    display_factor,
    number_text,
    sensor_scale,
    settled,
    time_cell,
    unit_text,
)
from clepsydra.scores.band import TIME_OUTSIDE
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import by_signal
from clepsydra.studies.departure import departures
from clepsydra.studies.result import Candidate


@dataclass(frozen=True)
class Figure:
    """One number that says how good a controller is.

    Parameters
    ----------
    score : str
        The key of the score, of which the worst signal counts.
    title : str
        Of a column.
    sentence : str
        With the number in braces, and the signal.
    text : callable
        Process, signal and value [SI] to the number with its unit.
    endless : str
        What is said in the place of the sentence where the value has no end.
    """

    score: str
    title: str
    sentence: str
    text: Callable[[Process, str, float], str]
    endless: str = ""

    def worst(self, process: Process, candidate: Candidate) -> tuple[str, float] | None:
        """Return the signal that is worst beside its range, and its value [SI]; None for none."""
        told = by_signal(candidate.scores, self.score)
        found = {name: value for name, value in told.items() if not math.isnan(value)}
        if not found or (self.score in _OF_SWITCHES and candidate.controller.setpoints):
            return None
        if self.score == TIME_OUTSIDE.key and not departures(process, candidate.scores):
            return None
        in_its_unit = SCORES[self.score].powers == (1, 0)
        share = {
            name: value / process.signal(name).span if in_its_unit else value
            for name, value in found.items()
        }
        name = max(share, key=lambda each: share[each])
        return name, found[name]

    def cell(self, process: Process, candidate: Candidate) -> str:
        """Return the number with its unit; a dash for none, or for nothing."""
        worst = self.worst(process, candidate)
        return "–" if worst is None or not worst[1] else self.text(process, *worst)

    def words(self, process: Process, candidate: Candidate) -> str:
        """Return the number in a clause; empty for none, and where it is nothing."""
        worst = self.worst(process, candidate)
        if worst is None or not worst[1]:
            return ""
        if math.isinf(worst[1]):
            return self.endless
        return self.sentence.format(self.text(process, *worst), signal=worst[0])


def _time(process: Process, name: str, value: float) -> str:
    return "never" if math.isinf(value) else time_cell(value)


def _level(process: Process, name: str, value: float) -> str:
    """Return a deviation of a measurement as one of the level that it measures."""
    signal = process.signal(name)
    value = settled(value, DEVIATION * signal.span)
    state = process.measured_state.get(name)
    if state is not None:
        signal, value = process.signal(state), value / abs(sensor_scale(process, name).gain)
    unit = unit_text(signal.shown_unit)
    return f"{number_text(value * display_factor(signal), 2)} {unit}".strip()


def _of_range(process: Process, name: str, value: float) -> str:
    return f"{number_text(100.0 * value / process.signal(name).span, 2)} %"


def _percent(process: Process, name: str, value: float) -> str:
    return f"{settled(value, 100.0 * DEVIATION):.0f} %".replace("-0 %", "0 %").replace("-", "−")


def _plain(unit: str) -> Callable[[Process, str, float], str]:
    return lambda process, name, value: f"{number_text(value, 2)} {unit}".strip()


#: What says something of controllers that switch, and have no setpoint.
_OF_SWITCHES = ("starts_per_hour",)
#: What an engineer asks first.
_FIGURES = (
    Figure(
        "settling_time", "settles", "settles in {}", _time, "does not settle within the run"
    ),
    Figure("peak_deviation", "deviates", "deviates by at most {} under load", _level),
    Figure(
        "outflow_rate", "outflow changes", "changes the outflow by at most {}",
        _plain("m³/h per h"),
    ),
    Figure("volume_used", "tank used", "uses {} of the tank", _percent),
    Figure(TIME_OUTSIDE.key, "outside band", "", _time),
    Figure("starts_per_hour", "starts", "starts {signal} {}", _plain("times/h")),
    Figure("noise_movement", "noise", "lets noise move {signal} by {} of its range", _of_range),
    Figure("overshoot", "overshoot", "", _percent),
)  # fmt: skip


def figures_of(process: Process) -> list[Figure]:
    """Return what counts for a process: of one whose levels average, what they do to the outflow.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> [figure.title for figure in figures_of(load_process("equalisation-tank"))]
    ['outflow changes', 'tank used', 'starts', 'noise', 'overshoot']
    """
    unasked = {"settling_time", "peak_deviation"} if process.averaging else set()
    unasked |= set() if process.bands else {TIME_OUTSIDE.key}
    return [figure for figure in _FIGURES if figure.score not in unasked]


def _within_bands(candidate: Candidate) -> list[str]:
    """Return between which values loads move each level that has a band."""
    run, said = candidate.run, []
    for name in run.process.bands:
        level, period = run.true_measurement(name), run.scenario.sampling_period
        parts = [
            level[round(part.start / period) : round(part.stop / period) + 1]
            for part in run.scenario.segments
            if part.kind == "load"
        ]
        if parts:
            ends = [float(find(np.concatenate(parts))) for find in (np.min, np.max)]
            signal = run.process.signal(name)
            used, allowed = band_text(signal, ends, 2), band_text(signal, run.process.bands[name])
            said.append(f"holds {name} within {used} (band {allowed})")
    return said


def performance_words(process: Process, candidate: Candidate) -> str:
    """Return how good a controller is, as what follows its name in a sentence.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> study = cl.study(plant, [cl.design.simc(plant)])
    >>> performance_words(plant.process, study.best)[:55]
    'settles in 5.10 min, deviates by at most 1.2 cm under l'
    """
    said = []
    for figure in figures_of(process):
        within = _within_bands(candidate) if figure.score == "volume_used" else []
        said += within or [figure.words(process, candidate)]
    return listed([words for words in said if words])
