"""What single precision does to the scores of a loop."""

from __future__ import annotations

import math
from typing import Any

from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key
from clepsydra.studies.single_precision import error_ratio
from clepsydra.studies.trial import scores_of

#: The number by which a study ranks has changed where its third digit has.
_THIRD_DIGIT = 0.005
#: A score below this share of its natural size is nearly zero.
_LEAST = 1e-3
#: Unit of a score, as `SCORES` tells it, to powers of the signal's range and of the duration.
_SIZES = {
    "signal unit": (1, 0),
    "s": (0, 1),
    "signal unit × s": (1, 1),
    "signal unit × s²": (1, 2),
    "signal unit² × s": (2, 1),
    "signal unit² × s²": (2, 2),
}


def score_change(
    controller: Controller, model: LinearModel, scenario: Scenario | None = None
) -> dict[str, Any]:
    """Run a loop with the controller in double and in single precision, and compare the scores.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        Of the process, at the operating point where the loop starts.
    scenario : Scenario, optional
        The default scenario if omitted.

    Returns
    -------
    dict
        "ranking": the number by which a study ranks controllers (`clepsydra.studies.ranking.RULE`),
        as a multiple of that of the controller in double precision. "score": the score that changes
        most, "iae[level_1]"; empty where none changes. "change": by which share of itself, or of a
        thousandth of its natural size where it is nearly zero: of range and duration for an
        integral of the error, of the range for an offset. "is_change": whether the ranking changes.
        A number that is finite in one precision only is None.

    Raises
    ------
    InputError
        The loop cannot be run or scored.
    """
    scenario = default_scenario(model) if scenario is None else scenario
    loop = Loop(controller, model)
    runs = [loop.run(scenario), loop.run(scenario, precision="single")]
    scores = [scores_of(run) for run in runs]
    largest, name = 0.0, ""
    for key in scores[0]:
        least = _LEAST * _natural_size(key, runs[0])
        change = _relative(scores[0][key], scores[1].get(key, math.nan), least)
        if change > largest:
            largest, name = change, key
    ranking = error_ratio(runs, scores)
    return {
        "ranking": ranking if math.isfinite(ranking) else None,
        "score": name,
        "change": largest if math.isfinite(largest) else None,
        "is_change": is_change(ranking),
    }


def is_change(ranking: float) -> bool:
    """Whether the number that ranks changes in its third digit: by half a percent or more."""
    return not abs(ranking - 1.0) < _THIRD_DIGIT


def _natural_size(key: str, run: Run) -> float:
    """Return what a score is large against, in its own unit; 0 where nothing is known."""
    score, signal = score_key(key)
    by_range, by_time = _SIZES.get(SCORES[score].unit_rule, (0, 0)) if score in SCORES else (0, 0)
    if by_range == by_time == 0:
        return 100.0 if score in SCORES and SCORES[score].unit_rule.startswith("%") else 0.0
    spans = [s.span for s in (*run.process.measurements, *run.process.inputs)
             if s.name == signal]  # fmt: skip
    span = spans[0] if spans and math.isfinite(spans[0]) else 0.0
    return float(span**by_range * run.scenario.duration**by_time)


def _relative(first: float, second: float, least: float) -> float:
    if first == second or (math.isnan(first) and math.isnan(second)):
        return 0.0
    if not (math.isfinite(first) and math.isfinite(second)):
        return math.inf
    return abs(second - first) / max(abs(first), abs(second), least)
