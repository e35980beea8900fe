"""What a tuning found, in words and numbers, and the controller."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.designs.designed_values import designed_values
from clepsydra.designs.request import in_shown_unit
from clepsydra.linear.linearise import operating_point_of
from clepsydra.scores.score_key import score_key
from clepsydra.studies.tuning.drawn_problem import DrawnProblem
from clepsydra.studies.tuning.over_draws import TunedOverDraws

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.process.process import Process
    from clepsydra.studies.tuning.pareto import ParetoFront
    from clepsydra.studies.tuning.problem import Judgement, TuningProblem

#: A limit this near counts as one that binds, a share of it.
_BINDS = 1e-3


@dataclass(frozen=True, eq=False)
class TuningResult:
    """The best controller of a tuning, and how it was found.

    Parameters
    ----------
    controller : Controller
        With the values found; its design sentence and notes say how.
    objective, start_objective : float
        What was minimised; over drawn plants their quantile, infinite where too many fail.
    scores, start_scores : dict
        "score[signal]" to value, of everything that was minimised or limited, on the plant itself.
    maximum_sensitivity, start_maximum_sensitivity : float
        max|S| of all loops together [1].
    binding : tuple of str
        In words: the limits and bounds that the best candidate stands on.
    evaluations : int
        Different candidates simulated, probes for derivatives included.
    history : ndarray [steps, 2]
        Number of evaluations and the best objective by then, whenever it fell; the last is that
        of the controller, whose values are rounded.
    front : ParetoFront
        Objective against max|S|.
    interrupted : bool
        Whether it was stopped before its end; the controller is then the best so far.
    tuned : dict
        What was tuned to the value found: parameters of the law, or design numbers.
    instead_of : Path, optional
        State file of another problem that was there, and that this tuning did not go on from.
    over_draws : TunedOverDraws, optional
        What it came to on drawn plants, where it was tuned over some.
    """

    controller: Controller
    objective: float
    start_objective: float
    scores: dict[str, float]
    start_scores: dict[str, float]
    maximum_sensitivity: float
    start_maximum_sensitivity: float
    binding: tuple[str, ...]
    evaluations: int
    history: np.ndarray
    front: ParetoFront
    seed: int
    interrupted: bool
    tuned: dict[str, float]
    instead_of: Path | None = None
    over_draws: TunedOverDraws | None = None


def why_none(problem: TuningProblem) -> str:
    """Return why a search ended without a controller."""
    limits, process = problem.limits, problem.batch.loop.process
    said = [f"max|S| at most {limits.maximum_sensitivity:g}"]
    said = said if np.isfinite(limits.maximum_sensitivity) else []
    said += [f"damping at least {limits.damping:g}"] if limits.damping > 0.0 else []
    said += [_rest_words(limits.rest)] if np.isfinite(limits.rest) else []
    said += [limit_words(name, limit, process) for name, limit in problem.limited.items()]
    remedy = "widen the bounds or the limits"
    if isinstance(problem, DrawnProblem) and problem.why_none:
        said.append(problem.why_none)
        remedy += ", or lower the quantile"
    return (
        f"none of {problem.evaluations} candidates keeps {' and '.join(said) or 'its tanks'}; "
        f"{remedy}"
    )


def _rest_words(rest: float) -> str:
    return f"rest within {time_text(rest, 2)} of a change"


def _binding(problem: TuningProblem, point: np.ndarray, judged: Judgement) -> tuple[str, ...]:
    said, space = [], problem.space
    if judged.sensitivity >= problem.limits.maximum_sensitivity * (1.0 - _BINDS):
        said.append(f"max|S| at most {problem.limits.maximum_sensitivity:g}")
    if problem.limits.damping > 0.0 and judged.damping <= problem.limits.damping * (1.0 + _BINDS):
        said.append(f"damping at least {problem.limits.damping:g}")
    rest = problem.limits.rest
    if np.isfinite(rest) and problem.loops.decay_times(point[None])[0] >= rest * (1.0 - _BINDS):
        said.append(_rest_words(rest))
    for (name, limit), margin in zip(problem.limited.items(), judged.margins, strict=True):
        if margin <= _BINDS:
            said.append(limit_words(name, limit, problem.batch.loop.process))
    for parameter, share in zip(space.parameters, point, strict=True):
        if _BINDS < share < 1.0 - _BINDS:
            continue
        bound = parameter.low if share <= _BINDS else parameter.high
        # A gain is said without its sign, and then the low bound of a negative one is the larger.
        largest = (share <= _BINDS) == space.turns(parameter.name, bound)
        which = "at most" if largest else "at least"
        name, shown = space.name_of(parameter.name), space.shown(parameter.name, bound)
        said.append(f"{name} {which} {shown}")
    return tuple(said)


def outcome(
    problem: TuningProblem, front: ParetoFront, seed: int, interrupted: bool
) -> TuningResult:
    """Return what a search found; the problem has a best candidate."""
    best = problem.best
    assert best is not None
    space = problem.space
    start = space.controller
    values = designed_values(
        start.law, space.controller_values(best.point), operating_point_of(problem.batch.loop.model)
    )
    judged = problem.judge(values)
    binding = _binding(problem, best.point, judged)
    over = problem.came_to(values) if isinstance(problem, DrawnProblem) else None
    objective = judged.objective if over is None else over.tuned.objective
    start_objective = problem.start.objective if over is None else over.start.objective
    numbers = {
        # A parameter of the law itself is rounded, as it runs.
        name: values.get(name, float(column[0]))
        for name, column in space.numbers_at(best.point).items()
    }
    said = ", ".join(
        f"{space.name_of(p.name)} = {space.shown(p.name, numbers[p.name])}"
        for p in space.parameters
    )
    notes = [
        f"Objective: {problem.words}: {objective:.4g}, at the start {start_objective:.4g}.",
        f"On its limit: {'; '.join(binding)}." if binding else "No limit binds.",
        f"{problem.evaluations} candidates simulated, seed {seed}"
        + (", stopped before the end." if interrupted else "."),
    ]
    resting = problem.batch.resting.at({name: np.array([each]) for name, each in values.items()})
    controller = replace(
        start,
        name=f"{start.name}, tuned",
        design=(
            f"Tuned by simulation from {start.name} for {problem.words}: {said}; "
            f"sensitivity peak of all loops together {judged.sensitivity:.2f}."
        ),
        values=values,
        initial_state={
            **start.initial_state,
            **{name: float(state[0]) for name, state in resting.items()},
        },
        notes=(*start.notes, *notes, *space.notes(numbers)),
        slowed=1.0,
    )
    return TuningResult(
        controller=controller,
        objective=objective,
        start_objective=start_objective,
        scores=judged.scores,
        start_scores=problem.start_scores,
        maximum_sensitivity=judged.sensitivity,
        start_maximum_sensitivity=problem.start.sensitivity,
        binding=binding,
        evaluations=problem.evaluations,
        history=np.array([*problem.history[:-1], (problem.history[-1][0], objective)]),
        front=front,
        seed=seed,
        interrupted=interrupted,
        tuned=numbers,
        over_draws=over,
    )


def limit_words(name: str, limit: float, process: Process) -> str:
    """Return a limit of a score [its unit], "total_variation[duty]" say, as a phrase.

    Examples
    --------
    >>> import clepsydra as cl
    >>> limit_words("total_variation[duty]", 2.077, cl.load("wet-well").process)
    'total variation of duty at most 207.7 %'
    >>> limit_words("lowest_under_load[level]", 0.3, cl.load("equalisation-tank").process)
    'level at least 30 % under load'
    """
    score, signal = score_key(name)
    if score == "overshoot":
        shown = f"{limit:.4g} %"
    else:
        shown = in_shown_unit(process.signal(signal), limit, digits=4)
    end, _, when = score.partition("_")
    if end in ("lowest", "highest"):
        words = f"{signal} at {'least' if end == 'lowest' else 'most'} {shown}"
        return " ".join([words, *when.split("_")]).rstrip()
    return f"{score.replace('_', ' ')} of {signal} at most {shown}"
