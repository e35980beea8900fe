"""All scores of one run."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from clepsydra.scores.marks import along, marks, per_step
from clepsydra.scores.sample import Sample
from clepsydra.scores.score import SCORES, Of, Score
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.trajectory import FloatArray


def score_run(run: ScoredRun) -> dict[str, float]:
    """Return "score[signal]" to value, of every score that a run allows.

    A score that no segment asks for is left out, and so is one for which the process says too
    little. A response that never gets there, and any score of a signal with a value that is not
    finite, is infinite.

    Examples
    --------
    >>> scores = score_run(ScoredRun(np.array([0.0, 1.0]), {"y": np.array([1.0, 1.0])},
    ...                              {"y": np.array([0.0, 1.0])}, {"u": np.array([2.0, 5.0])},
    ...                              {"u": (0.0, 5.0)}))
    >>> scores["iae[y]"], scores["total_variation[u]"], scores["time_in_saturation[u]"]
    (0.5, 3.0, 1.0)
    """
    signals: dict[Of, Iterable[str]] = {
        Of.CONTROLLED: run.setpoints,
        Of.AVERAGING: run.plant.buffers,
        Of.BAND: run.plant.bands,
        Of.MANIPULATED: run.inputs,
        Of.PUMP: run.plant.pumped,
        Of.TANK: run.plant.spilt,
        Of.INNER_LOOP: run.inner,
    }
    told = marks(run.time, run.segments)
    found = {
        f"{score.key}[{name}]": _value(run, score, name, sample)
        for of, names in signals.items()
        for name in names
        for sample in [_sample(run, told, of, name)]
        for score in SCORES.values()
        if score.of is of and _allows(run, score, name)
    }
    return {name: v for name, v in found.items() if v is not None and not math.isnan(v)}


def _allows(run: ScoredRun, score: Score, name: str) -> bool:
    if score.wants == "own step":
        return bool(run.steps(name))
    if score.wants == "head":
        return name in run.plant.heads
    return not score.wants or any(segment.kind == score.wants for segment in run.segments)


def _value(run: ScoredRun, score: Score, name: str, sample: Sample | None) -> float | None:
    if score.over is None:
        return math.inf if sample is None else score.folded(sample)
    found = score.over(run, name)
    broken = score.of is Of.CONTROLLED and sample is None
    return math.inf if found is not None and broken else found


def _sample(run: ScoredRun, told: dict[str, FloatArray], of: Of, name: str) -> Sample | None:
    """Return the samples of a signal; None where a value is not finite."""
    signals = _signals(run, of, name)
    if not all(np.all(np.isfinite(values)) for values in signals.values()):
        return None
    if of is Of.CONTROLLED:
        told = told | {"per_step": per_step(run.time, run.segments, name)}
    sample = along(run.time, told, **signals)
    return replace(sample, band=run.plant.bands[name]) if of is Of.BAND else sample


def _signals(run: ScoredRun, of: Of, name: str) -> dict[str, FloatArray]:
    """Return what the samples of a signal are made of, by the fields of `Sample`."""
    plant = run.plant
    if of is Of.CONTROLLED:
        return {"now": run.outputs[name], "next_setpoint": run.setpoints[name]}
    if of is Of.BAND:
        return {"now": run.outputs[name]}
    if of is Of.MANIPULATED:
        return {"now": run.inputs[name]}
    if of is Of.AVERAGING:
        buffer = plant.buffers[name]
        return {"inflow": buffer.inflow, "outflow": buffer.outflow}
    if of is Of.PUMP:
        found = {"now": plant.pumped[name], "running": plant.running[name]}
        if name in plant.heads:
            found["lift"] = plant.gravity * np.maximum(plant.heads[name], 0.0)
        return found
    return {"now": plant.spilt[name] if of is Of.TANK else run.inner[name][0]}
