"""The numbers that say how good a controller is: as columns of a ranking, and in a sentence."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clepsydra.base.units import unit_text
from clepsydra.base.words import listed
from clepsydra.process.averaging import band_text
from clepsydra.process.process import Process
from clepsydra.report.quantities import (
    DEVIATION,
    display_factor,
    number_text,
    settled,
    shown_signal,
    time_cell,
)
from clepsydra.scores.band import TIME_OUTSIDE
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import by_signal
from clepsydra.studies.departure import departures
from clepsydra.studies.ranking import QUIET
from clepsydra.studies.result import Candidate, TriedController


@dataclass(frozen=True)
class Form:
    """How a number stands in a cell.

    Parameters
    ----------
    unit : str
        That of the number; a deviation is told in percent of its signal's range.
    digits : int
        Significant ones; 0 for a whole number.
    is_time : bool
        Whether it is a time [s], told in the unit that suits it.
    """

    unit: str = ""
    digits: int = 2
    is_time: bool = False


@dataclass(frozen=True)
class Limit:
    """Above what a number has to be watched, as it stands in a cell, and how that is told."""

    most: float
    words: str


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
        Process, signal and value [SI] to the number with its unit, as a sentence has it.
    form : Form
        In a cell.
    endless : str
        What is said in the place of the sentence where the value has no end.
    limit : Limit or None
        Above what it has to be watched, where there is such a limit.
    held : bool
        Whether it judges how a setpoint is held, and so no level that averages: that is meant to
        move, and a step of its setpoint, which nobody makes, says nothing of the flow.
    """

    score: str
    title: str
    sentence: str
    text: Callable[[Process, str, float], str]
    form: Form
    endless: str = ""
    held: bool = False
    limit: Limit | None = None

    def compared(self, process: Process, name: str, value: float) -> float:
        """Return what signals of different units are compared by: percent of the range, if any."""
        return 100.0 * value / process.signal(name).span if self.is_share else value

    @property
    def is_share(self) -> bool:
        """Whether it has the unit of its signal, and is told as a share of that one's range."""
        return SCORES[self.score].powers == (1, 0)

    def worst(self, process: Process, candidate: TriedController) -> tuple[str, float] | None:
        """Return the signal that is worst beside its range, and its value [SI]; None for none."""
        told = by_signal(candidate.scores, self.score)
        unasked = process.averaging if self.held else ()
        found = {
            name: value
            for name, value in told.items()
            if name not in unasked and not math.isnan(value)
        }
        if not found or (self.score in _OF_SWITCHES and candidate.controller.setpoints):
            return None
        if self.score == TIME_OUTSIDE.key and not departures(process, candidate.scores):
            return None
        name = max(found, key=lambda each: self.compared(process, each, found[each]))
        return name, found[name]

    def cell(self, process: Process, candidate: TriedController) -> str:
        """Return the number in a unit that all signals share; a dash for none, or for nothing."""
        worst = self.worst(process, candidate)
        if worst is None or not worst[1]:
            return "–"
        shared = not self.is_share or not process.signal(worst[0]).has_range
        return self.text(process, *worst) if shared else _of_range(process, *worst)

    def words(self, process: Process, candidate: Candidate) -> str:
        """Return the number in a clause; empty for none, and where it is nothing."""
        worst = self.worst(process, candidate)
        if worst is None or not worst[1]:
            return ""
        if math.isinf(worst[1]):
            return self.endless
        return self.sentence.format(self.text(process, *worst), signal=worst[0])


def time_or_never(process: Process, name: str, value: float) -> str:
    """Return a time [s] as a table shows it; never where it has no end."""
    return "never" if math.isinf(value) else time_cell(value)


def _deviation(process: Process, name: str, value: float) -> str:
    """Return a deviation of a measurement as one of the level that it measures, and of the range.

    The ranking has the latter, since its rows may tell of signals of different units.
    """
    value = settled(value, DEVIATION * process.signal(name).span)
    signal, gain = shown_signal(process, name)
    unit = unit_text(signal.shown_unit)
    words = f"{number_text(value / abs(gain) * display_factor(signal), 2)} {unit}".strip()
    share = _of_range(process, name, value)
    return words if words == share else f"{words} ({share} of range)"


def _of_range(process: Process, name: str, value: float) -> str:
    return f"{number_text(100.0 * value / process.signal(name).span, 2)} %"


def _percent(process: Process, name: str, value: float) -> str:
    return f"{settled(value, 100.0 * DEVIATION):.0f} %".replace("-0 %", "0 %").replace("-", "−")


def _turns(process: Process, name: str, value: float) -> str:
    return f"{value:.0f} times" if value != 1.0 else "once"


def _plain(unit: str) -> Callable[[Process, str, float], str]:
    return lambda process, name, value: f"{number_text(value, 2)} {unit}".strip()


#: What says something of controllers that switch, and have no setpoint.
_OF_SWITCHES = ("starts_per_hour",)
_RATE, _STARTS = "m³/h per h", "times/h"
_TIME, _SHARE, _WHOLE_SHARE = Form(is_time=True), Form("%"), Form("%", 0)
#: What an engineer asks first.
_FIGURES = (
    Figure(
        "settling_time", "settles", "settles in {}", time_or_never, _TIME,
        "does not settle within the run", held=True,
    ),
    Figure(
        "peak_deviation", "deviates", "holds {signal} to ±{} under load", _deviation, _SHARE,
        held=True,
    ),
    Figure(
        "outflow_rate", "outflow changes", "changes the outflow by at most {}",
        _plain(_RATE), Form(_RATE),
    ),
    Figure(
        "outflow_overshoot", "outflow overshoots", "lets it overshoot by {} of the step", _percent,
        _WHOLE_SHARE,
    ),
    Figure("outflow_swings", "swings", "", _turns, Form("times", 0)),
    Figure("volume_used", "tank used", "uses {} of the tank", _percent, _WHOLE_SHARE),
    Figure(TIME_OUTSIDE.key, "outside band", "", time_or_never, _TIME),
    Figure("starts_per_hour", "starts", "starts {signal} {}", _plain(_STARTS), Form(_STARTS)),
    Figure(
        "noise_movement", "noise", "lets noise move {signal} by {} of its range", _of_range, _SHARE,
        limit=Limit(100.0 * QUIET, "Noise moves a manipulated variable by"),
    ),
    Figure("overshoot", "overshoot", "", _percent, _WHOLE_SHARE, held=True),
)  # fmt: skip


def figures_of(process: Process) -> list[Figure]:
    """Return what counts for a process: of one whose levels average, what they do to the outflow.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> [figure.title for figure in figures_of(load_process("equalisation-tank"))]
    ['outflow changes', 'outflow overshoots', 'swings', 'tank used', 'starts', 'noise']
    """
    averages_only = set(process.controlled) <= set(process.averaging)
    unasked = set() if process.bands else {TIME_OUTSIDE.key}
    return [
        figure
        for figure in _FIGURES
        if figure.score not in unasked and not (figure.held and averages_only)
    ]


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
    """Return how good a controller is, as what follows its name in a sentence."""
    said = []
    for figure in figures_of(process):
        within = _within_bands(candidate) if figure.score == "volume_used" else []
        said += within or [figure.words(process, candidate)]
    return listed([words for words in said if words])
