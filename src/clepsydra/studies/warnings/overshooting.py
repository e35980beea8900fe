"""How far a controller overshoots steps of its setpoints, and by how much less with what."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.remark import Remark
from clepsydra.base.signal import path
from clepsydra.base.words import listed, time_text
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.scores.score_key import by_signal

#: An overshoot worth watching [% of the step].
OVERSHOOT = 10.0
#: Shares of the setpoint weights that are tried as a remedy, the largest first.
_SHARES = np.linspace(0.9, 0.0, 10)
#: Shares of the time from step to step over which the setpoint is ramped as a remedy.
_RAMPS = (0.02, 0.05, 0.1, 0.2, 0.4)


def overshooting(run: Run, model: LinearModel, scores: Mapping[str, float]) -> tuple[Remark, ...]:
    """Return how far a controller overshoots a setpoint step, if that is far, and what helps.

    The remedy was simulated: a lower setpoint weight b if there is one, else a ramp.

    Parameters
    ----------
    model : LinearModel
        Of the process at the operating point where the run begins.
    scores : mapping
        Of the run; that a level which averages overshoots is no fault.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> run = cl.simulate(plant, cl.design.amigo(plant))
    >>> print(*overshooting(run, plant.measured, run.scores))
    It overshoots a step of the setpoint by 14 %; lower b to 0.9: 10 %.
    """
    averaging, followed = run.process.averaging, run.controller.setpoints
    told = {
        name: value
        for name, value in by_signal(scores, "overshoot").items()
        if name in followed and name not in averaging
    }
    worst = max(told.values(), default=0.0)
    if not math.isfinite(worst) or round(worst) <= OVERSHOOT:  # in whole per cent, as it is told
        return ()
    seen = f"It overshoots a step of the setpoint by {worst:.0f} %"
    try:
        remedy = _lower_weights(run, model, list(told)) or _ramp(run, model, list(told))
    except ClepsydraError:  # a remedy that cannot be simulated is none
        remedy = ""
    return (Remark(seen, remedy=remedy or "make the loop slower"),)


def _lower_weights(run: Run, model: LinearModel, outputs: list[str]) -> str:
    """Return which setpoint weights bring the overshoot down, in words; none where none do."""
    values = run.controller.values
    own = {
        name: values[weight]
        for name in outputs
        if values.get(weight := path(name, "setpoint_weight"), 0.0) > 0.0
    }
    if not own:
        return ""
    from clepsydra.studies.tuning.batch import BatchEvaluation

    batch = BatchEvaluation(
        run.controller, model, run.scenario, [f"overshoot[{name}]" for name in outputs]
    )
    # Of two digits: the number that is told is the number that was tried.
    tried = {name: np.array([float(f"{b * s:.2g}") for s in _SHARES]) for name, b in own.items()}
    found = batch.run({path(name, "setpoint_weight"): b for name, b in tried.items()})
    worst = np.max([found.scores[f"overshoot[{name}]"] for name in outputs], axis=0)
    good = np.flatnonzero((worst <= OVERSHOOT) & (found.status == 0))
    if not good.size:
        return ""
    first = int(good[0])
    if len(outputs) == 1:
        (lower,) = tried.values()
        return f"lower b to {lower[first]:.2g}: {worst[first]:.0f} %"
    words = [f"b of {name} to {lower[first]:.2g}" for name, lower in tried.items()]
    return f"lower {listed(words)}: {worst[first]:.0f} %"


def _ramp(run: Run, model: LinearModel, outputs: list[str]) -> str:
    """Return over which time to ramp the setpoint instead of a step, in words; none if none do."""
    scenario, process = run.scenario, run.process
    steps = [e for e in scenario.segments if e.kind == "setpoint" and e.signal in outputs]
    period = scenario.sampling_period
    loop = Loop(run.controller, model)
    for share in _RAMPS:
        setpoints = scenario.setpoints.copy()
        for step in steps:
            begin, end = round(step.start / period), round(step.stop / period)
            count = max(1, round(share * (end - begin)))
            column = process.controlled.index(step.signal)
            setpoints[begin : begin + count, column] -= step.size * (
                1.0 - np.arange(1, count + 1) / count
            )
        (ramped,) = loop.runs(replace(scenario, setpoints=setpoints), [loop.substeps])
        worst = 0.0
        for step in steps:
            begin, end = round(step.start / period), round(step.stop / period)
            target = scenario.setpoints[begin, process.controlled.index(step.signal)]
            beyond = (ramped.true_measurement(step.signal)[begin:end] - target) / step.size
            worst = max(worst, 100.0 * float(np.max(beyond)))
        if worst <= OVERSHOOT:
            time = share * min(step.stop - step.start for step in steps)
            return f"ramp the setpoint over {time_text(time, 2)}: {worst:.0f} %"
    return ""
