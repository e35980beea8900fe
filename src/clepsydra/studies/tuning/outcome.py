"""The outcome of a search in words and numbers, and the controller that it found."""

from __future__ import annotations

import dataclasses

import numpy as np

from clepsydra.designs.designed_values import designed_values
from clepsydra.linear.linearise import operating_point_of
from clepsydra.studies.tuning.parameter_words import limit_words
from clepsydra.studies.tuning.pareto import ParetoFront
from clepsydra.studies.tuning.problem import Judgement, TuningProblem
from clepsydra.studies.tuning.resting_states import resting_states
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.search_space import NumberWords

#: A limit this near counts as one that binds, a share of it.
_BINDS = 1e-3


def why_none(problem: TuningProblem) -> str:
    """Return why a search ended without a controller."""
    limits, process = problem.limits, problem.batch.loop.process
    said = [f"max|S| at most {limits.maximum_sensitivity:g}"]
    said = said if np.isfinite(limits.maximum_sensitivity) else []
    said += [limit_words(name, limit, process) for name, limit in problem.limited.items()]
    return (
        f"none of {problem.evaluations} candidates keeps {' and '.join(said) or 'its tanks'}; "
        "widen the bounds or the limits"
    )


def _binding(
    problem: TuningProblem, point: np.ndarray, judged: Judgement, words: NumberWords
) -> tuple[str, ...]:
    said = []
    if judged.sensitivity >= problem.limits.maximum_sensitivity * (1.0 - _BINDS):
        said.append(f"max|S| at most {problem.limits.maximum_sensitivity:g}")
    for (name, limit), margin in zip(problem.limited.items(), judged.margins, strict=True):
        if margin <= _BINDS:
            said.append(limit_words(name, limit, problem.batch.loop.process))
    for parameter, share in zip(problem.space.parameters, point, strict=True):
        if _BINDS < share < 1.0 - _BINDS:
            continue
        bound = parameter.low if share <= _BINDS else parameter.high
        # A gain is said without its sign, and then the low bound of a negative one is the larger.
        largest = (share <= _BINDS) == (words.turns(parameter.name, bound))
        which = "at most" if largest else "at least"
        said.append(f"{words.name(parameter.name)} {which} {words.value(parameter.name, bound)}")
    return tuple(said)


def outcome(
    problem: TuningProblem, front: ParetoFront, seed: int, interrupted: bool
) -> TuningResult:
    """Return what a search found.

    Parameters
    ----------
    problem : TuningProblem
        With a best candidate.
    front : ParetoFront
    seed : int
    interrupted : bool
    """
    best = problem.best
    assert best is not None
    space = problem.space
    start = space.controller
    words = space.words
    values = designed_values(
        start.law, space.controller_values(best.point), operating_point_of(problem.batch.loop.model)
    )
    judged = problem.judge(values)
    binding = _binding(problem, best.point, judged, words)
    numbers = {
        # A parameter of the law itself is rounded, as it runs.
        name: values.get(name, float(column[0]))
        for name, column in space.numbers_at(best.point).items()
    }
    said = ", ".join(
        f"{words.name(p.name)} = {words.value(p.name, numbers[p.name])}" for p in space.parameters
    )
    notes = [
        f"Objective: {problem.objective.words}: {judged.objective:.4g}, at the start "
        f"{problem.start.objective:.4g}.",
        f"On its limit: {'; '.join(binding)}." if binding else "No limit binds.",
        f"{problem.evaluations} candidates simulated, seed {seed}"
        + (", stopped before the end." if interrupted else "."),
    ]
    resting = resting_states(
        problem.batch.loop, {name: np.array([value]) for name, value in values.items()}
    )
    controller = dataclasses.replace(
        start,
        name=f"{start.name}, tuned",
        design=(
            f"Tuned by simulation from {start.name} for {problem.objective.words}: {said}; "
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
        objective=judged.objective,
        start_objective=problem.start.objective,
        scores=judged.scores,
        start_scores=problem.start_scores,
        maximum_sensitivity=judged.sensitivity,
        start_maximum_sensitivity=problem.start.sensitivity,
        binding=binding,
        evaluations=problem.evaluations,
        history=np.array([*problem.history[:-1], (problem.history[-1][0], judged.objective)]),
        front=front,
        seed=seed,
        interrupted=interrupted,
        tuned=numbers,
    )
