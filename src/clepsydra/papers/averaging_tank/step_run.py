"""The document's experiment: both references step from the equilibrium, and its indices."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.loop.loop import Loop
from clepsydra.loop.profile import Change
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario, scenario_of_changes
from clepsydra.papers.averaging_tank.model import KMOL, high_tank, tank
from clepsydra.papers.averaging_tank.symbols import Variant
from clepsydra.process.process import Process
from clepsydra.scores.integral_errors import IAE, ISE, ITAE, SIGNED_ERROR
from clepsydra.scores.step_response import settling_time

#: Steps of C [kmol/m³] and V [m³]; they are not printed, and follow from the printed indices.
STEPS = {"C": 0.25, "V": 0.1}
#: The printed ISEG fit a derivative over this time, see `lqi`.
PERIOD = 2e-4  # [s]
HORIZON = 30.0  # [s]
MEASURED = {"C": ("concentration", KMOL), "V": ("volume", 1.0)}


@cache
def model_of(constant: Variant, period: float = PERIOD) -> LinearModel:
    """Return the linear model of a variant, sampled with a period [s].

    Examples
    --------
    >>> model_of("outflow").outputs
    ('concentration', 'volume')
    """
    return _model(tank(constant), period)


@cache
def high_model_of(constant: Variant, period: float) -> LinearModel:
    """Return the same model of a tank that is high enough for large steps."""
    return _model(high_tank(f"{constant}-constant"), period)


def _model(process: Process, period: float) -> LinearModel:
    process = dataclasses.replace(process, sampling_period=period)
    model = linearise(find_equilibrium(process))
    return model.select(outputs=["concentration", "volume"])


def step_scenario(
    model: LinearModel, sizes: tuple[float, float], horizon: float = HORIZON
) -> Scenario:
    """Return steps of C [kmol/m³] and V [m³] at the first sample."""
    point = operating_point_of(model)
    at, period = point.as_dict(), point.process.sampling_period
    steps = [
        Change(name, at[name] + factor * size, 0.0, 0.0)
        for (name, factor), size in zip(MEASURED.values(), sizes, strict=True)
    ]
    return scenario_of_changes(point, steps, round(horizon / period) + 1)


def step_run(
    controller: Controller,
    model: LinearModel,
    sizes: tuple[float, float] = (STEPS["C"], STEPS["V"]),
    horizon: float = HORIZON,
) -> Run:
    """Run a controller through steps of C [kmol/m³] and V [m³] at the first sample."""
    return Loop(controller, model).run(step_scenario(model, sizes, horizon))


def step_of(
    run: Run, output: str, size: float | None = None
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Return time, C or V in its SI unit, where its step starts and where it goes.

    Parameters
    ----------
    run : Run
    output : {"C", "V"}
    size : float, optional
        Of its step [kmol/m³ or m³]; that of `STEPS` if left out.
    """
    name, factor = MEASURED[output]
    target = float(run.values[f"{name}.setpoint"][0])
    start = target - factor * (STEPS[output] if size is None else size)
    return run.time, run.true_measurement(name), start, target


def settling(run: Run, output: str, size: float | None = None) -> float:
    """Return when C or V stays within 2 % of its step [s], see `step_of`."""
    return settling_time(*step_of(run, output, size), band=0.02)


def indices(run: Run, horizon: float | None = None) -> dict[tuple[str, str], float]:
    """Return IE, IAE, ISE and ITAE of C and V, in kmol/m³ and m³.

    Parameters
    ----------
    run : Run
    horizon : float, optional
        [s]; the whole run if left out.
    """
    last = len(run.time) if horizon is None else int(np.searchsorted(run.time, horizon)) + 1
    found: dict[tuple[str, str], float] = {}
    for name, (measurement, factor) in MEASURED.items():
        time = run.time[:last]
        target = run.values[f"{measurement}.setpoint"][:last] / factor
        output = run.true_measurement(measurement)[:last] / factor
        for title, score in (("IE", SIGNED_ERROR), ("IAE", IAE), ("ISE", ISE), ("ITAE", ITAE)):
            found[title, name] = score.along(time, target, output)
    return found
