"""The designs on the nonlinear tanks with a pump of 100 cm³/s: Figs. 5 and 10.

The document speaks of no pump, so that no row judges it.
"""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np

from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.states.state_controllers import state_feedback_controller
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.loop.loop import Loop
from clepsydra.loop.profile import Change
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario, scenario_of_changes
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Curve, CurveKind, Figure, Panel
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop
from clepsydra.papers.three_tanks.linear_quadratic import quadratic_loop
from clepsydra.papers.three_tanks.pid_design import DERIVATIVE_GAIN, GAIN, INTEGRAL_GAIN
from clepsydra.papers.three_tanks.printed_model import FLOW, three_tanks
from clepsydra.papers.three_tanks.state_feedback import STEP, placed_loop

_LEVELS = ("level_1", "level_2", "level_3")
_LOAD = 1e-5  # into tank 3 [m³/s], ours: the document's is not printed
LOAD_AT, _END = 1500.0, 3000.0  # [s]
#: Fast enough for poles at -40 1/s, and the common period of a plant.
FAST, USUAL = 0.01, 1.0  # [s]


def run() -> Found:
    """Return the pictures."""
    pid = "Ziegler-Nichols PID"
    yield Figure(
        "Fig. 5", "Setpoint step of 1 cm, then a load of 10 cm³/s, with PID on the tanks",
        _panels((pid,)),
    )  # fmt: skip
    yield Figure(
        "Fig. 10", "The same with all designs",
        _panels((pid, "FSFB, -25 ± j25", "LQC, R = 0.1", "LQI, Bryson")),
        "The published feedbacks switch the pump between its limits.",
    )  # fmt: skip


@cache
def model_at(period: float) -> LinearModel:
    """Return the linear model to level 3, sampled with a period [s]."""
    process = dataclasses.replace(three_tanks(), sampling_period=period)
    return linearise(find_equilibrium(process)).select(outputs=["level_3"])


def feedback_controller(loop: FeedbackLoop, period: float) -> Controller:
    """Return a state feedback with its precompensator, for a sampling period [s]."""
    setpoint = np.array([[loop.setpoint_gain]])
    return state_feedback_controller(
        loop.label, model_at(period), _LEVELS, loop.gain, setpoint, fading_time=100.0
    )


def pid_controller() -> Controller:
    """Return PID control with the printed gains, derivative on the measurement, Td/10 filter."""
    law = multiloop_pid_law(
        ["level_3"], ["feed"], PidForm("PID", anti_windup="conditional_integration")
    )
    values = {
        "level_3.proportional_gain": GAIN,
        "level_3.integral_time": GAIN / INTEGRAL_GAIN,
        "level_3.derivative_time": DERIVATIVE_GAIN / GAIN,
        "level_3.derivative_filter": 10.0,
        "level_3.setpoint_weight": 1.0,
        "feed.low_limit": 0.0,
        "feed.high_limit": 1e-4,
    }
    at = {"level_3": float(find_equilibrium(three_tanks()).state[2]), "feed": FLOW}
    state = state_at_rest(law, values, at)
    return Controller(
        "Ziegler-Nichols PID", "multiloop PID", "The document's gains.", law, values, state,
        ("level_3",), ("level_3",), ("feed",),
    )  # fmt: skip


def quick_lqi() -> Controller:
    """Return an LQI whose weights have 1 cm as the largest error, and not a tenth of the range."""
    return design_lqi(model_at(USUAL), maximum_errors={"level_3": STEP})


def step_and_load(model: LinearModel, step: float = STEP) -> Scenario:
    """Return a setpoint step [m] and the load, from rest."""
    point = operating_point_of(model)
    changes = (
        Change("level_3", float(point.state[2]) + step, 0.0, 0.0),
        Change("inflow_3", _LOAD, LOAD_AT, LOAD_AT),
    )
    return scenario_of_changes(point, changes, round(_END / point.process.sampling_period) + 1)


@cache
def runs() -> dict[str, Run]:
    """Return a setpoint step of 1 cm and a load of 10 cm³/s under each controller, by name."""
    designs = {
        "Ziegler-Nichols PID": (pid_controller(), USUAL),
        "FSFB, -25 ± j25": (feedback_controller(placed_loop(25), FAST), FAST),
        "FSFB, -5 ± j5": (feedback_controller(placed_loop(5), FAST), FAST),
        "LQC, R = 0.1": (feedback_controller(quadratic_loop("0.1"), FAST), FAST),
        "LQI, Bryson": (design_lqi(model_at(USUAL)), USUAL),
        "LQI, 1 cm": (quick_lqi(), USUAL),
    }
    return {
        name: Loop(controller, model_at(period)).run(step_and_load(model_at(period)))
        for name, (controller, period) in designs.items()
    }


def _panels(names: tuple[str, ...]) -> tuple[Panel, ...]:
    found = {name: runs()[name] for name in names}
    thin = {name: max(1, len(run.time) // 3000) for name, run in found.items()}

    def drawn(signal: str, factor: float, kind: CurveKind = "line") -> list[Curve]:
        return [
            Curve(name, run.time[:: thin[name]], factor * run.values[signal][:: thin[name]], kind)
            for name, run in found.items()
        ]

    run = next(iter(found.values()))
    target = Curve("", run.time, 100.0 * run.scenario.setpoints[:, 0], "dashed")
    return (
        Panel("level 3", "level [cm]", (*drawn("tank_3.level", 100.0), target)),
        Panel("level 1", "level [cm]", drawn("tank_1.level", 100.0)),
        Panel("feed", "feed [cm³/s]", drawn("feed", 1e6, "held")),
    )
