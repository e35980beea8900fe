"""Undershoot: against the closed form of a zero in the right half-plane, stored and added up."""

import math

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.scores.marks import along
from clepsydra.scores.step_response import UNDERSHOOT


@pytest.mark.parametrize(("start", "target"), [(0.0, 1.0), (6.0, 8.0), (8.0, 6.0)])
def test_it_is_that_of_a_lag_with_a_zero_in_the_right_half_plane(start, target):
    """Of (1 − b s)/(s + 1)² the step response is 1 − (1 + (1 + b) t) e^(−t), least at b/(1 + b)."""
    b, period = 2.0, 1e-3
    time = np.arange(0.0, 20.0, period)
    response = 1.0 - (1.0 + (1.0 + b) * time) * np.exp(-time)
    least = 1.0 - (1.0 + b) * math.exp(-b / (1.0 + b))
    held, inverse = (np.full(time.size, v) for v in (target, 1.0 / (target - start)))
    output = start + (target - start) * response
    found = UNDERSHOOT.folded(along(time, {"per_step": inverse}, now=output, next_setpoint=held))
    # Near its least the response is a parabola: half a period off costs y″ period²/8, y″ ≤ 1 + b.
    assert found == pytest.approx(-100.0 * least, abs=100.0 * (1.0 + b) * period**2 / 8)


def test_a_response_that_goes_the_right_way_has_none():
    time = np.arange(0.0, 10.0, 0.1)
    marks = {"per_step": np.ones(time.size)}
    up = along(time, marks, now=1.0 - np.exp(-time), next_setpoint=np.ones(time.size))
    assert UNDERSHOOT.folded(up) == 0.0


def test_a_livelier_controller_makes_it_deeper():
    """The quadruple tank has a zero in the right half-plane there."""
    plant = cl.load("quadruple-tank-nonminimum-phase")
    usual, lively = (
        cl.simulate(plant, cl.design.lqi(plant, maximum_errors=errors)).scores
        for errors in (None, {"level_1": 0.1, "level_2": 0.1})
    )
    assert lively["undershoot[level_2]"] > 2.0 * usual["undershoot[level_2]"] > 0.0


def test_a_tuning_may_be_for_it():
    plant = cl.load("quadruple-tank-nonminimum-phase")
    start = cl.design.simc(plant)
    tuned = cl.tune(start, plant, {"iae[level_1]": 1.0, "undershoot[level_1]": 1.0})
    own = cl.simulate(plant, start).scores["undershoot[level_1]"]
    # z is a difference beside 1, in per cent: 1e-9 of both.
    assert tuned.tuning.start_scores["undershoot[level_1]"] == pytest.approx(own, abs=1e-7)
