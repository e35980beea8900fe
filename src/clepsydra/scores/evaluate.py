"""All scores of one run."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from clepsydra.scores.marks import along, marks, per_step
from clepsydra.scores.sample import Sample
from clepsydra.scores.score import SCORES, Of, Score
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.trajectory import FloatArray

Fields = dict[str, FloatArray]


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
    told = marks(run.time, run.segments)
    found = {}
    for of, signals in _signals(run).items():
        scores = [score for score in SCORES.values() if score.of is of]
        for name, fields in signals.items():
            sample = _sample(run, told, of, name, fields)
            for score in scores:
                value = _value(run, score, name, sample) if _allows(run, score, name) else None
                if value is not None and not math.isnan(value):
                    found[f"{score.key}[{name}]"] = value
    return found


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


def _sample(run: ScoredRun, told: Fields, of: Of, name: str, signals: Fields) -> Sample | None:
    """Return the samples of a signal; None where a value is not finite."""
    if not all(np.all(np.isfinite(values)) for values in signals.values()):
        return None
    if of is Of.CONTROLLED:
        told = told | {"per_step": per_step(run.time, run.segments, name)}
    sample = along(run.time, told, **signals)
    return replace(sample, band=run.plant.bands[name]) if of is Of.BAND else sample


def _signals(run: ScoredRun) -> dict[Of, dict[str, Fields]]:
    """Return what the samples of each signal are made of, by the fields of `Sample`."""
    plant, outputs = run.plant, run.outputs
    lift = {name: plant.gravity * np.maximum(head, 0.0) for name, head in plant.heads.items()}
    return {
        Of.CONTROLLED: {
            name: {"now": outputs[name], "next_setpoint": setpoint}
            for name, setpoint in run.setpoints.items()
        },
        Of.AVERAGING: {
            name: {"inflow": buffer.inflow, "outflow": buffer.outflow}
            for name, buffer in plant.buffers.items()
        },
        Of.BAND: {name: {"now": outputs[name]} for name in plant.bands},
        Of.MANIPULATED: {name: {"now": values} for name, values in run.inputs.items()},
        Of.PUMP: {
            name: {"now": flow, "running": plant.running[name]}
            | ({"lift": lift[name]} if name in lift else {})
            for name, flow in plant.pumped.items()
        },
        Of.TANK: {name: {"now": spilt} for name, spilt in plant.spilt.items()},
        Of.INNER_LOOP: {name: {"now": setpoint} for name, (setpoint, *_) in run.inner.items()},
    }
