"""The columns of a ranking as a page computes them anew from the scores of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from clepsydra.report.figures import Figure, figures_of
from clepsydra.report.live.live_scores import LiveScores
from clepsydra.report.study_answer import ranking_columns
from clepsydra.scores.score_key import by_signal
from clepsydra.studies.judge import Judge
from clepsydra.studies.result import StudyResult

#: Digits of a multiple and of a peak, as in the ranking.
_DIGITS = 3


@dataclass
class _Column:
    """A column: its title, how its number is made of scores, and how that stands in a cell."""

    title: str
    kind: str
    parts: list[dict[str, Any]] = field(default_factory=list)
    groups: list[list[dict[str, Any]]] = field(default_factory=list)
    least: float = 1.0
    unit: str = ""
    digits: int = _DIGITS
    time: bool = False
    limit: dict[str, Any] | None = None


def live_columns(result: StudyResult, scores: LiveScores) -> list[dict[str, Any]]:
    """Return the columns of `clepsydra.report.study_answer.ranking_columns` that a page can fill.

    Parameters
    ----------
    scores : LiveScores
        Of the run in the page; a figure without a score that it has is left empty.
    """
    found = [_figure(figure, result, scores) for figure in figures_of(result.process)]
    judge = judge_of(result)
    groups = {title: _group(judge, keys, scores) for title, keys in judge.judged.items()}
    if len(groups) > 1:
        named = ((f"{title}, × best", group) for title, group in groups.items())
        found += [_Column(title, "multiples", groups=[group]) for title, group in named]
    least = result.ranking[0].mean_error
    found += [
        _Column("relative error", "multiples", groups=list(groups.values()), least=least),
        _Column(
            "total variation, × least", "multiples", groups=[_group(judge, judge.worn, scores)]
        ),
        _Column("max|S|", "peak"),
    ]
    shown = {column.title for column in ranking_columns(result)}
    return [vars(column) for column in found if column.title in shown]


def judge_of(result: StudyResult) -> Judge:
    """Return what the controllers of a study were compared by."""
    ranking = result.ranking
    first = [each for each in ranking if each.standing is ranking[0].standing]
    return Judge(ranking[0], first, ranking[0].standing, result.judged_by)


def keys_of(result: StudyResult) -> list[str]:
    """Return the scores that the columns are made of."""
    judge, example = judge_of(result), result.ranking[0]
    figures = [
        f"{figure.score}[{name}]"
        for figure in figures_of(result.process)
        for name in _signals(figure, result)
    ]
    judged = [key for keys in judge.judged.values() for key in keys]
    return [key for key in dict.fromkeys([*figures, *judged, *judge.worn]) if key in example.scores]


def _signals(figure: Figure, result: StudyResult) -> list[str]:
    unasked = result.process.averaging if figure.held else ()
    told = by_signal(result.ranking[0].scores, figure.score)
    return [name for name in told if name not in unasked]


def _figure(figure: Figure, result: StudyResult, scores: LiveScores) -> _Column:
    process, form = result.process, figure.form
    column = _Column(
        figure.title,
        "figure",
        unit=form.unit,
        digits=form.digits,
        time=form.is_time,
        limit=vars(figure.limit) if figure.limit else None,
    )
    for name in _signals(figure, result):
        place = scores.place(f"{figure.score}[{name}]")
        if place is None:
            continue
        column.parts.append({"score": place, "scale": figure.compared(process, name, 1.0)})
    return column


def _group(judge: Judge, keys: Sequence[str], scores: LiveScores) -> list[dict[str, Any]]:
    found = []
    for key in keys:
        best, smallest, less = judge.yardstick(key)
        found.append({"score": scores.place(key), "best": best, "smallest": smallest, "less": less})
    return found
