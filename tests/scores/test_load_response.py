"""Peak deviation and return time against the response of a PI loop in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clepsydra.scores.evaluate import score_run
from clepsydra.scores.load_response import PEAK_DEVIATION, return_time
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.scores.segment import Segment


def peak_deviation(time, output, setpoint: float) -> float:
    return PEAK_DEVIATION.along(time, np.full(len(time), setpoint), output)


RATE = 0.05
TIME = np.arange(0.0, 600.0, 0.05)
#: An integrator under a critically damped PI controller, driven off by a unit load step.
RESPONSE = TIME * np.exp(-RATE * TIME)
SETPOINT = 12.0


def test_peak_of_a_critically_damped_return() -> None:
    # t e^(-a t) has its top at t = 1/a, and near it lies below the top by (a t - 1)²/(2 a e).
    exact = 1.0 / (math.e * RATE)
    for sign in (1.0, -1.0):
        seen = peak_deviation(TIME, SETPOINT + sign * RESPONSE, SETPOINT)
        assert exact - (RATE * 0.05) ** 2 / (2 * math.e * RATE) <= seen <= exact + 1e-12, sign


def test_return_time_solves_the_equation_of_the_band() -> None:
    from scipy.special import lambertw

    band = 0.5
    exact = float(-lambertw(-RATE * band, k=-1).real / RATE)
    for sign in (1.0, -1.0):
        seen = return_time(TIME, SETPOINT + sign * RESPONSE, SETPOINT, band)
        assert seen == pytest.approx(exact, abs=1e-4), sign


def test_an_output_that_never_leaves_the_band_needs_no_time() -> None:
    assert return_time(TIME, SETPOINT + RESPONSE, SETPOINT, band=8.0) == 0.0


def test_an_offset_never_returns() -> None:
    offset = SETPOINT - (1.0 - np.exp(-TIME / 50.0))
    assert return_time(TIME, offset, SETPOINT, band=0.5) == math.inf
    assert peak_deviation(TIME, offset, SETPOINT) == pytest.approx(1.0, abs=1e-5)


def test_only_what_follows_the_load_counts() -> None:
    time, output = np.arange(4.0), np.array([99.0, 5.0, 4.0, 5.0])
    segments = [Segment("setpoint", "y", 0.0, 1.0, -5.0), Segment("load", "d", 1.0, 3.0, 1.0)]
    scores = score_run(ScoredRun(time, {"y": np.full(4, 5.0)}, {"y": output}, {}, {}, segments))
    assert scores["peak_deviation[y]"] == 1.0
    assert scores["return_time[y]"] == 1.75


def test_a_run_that_broke_off_is_infinitely_bad() -> None:
    assert peak_deviation([0, 1], [5.0, math.nan], 5.0) == math.inf
    assert return_time([0, 1], [5.0, math.nan], 5.0, band=1.0) == math.inf


@settings(max_examples=25, deadline=None)
@given(st.floats(0.01, 100.0), st.floats(-1e3, 1e3), st.booleans())
def test_scores_scale_with_the_unit_and_ignore_sign_and_place(
    unit: float, setpoint: float, down: bool
) -> None:
    time = TIME[::20]
    response = RESPONSE[::20] * (-unit if down else unit)
    assert peak_deviation(time, setpoint + response, setpoint) == pytest.approx(
        unit * peak_deviation(time, RESPONSE[::20], 0.0), rel=1e-9, abs=1e-9
    )
    assert return_time(time, setpoint + response, setpoint, band=unit) == pytest.approx(
        return_time(time, RESPONSE[::20], 0.0, band=1.0), rel=1e-6
    )
