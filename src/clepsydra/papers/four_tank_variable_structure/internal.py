"""The non-minimum-phase trap: E is regular, the outputs are held, and a tank runs over.

The document speaks of its tanks in general and not of these valves, so that no row judges it.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.feedback_linearisation import design_feedback_linearisation
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.rig import VOLTS_PER_METRE, plant

#: The setpoint of h1 steps by half a centimetre.
STEP = 0.005
BEFORE, DURATION = 30.0, 900.0


def run() -> Found:
    """Run P+ under (9) regardless of its internal dynamics, for the picture alone."""
    return (_figure(_regardless(STEP), _swapped()),)


@cache
def _analysis(variant: str) -> Analysis:
    return analyse(plant(variant))


def _scenario(step: float) -> Scenario:
    point = _analysis("nonminimum-phase").operating_point
    process = point.process
    period = process.sampling_period
    samples = round(DURATION / period)
    rest = [point.as_dict()[name] for name in process.controlled]
    setpoints = np.tile(rest, (samples, 1))
    setpoints[round(BEFORE / period) :, 0] += VOLTS_PER_METRE * step
    none = np.zeros((samples, len(process.disturbances)))
    return Scenario(period, setpoints, none, np.zeros((samples, len(process.measurements))), (), 1)


def _run(controller: Controller, step: float) -> Run:
    return Loop(controller, _analysis("nonminimum-phase").model).run(_scenario(step))


def _regardless(step: float) -> Run:
    model = _analysis("nonminimum-phase").model
    controller = design_feedback_linearisation(model, despite_unstable_internal_dynamics=True)
    return _run(controller, step)


def _swapped() -> Run:
    analysis = _analysis("nonminimum-phase")
    return _run(design_simc(analysis.model, analysis.pairing), STEP)


def _figure(run: Run, swapped: Run) -> Figure:
    every = slice(None, None, 10)

    def level(found: Run, tank: int) -> np.ndarray:
        return 100.0 * found.values[f"tank_{tank}.level"][every]

    time = run.time[every]
    panels = []
    for name, found in (("decoupled by (9)", run), ("PI, other pairing", swapped)):
        curves = [Curve(f"h{j}", time, level(found, j)) for j in range(1, 5)]
        panels.append(Panel(f"{name}: levels", "[cm]", tuple(curves)))
        voltages = [Curve(f"v{i}", time, found.values[f"pump_{i}"][every], "held") for i in (1, 2)]
        panels.append(Panel(f"{name}: pumps", "[V]", tuple(voltages)))
    return Figure(
        "",
        "P+ after a step of h1 by half a centimetre",
        tuple(panels),
        "The decoupled loop holds h1 and h2 exactly while h3 and h4 run away, until a pump "
        "stands at its limit and a tank runs over. PI controllers of the other pairing (SIMC, "
        "slowed down to a sensitivity peak of 2) make the same step, slowly.",
    )
