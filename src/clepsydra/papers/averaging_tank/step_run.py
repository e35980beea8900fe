"""The document's experiment: both references step from the equilibrium; its indices and trends."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
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
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.model import KMOL, high_tank, tank
from clepsydra.papers.averaging_tank.symbols import Variant
from clepsydra.papers.figure import Curve, CurveKind, Figure, Panel
from clepsydra.papers.settling_bands import BANDS
from clepsydra.scores.iae import IAE, ISE, ITAE, SIGNED_ERROR
from clepsydra.scores.step_response import settling_time

#: Steps of C [kmol/m³] and V [m³]; they are not printed, and follow from the printed indices.
STEPS = {"C": 0.25, "V": 0.1}
#: The printed ISEG fit a derivative over this time, see `lqi`.
PERIOD = 2e-4  # [s]
HORIZON = 30.0  # [s]
#: Of the squared derivative in ISEG, (79e) [s²].
(WEIGHT,) = PRINTED.numbers("(79e)", "a")
MEASURED = {"C": ("concentration", KMOL), "V": ("volume", 1.0)}
#: Name, signal, label, factor and kind of curve of each panel.
SIGNALS: tuple[tuple[str, str, str, float, CurveKind], ...] = (
    ("C", "concentration", "C [kmol/m³]", KMOL, "line"),
    ("V", "volume", "V [m³]", 1.0, "line"),
    ("f_in", "inflow", "f_in [m³/s]", 1.0, "held"),
    ("f_out", "outflow", "f_out [m³/s]", 1.0, "held"),
    ("C_in", "inflow.impurity", "C_in [kmol/m³]", KMOL, "held"),
)
_POINTS = 1500


@cache
def model_of(constant: Variant, period: float = PERIOD, *, high: bool = False) -> LinearModel:
    """Return the linear model of a variant, sampled with a period [s]; high for large steps."""
    process = high_tank(f"{constant}-constant") if high else tank(constant)
    model = linearise(find_equilibrium(dataclasses.replace(process, sampling_period=period)))
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
    """Return time, C or V in its SI unit, where its step of a size starts and where it goes."""
    name, factor = MEASURED[output]
    target = float(run.values[f"{name}.setpoint"][0])
    start = target - factor * (STEPS[output] if size is None else size)
    return run.time, run.true_measurement(name), start, target


def settling(run: Run, output: str, band: float = BANDS[0], size: float | None = None) -> float:
    """Return when C or V stays within a share of its step [s], see `step_of`."""
    return settling_time(*step_of(run, output, size), band=band)


#: When an output stays within a share of its step [s].
Settling = Callable[[str, float], float]


def settling_words(output: str, ours: Settling, theirs: Settling) -> str:
    """Tell by both bands when an output settles, in one case against the other."""
    return " and ".join(
        f"{ours(output, band):.3f} s against {theirs(output, band):.3f} s to within "
        f"{100 * band:g} %"
        for band in BANDS
    )


def indices(run: Run, horizon: float | None = None) -> dict[tuple[str, str], float]:
    """Return IE, IAE, ISE and ITAE of C and V, in kmol/m³ and m³, up to a horizon [s]."""
    last = len(run.time) if horizon is None else int(np.searchsorted(run.time, horizon)) + 1
    found: dict[tuple[str, str], float] = {}
    for name, (measurement, factor) in MEASURED.items():
        time = run.time[:last]
        target = run.values[f"{measurement}.setpoint"][:last] / factor
        output = run.true_measurement(measurement)[:last] / factor
        for title, score in (("IE", SIGNED_ERROR), ("IAE", IAE), ("ISE", ISE), ("ITAE", ITAE)):
            found[title, name] = score.along(time, target, output)
    return found


def smooth_iseg(run: Run, output: str) -> float:
    """Return ISE + a ∫ (dy/dt)² dt, all of ISEG but the derivative of the step."""
    name, factor = MEASURED[output]
    slopes = np.diff(run.true_measurement(name) / factor)
    return indices(run)["ISE", output] + WEIGHT * float(slopes @ slopes) / float(run.time[1])


def trend_figure(
    number: str, title: str, runs: Mapping[str, Run], horizon: float, note: str = ""
) -> Figure:
    """Return outputs and inputs of runs by name over a horizon [s], thinned for a picture."""
    panels = []
    for name, signal, label, factor, kind in SIGNALS:
        shown = []
        for who, run in runs.items():
            last = int(np.searchsorted(run.time, horizon)) + 1
            # Where things happen fast, at the start, every sample is kept.
            places = np.unique(np.r_[: min(last, _POINTS), 0 : last : max(1, last // _POINTS)])
            shown.append(Curve(who, run.time[places], run.values[signal][places] / factor, kind))
        if kind == "line":
            target = np.full(2, run.values[f"{signal}.setpoint"][0] / factor)
            shown.append(Curve("", np.array([0.0, horizon]), target, "dashed"))
        panels.append(Panel(name, label, shown))
    return Figure(number, title, panels, note)
