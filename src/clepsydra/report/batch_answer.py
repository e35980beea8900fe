"""What came of a controller over many plants, in a screen."""

from __future__ import annotations

from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.report.score_tables import score_text
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_scores import DrawnScores
from clepsydra.studies.robustness.tally import Tally

_CHANCES = (0.05, 0.5, 0.95)


def batch_answer(loops: DrawnLoops, drawn: DrawnScores) -> Section:
    """Return what happened, and the quantiles of each score."""
    tally, process = Tally.of(drawn), loops.plants.point.process
    title = f"{loops.controller.title} on {process.name}, {tally.draws:,} plants"
    parts: list[Line | Table] = [
        Line(f"{str(what).capitalize()}: {count:,} of {tally.draws:,} draws.", Mark.WATCH)
        for what, count in tally.happened.items()
        if count
    ]
    rows = []
    for name, found in tally.scores.items():
        if found[0] is None:
            continue
        score, signal = score_key(name)
        worst = found[0].extremes.worst()
        values = [*(found[0].quantile(chance).value for chance in _CHANCES), worst.value]
        declared = SCORES.get(score)
        texts = [
            score_text(process, signal, value, declared, loops.scenario.duration)
            if declared
            else (f"{value:.4g}", loops.units[name])
            for value in values
        ]
        unit = next((unit for _, unit in texts if unit), "")
        rows.append((name, *(number for number, _ in texts), unit, str(worst.draw)))
    head = ("score", "5 %", "median", "95 %", "worst", "unit", "draw")
    return Section(title, (*parts, Table("Scores over the plants", head, tuple(rows))))
