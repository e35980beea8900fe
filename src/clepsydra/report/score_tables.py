"""Scores as rows of text: the ranking, and all scores of one controller with their units."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from clepsydra.base.section import Line, Mark, Table, marked
from clepsydra.base.units import unit_text
from clepsydra.designs.slowing_down import SLOWED_WORDS
from clepsydra.process.process import Process
from clepsydra.report.facts import DIGITS
from clepsydra.report.figures import figures_of, time_or_never
from clepsydra.report.pid_tables import SETTINGS_WORDS
from clepsydra.report.quantities import (
    DEVIATION,
    INTEGRAND,
    display_factor,
    number_text,
    quantity_text,
    settled,
)
from clepsydra.scores.effort import IDLE
from clepsydra.scores.score import SCORES, Of, Score, in_sentence
from clepsydra.scores.score_key import score_key
from clepsydra.studies.ranking import RULE
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.tuning.result import TuningResult

#: Units that the definition of the score says at length.
_SHARES = {"% of the step": "%", "% of the tank": "%", "% of range per h": "%/h"}
#: Percentages of a whole, of which a millionth says nothing.
_OF_WHOLE = ("% of the step", "% of the tank")
#: Integrals of runs up to this long are in seconds [s].
_IN_SECONDS = 3.0 * 3600.0
#: So many reasons stand in full.
_FULL_REASONS = 3
#: Where the numbers of a reason end, and where further ones begin.
_NUMBERS_END, _NUMBERS_BEGIN = "total variation. ", ", most of all by "


_COLUMNS_NOTE = (
    "Of several signals a column has the worst; a deviation and noise are in percent of the "
    "signal's range. What never settles does not settle within the run. "
    "Errors and total variation are multiples of the best, averaged over the signals; "
    "relative error is the mean of the errors as a multiple of that of the first. A "
    f"total variation below {100 * IDLE:.0f} % of a manipulated variable's range counts as that "
    "much. Max|S| is the peak of the sensitivity at the controlled measurements; inner loops and "
    "manipulated variables have theirs with the controller."
)
_CASES_NOTE = (
    "Physical numbers of the ranking are those of the base case; standing and multiples are those "
    "of each controller's worst case. "
)
_AVERAGING_NOTE = (
    "A level that averages is meant to move: how it settles, deviates and overshoots is with the "
    "controller in the report. "
)


def ranking_notes(result: StudyResult) -> tuple[Line, ...]:
    """Return what stands below a ranking: its columns, its rule, and what settings mean."""
    columns = [
        (each.title, SCORES[each.score].description)
        for each in figures_of(result.process)
        if any(each.worst(result.process, candidate) for candidate in result.ranking)
    ]
    if any(each.controller.slowed > 1.0 for each in result.ranking):
        columns.insert(0, ("slowed", SLOWED_WORDS))
    averaging = _AVERAGING_NOTE if result.process.averaging else ""
    cases = _CASES_NOTE if result.cases else ""
    words = f"{averaging}{cases}{_COLUMNS_NOTE} Order: {result.rule or RULE}"
    said = (f"{title.capitalize()}: {in_sentence(meaning)}" for title, meaning in columns)
    return marked(Mark.POINT, (*said, *re.split(r"(?<=\.) (?=[A-Z])", words), SETTINGS_WORDS))


def reasons(ranking: Sequence[Candidate]) -> list[str]:
    """Return why each controller stands where it stands.

    Of the first three in full, of the others what puts them behind another.
    """
    return [
        each.reason if place < _FULL_REASONS else _short(each.reason)
        for place, each in enumerate(ranking)
    ]


def _short(reason: str) -> str:
    """Return what puts a controller behind another, without the numbers of its row."""
    words, more, _ = reason.rpartition(_NUMBERS_END)[2].partition(_NUMBERS_BEGIN)
    return f"{words}." if more else words


def score_tables(process: Process, candidate: Candidate) -> list[Table]:
    """Return the scores of a controller: of outputs, of inputs, and of pumps and tanks.

    Values and units are those that the reader sees of each signal; what no signal has is left out.
    """
    of_plant = [key for key, s in SCORES.items() if s.of in (Of.PUMP, Of.TANK, Of.INNER_LOOP)]
    of_signals = [key for key in SCORES if key not in of_plant]
    plant = dict.fromkeys(name for key, name in map(score_key, candidate.scores) if key in of_plant)
    groups = (
        (process.controlled, of_signals),
        ([signal.name for signal in process.inputs], of_signals),
        (list(plant), of_plant),
    )
    tables = [_score_table(process, candidate, names, keys) for names, keys in groups]
    return [table for table in tables if table.rows]


def _score_table(
    process: Process, candidate: Candidate, names: Sequence[str], keys: Sequence[str]
) -> Table:
    rows, duration = [], candidate.run.scenario.duration
    for key in keys:
        found = [candidate.scores.get(f"{key}[{name}]") for name in names]
        if any(value is not None for value in found):
            told = zip(names, found, strict=True)
            cells = (_cell(process, name, value, SCORES[key], duration) for name, value in told)
            rows.append((SCORES[key].title, *cells))
    return Table("", ("", *names), tuple(rows))


def _cell(process: Process, name: str, value: float | None, score: Score, duration: float) -> str:
    if value is None or math.isnan(value):
        return "–"
    return " ".join(score_text(process, name, value, score, duration)).strip()


def score_text(
    process: Process, name: str, value: float, score: Score, duration: float = 0.0
) -> tuple[str, str]:
    """Return a score [SI] of a signal and its unit as the reader sees them.

    What `clepsydra.report.quantities` takes for nothing is 0.

    Parameters
    ----------
    name : str
        Of the signal.
    duration : float
        Of the run [s]: integrals over more than three hours are shown in hours.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("wet-well")
    >>> score_text(process, "level", 0.024, SCORES["iae"])
    ('24.0', 'mA s')
    >>> score_text(process, "level", 0.024, SCORES["settling_time"])
    ('0.0240', 's')
    >>> score_text(process, "level", 7.2, SCORES["iae"], duration=40000.0)
    ('2.00', 'mA h')
    """
    power, power_of_time = score.powers
    if not score.unit and not power:
        shown, _, unit = time_or_never(process, name, value).partition(" ")
        return shown, unit
    if score.unit:
        if score.unit in _OF_WHOLE:
            value = settled(value, 100.0 * DEVIATION)
        return number_text(value), "" if score.unit == "1" else _SHARES.get(score.unit, score.unit)
    signal = process.signal(name)
    share = INTEGRAND if power_of_time else DEVIATION
    value = settled(value, (share * signal.span) ** power * duration**power_of_time)
    second = ("s", 1.0) if duration <= _IN_SECONDS else ("h", 3600.0)
    shown = number_text(value * display_factor(signal) ** power / second[1] ** power_of_time)
    words = _powered(unit_text(signal.shown_unit), power)
    if power_of_time:
        words = f"{words} {_powered(second[0], power_of_time)}"
    return shown, words.strip()


def _powered(unit: str, power: int) -> str:
    if power == 1 or not unit:
        return unit
    return f"({unit})²" if "/" in unit else f"{unit}²"


def glossary(result: StudyResult) -> list[tuple[str, str]]:
    """Return title and definition of every score that a study has."""
    present = {score_key(key).score for entry in result.ranking for key in entry.scores}
    return [(s.title, s.description) for key, s in SCORES.items() if key in present]


def tuning_grid(tuning: TuningResult, process: Process, duration: float = 0.0) -> Table:
    """Return objective, scores and max\\|S\\| before and after a tuning.

    Over drawn plants also the quantile of each score; infinite where too many plants fail.

    Parameters
    ----------
    process : Process
        Lends display units.
    duration : float
        Of the runs that were compared [s], as `clepsydra.report.score_tables.score_text` takes it.
    """
    peaks = tuning.start_maximum_sensitivity, tuning.maximum_sensitivity
    errors = tuning.start_objective, tuning.objective
    rows = [
        ("objective", *(number_text(value, DIGITS) for value in errors)),
        ("max|S|", *(number_text(value) for value in peaks)),
    ]
    for key, value in tuning.scores.items():
        name, signal = score_key(key)
        before = tuning.start_scores[key]
        if name in SCORES and signal:
            cells = (_cell(process, signal, n, SCORES[name], duration) for n in (before, value))
            rows.append((score_key(key).title, *cells))
        else:
            reached = (quantity_text(process.signal(signal), each) for each in (before, value))
            rows.append((f"{name.capitalize()} {signal}", *reached))
    if over := tuning.over_draws:
        for key, value in over.tuned.scores.items():
            name, signal = score_key(key)
            both = over.start.scores[key], value
            cells = (_cell(process, signal, n, SCORES[name], duration) for n in both)
            rows.append((f"{score_key(key).title}, {over.share}", *cells))
    return Table("Tuned by simulation", ("", "start", "tuned"), tuple(rows))
