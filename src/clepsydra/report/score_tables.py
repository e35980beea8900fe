"""Scores as rows of text: the ranking, and all scores of one controller with their units."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from clepsydra.process.process import Process
from clepsydra.report.quantities import display_factor, number_text, time_cell, unit_text
from clepsydra.report.resolution import DEVIATION, INTEGRAND, settled
from clepsydra.scores.score import SCORES, Of, Score
from clepsydra.studies.ranking import RULE
from clepsydra.studies.ranking_words import IDLE
from clepsydra.studies.result import Candidate, Standing, StudyResult


@dataclass(frozen=True)
class RankingColumn:
    """A column of numbers in the ranking: its title, its unit, and where the number is from.

    Examples
    --------
    >>> column = RankingColumn("max|S|", "", lambda _, candidate: candidate.maximum_sensitivity)
    >>> column.title
    'max|S|'
    """

    title: str
    unit: str
    value: Callable[[Process, Candidate], float]


@dataclass(frozen=True)
class RankingRow:
    """One controller in the ranking: `cells` follow `ranking_columns`.

    Parameters
    ----------
    rank : int
    controller : str
    standing : str
        How far it can be trusted, in a word.
    cells : tuple of str
    reason : str
        Of the first three in full, of the others what puts them there: the numbers stand in the
        cells.

    Examples
    --------
    >>> RankingRow(1, "PI, SIMC", "robust", ("12.4", "8.1"), "Robust.").cells[0]
    '12.4'
    """

    rank: int
    controller: str
    standing: str
    cells: tuple[str, ...]
    reason: str


#: The standing of a controller in a word.
STANDING_WORDS = {
    Standing.ROBUST: "robust",
    Standing.NERVOUS: "nervous",
    Standing.STABLE: "thin margins",
    Standing.OUTSIDE: "leaves its band",
    Standing.UNSAFE: "unsafe",
}
#: From here on decimals say nothing.
_MANY = 1e4
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


def standing_word(candidate: Candidate) -> str:
    """Return how far a controller can be trusted, in a word.

    Examples
    --------
    A law that switches has no margins, and is no more than safe:

    >>> from types import SimpleNamespace
    >>> standing_word(SimpleNamespace(standing=Standing.ROBUST, maximum_sensitivity=math.nan))
    'safe'
    """
    if candidate.standing is Standing.ROBUST and math.isnan(candidate.maximum_sensitivity):
        return "safe"
    return STANDING_WORDS[candidate.standing]


def _worst(score: str, in_percent: bool = False) -> Callable[[Process, Candidate], float]:
    """Return the largest value of a score over its signals, in percent of range if asked."""

    def value(process: Process, candidate: Candidate) -> float:
        found = []
        for key, number in candidate.scores.items():
            name, _, signal = key.removesuffix("]").partition("[")
            if name == score:
                span = process.signal(signal).span
                found.append(100.0 * number / span if in_percent else number)
        return max(found, default=math.nan)

    return value


def _criterion(title: str) -> RankingColumn:
    return RankingColumn(title, "× best", lambda _, candidate: candidate.criteria[title])


def ranking_columns(result: StudyResult) -> tuple[RankingColumn, ...]:
    """Return what a ranking shows of each controller: what decided first.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> [column.title for column in ranking_columns(result)][:4]
    ['setpoint error', 'load error', 'relative error', 'moves']
    """
    titles = tuple(result.ranking[0].criteria) if result.ranking else ()
    deciding = [_criterion(title) for title in titles]
    if len(titles) > 1:
        deciding.append(RankingColumn("relative error", "", lambda _, c: c.relative_error))
    return (
        *deciding,
        RankingColumn("moves", "× least", lambda _, candidate: candidate.wear),
        RankingColumn("noise", "% range", _worst("noise_movement", in_percent=True)),
        RankingColumn("overshoot", "%", _worst("overshoot")),
        RankingColumn("max|S|", "", lambda _, candidate: candidate.maximum_sensitivity),
    )


_COLUMNS_NOTE = (
    "Errors, and moves (total variation), are multiples of the best, averaged over the signals; "
    "relative error is the mean of the errors as a multiple of that of the first. A "
    f"total variation below {100 * IDLE:.0f} % of a manipulated variable's range counts as that "
    "much. Noise is the standard deviation with which measurement noise throws the worst "
    "manipulated variable about, overshoot that of the worst setpoint step, max|S| the peak of the "
    "sensitivity at the controlled measurements; inner loops and manipulated variables have theirs "
    "on the page of the controller."
)


def ranking_note(result: StudyResult) -> str:
    """Return what stands below a ranking: its columns and its rule in words.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> ranking_note(SimpleNamespace(rule="safe ones first."))[-23:]
    'Order: safe ones first.'
    """
    return f"{_COLUMNS_NOTE} Order: {result.rule or RULE}"


def ranking_rows(result: StudyResult) -> list[RankingRow]:
    """Return the ranking as text, best first, for a terminal and for a page.

    Parameters
    ----------
    result : StudyResult

    Returns
    -------
    list of RankingRow

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> [(row.rank, row.controller) for row in ranking_rows(result)]
    [(1, 'PI, AMIGO'), (2, 'PI, SIMC')]
    """
    columns = [
        _aligned([column.value(result.process, candidate) for candidate in result.ranking])
        for column in ranking_columns(result)
    ]
    return [
        RankingRow(
            candidate.rank,
            candidate.controller.title,
            standing_word(candidate),
            tuple(column[place] for column in columns),
            candidate.reason if place < _FULL_REASONS else _short(candidate.reason),
        )
        for place, candidate in enumerate(result.ranking)
    ]


def _short(reason: str) -> str:
    """Return what puts a controller behind another, without the numbers of its row."""
    words, more, _ = reason.rpartition(_NUMBERS_END)[2].partition(_NUMBERS_BEGIN)
    return f"{words}." if more else words


def _aligned(values: Sequence[float]) -> list[str]:
    """Return numbers with two decimals, so that a right-aligned column lines up."""
    return [
        f"{value:.2f}".replace("-", "−") if abs(value) < _MANY else number_text(value)
        for value in values
    ]


@dataclass(frozen=True)
class ScoreTable:
    """Scores of some signals: `rows` are (title, description, [(value, unit), …]).

    Examples
    --------
    >>> ScoreTable(("level_1",), (("IAE", "Integral.", (("50.0", "cm s"),)),)).rows[0][0]
    'IAE'
    """

    signals: tuple[str, ...]
    rows: tuple[tuple[str, str, tuple[tuple[str, str], ...]], ...]


def score_tables(process: Process, candidate: Candidate) -> list[ScoreTable]:
    """Return the scores of a controller: of outputs, of inputs, and of pumps and tanks.

    Values and units are those that the reader sees of each signal.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)])
    >>> outputs, inputs, plant = score_tables(result.process, result.ranking[0])
    >>> [title for title, _, _ in inputs.rows][:3]
    ['Total variation', 'Noise movement', 'Travel']
    """
    of_plant = [key for key, s in SCORES.items() if s.of in (Of.PUMP, Of.TANK, Of.INNER_LOOP)]
    of_signals = [key for key in SCORES if key not in of_plant]
    named = [key.partition("[") for key in candidate.scores]
    plant = tuple(
        dict.fromkeys(name.removesuffix("]") for key, _, name in named if key in of_plant)
    )
    return [
        _score_table(process, candidate, tuple(process.controlled), of_signals),
        _score_table(process, candidate, tuple(u.name for u in process.inputs), of_signals),
        _score_table(process, candidate, plant, of_plant),
    ]


def _score_table(
    process: Process, candidate: Candidate, names: tuple[str, ...], keys: Sequence[str]
) -> ScoreTable:
    rows = []
    for key, description in SCORES.items():
        if key not in keys or not any(f"{key}[{name}]" in candidate.scores for name in names):
            continue
        cells = tuple(
            score_text(
                process,
                name,
                candidate.scores.get(f"{key}[{name}]", math.nan),
                description,
                candidate.run.scenario.duration,
            )
            for name in names
        )
        rows.append((description.title, description.description, cells))
    return ScoreTable(names if rows else (), tuple(rows))


def score_text(
    process: Process, name: str, value: float, score: Score, duration: float = 0.0
) -> tuple[str, str]:
    """Return a score [SI] of a signal and its unit as the reader sees them.

    What `clepsydra.report.resolution` takes for nothing is 0.

    Parameters
    ----------
    process : Process
    name : str
        Of the signal.
    value : float
    score : Score
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
        shown, _, unit = time_cell(value).partition(" ")
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
    """Return title and definition of every score that a study has.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> candidate = SimpleNamespace(scores={"iae[level]": 1.0})
    >>> glossary(SimpleNamespace(ranking=(candidate,)))
    [('IAE', 'Integral of the absolute error over the whole run.')]
    """
    present = {key.partition("[")[0] for entry in result.ranking for key in entry.scores}
    return [(s.title, s.description) for key, s in SCORES.items() if key in present]
