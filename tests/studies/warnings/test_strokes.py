"""An input that a step sends from end to end again and again is worn out, however small the error.

What a stroke is, is judged on trends drawn by hand; that the study minds it, on the wet well, whose
pump feedback linearisation switches between standstill and full speed.
"""

from itertools import pairwise

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.studies.warnings.strokes import strokes


@pytest.mark.parametrize(
    ("drawn", "count"),
    [
        ([50, 50, 50], 0),
        ([50, 100, 0, 50], 1),
        ([0, 100, 0, 100, 20, 0], 4),
        ([100, 60, 0, 0, 40, 0, 100], 2),  # back to the same end is no stroke
        ([1, 99, 1, 99], 0),  # nor what never stands at a limit
    ],
)
def test_a_stroke_goes_from_one_limit_to_the_other(drawn, count):
    assert strokes(np.array(drawn, dtype=float), 0.0, 100.0) == count
    assert strokes(100.0 - np.array(drawn, dtype=float), 0.0, 100.0) == count
    assert strokes(np.array(drawn, dtype=float), 0.0, np.inf) == 0


@pytest.fixture(scope="module")
def wet_well():
    plant = cl.load("wet-well")
    made = [cl.design.feedback_linearisation(plant), cl.design.simc(plant)]
    return cl.study(plant, [*made, cl.design.phase_margin(plant)])


def test_who_slams_the_pump_is_nervous_and_never_first(wet_well):
    slamming = wet_well["Feedback linearisation"]
    # Seen without the code: samples at the ends of the range, in the segment of the first step.
    step = wet_well.scenario.segments[0]
    within = (slamming.run.time >= step.start) & (slamming.run.time < step.stop)
    duty = slamming.run.values["duty"][within]
    ends = duty[(duty <= duty.min()) | (duty >= duty.max())]
    assert np.ptp(duty) == 1.0  # all of its range
    assert sum(one != other for one, other in pairwise(ends)) >= 10
    assert slamming.standing.name == "NERVOUS"
    assert slamming.rank == 3
    assert "but a step drives duty to and fro" in slamming.reason
    assert any("times after the setpoint step of level" in each for each in slamming.warnings)


def test_and_no_yardstick_for_the_error_of_the_others(wet_well):
    slamming, best = wet_well["Feedback linearisation"], wet_well.best
    error = "iae_setpoint[level]"
    assert slamming.scores[error] < 0.5 * best.scores[error]
    assert best.relative_error == 1.0
    assert all(
        value
        == pytest.approx(
            wet_well[name].scores[f"{key}[level]"]
            / min(each.scores[f"{key}[level]"] for each in wet_well.ranking[:2])
        )
        for name in ("PI, SIMC", "PI, phase margin")
        for key, value in zip(
            ("iae_setpoint", "iae_load"), wet_well[name].criteria.values(), strict=True
        )
    )


def test_a_pump_that_opens_and_closes_once_is_left_alone(wet_well):
    for name in ("PI, SIMC", "PI, phase margin"):
        assert wet_well[name].standing.name == "ROBUST"
        assert not any("from one end" in each for each in wet_well[name].warnings)
