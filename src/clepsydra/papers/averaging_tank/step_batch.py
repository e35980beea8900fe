"""One controller through steps of many sizes in one run, a lane each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_kernel import loop_kernel
from clepsydra.papers.averaging_tank.step_run import MEASURED
from clepsydra.scores.iae import absolute_error
from clepsydra.scores.sample import Sample


def step_batch(
    controller: Controller,
    model: LinearModel,
    sizes: Sequence[tuple[float, float]],
    horizon: float,
) -> dict[str, np.ndarray]:
    """Run a controller from the equilibrium through steps of C [kmol/m³] and V [m³] for a time [s].

    Returns time [n], and setpoints [lanes, 1], outputs and inputs [lanes, n] by name.
    """
    loop = Loop(controller, model)
    period = loop.process.sampling_period
    still, samples, targets = loop.at_rest(), round(horizon / period) + 1, {}
    for place, (name, factor) in enumerate(MEASURED.values()):
        setpoint = f"{name}.setpoint"
        targets[setpoint] = still.pop(setpoint) + factor * np.array(sizes)[:, [place]]
    kernel = loop_kernel(loop.process, controller, still, loop.substeps, individual=tuple(targets))
    found = kernel.run(
        samples,
        inputs={name: np.tile(target, samples) for name, target in targets.items()},
        state=loop.initial_state(),
        parameters=loop.law_parameters(),
    )
    outputs = {signal.name: found.output(signal.name) for signal in kernel.program.outputs}
    return {**targets, **outputs, "time": np.arange(samples) * period}


def absolute_errors(run: dict[str, np.ndarray]) -> np.ndarray:
    """Return ∫ |e| dt of C [kmol s/m³] and V [m³ s] of each lane of `step_batch` [2, lanes]."""
    errors, period = [], run["time"][1]
    for name, factor in MEASURED.values():
        y, target = run[name] / factor, run[f"{name}.setpoint"] / factor
        sample = Sample(before=y[:, :-1], now=y[:, 1:], setpoint=target)
        # Where an error stays zero, 0/0 is chosen nowhere.
        with np.errstate(invalid="ignore"):
            errors.append(period * np.sum(absolute_error(sample), axis=1))
    return np.array(errors)
