"""The setpoint step of Figs. 5 and 10 with a real pump, sampled as its poles ask, and usually."""

from __future__ import annotations

import dataclasses
from functools import partial

from clepsydra.linear.analysis import analyse
from clepsydra.papers.contest import Contest, Contests
from clepsydra.papers.three_tanks.linear_quadratic import SIZES, quadratic_loop
from clepsydra.papers.three_tanks.printed_model import three_tanks
from clepsydra.papers.three_tanks.servo_and_load import (
    FAST,
    LOAD_AT,
    USUAL,
    feedback_controller,
    pid_controller,
)
from clepsydra.papers.three_tanks.state_feedback import DISTANCES, STEP, placed_loop

WORDS = (
    "A setpoint step of 1 cm on the nonlinear tanks with a pump. The document speaks of no pump "
    "and prints no size of a step: both are ours. PID control has the printed gains, its "
    "derivative on the level through a filter of Td/10; state feedback (FSFB) and linear-quadratic "
    "control (LQC) are recomputed from its model, with the precompensator and without an integral."
)


def contests() -> Contests:
    """Return the step at a period that poles at -40 1/s need, and at that of a plant."""
    return {"Every 10 ms": partial(_contest, FAST), "Every second": partial(_contest, USUAL)}


def _contest(period: float) -> Contest:
    feedbacks = {f"FSFB, -{each} ± j{each}": placed_loop(each) for each in DISTANCES}
    feedbacks |= {f"LQC, R = {weight}": quadratic_loop(weight) for weight in SIZES}
    published = {"PID, Ziegler-Nichols": pid_controller()}
    published |= {name: feedback_controller(loop, period) for name, loop in feedbacks.items()}
    analysis = analyse(dataclasses.replace(three_tanks(), sampling_period=period))
    targets = {"level_3": analysis.operating_point.as_dict()["level_3"] + STEP}
    return Contest(analysis, targets, LOAD_AT, published)
