"""What a study says of a controller whose PLC would compute in REAL."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import bilinear_zpk, tf2ss, zpk2tf

import clepsydra as cl

#: A regulator K (1 + s Ti) / (s Ti (1 + s Tf)^n) for one of Quanser's tanks [s], n being 4.
QUANSER = GAIN, INTEGRAL_TIME, FILTER_TIME, ORDER, PERIOD = 0.1, 40.0, 4.0, 4, 0.5
SENTENCE = "In REAL (single precision)"


@pytest.fixture(scope="module")
def plant() -> cl.Plant:
    return cl.load(Path(__file__).parents[2] / "docs/examples/quanser-coupled-tanks.toml")


def polynomials(gain, integral_time, filter_time, order, period):
    lag = -1.0 / filter_time
    zeros, poles = [-1.0 / integral_time], [0.0] + [lag] * order
    return zpk2tf(*bilinear_zpk(zeros, poles, gain * (-lag) ** order, fs=1.0 / period))


def companion(plant, *numbers):
    """The regulator by the coefficients of its denominator, in which rounding moves every pole."""
    return cl.design.regulator(plant, tf2ss(*polynomials(*numbers)), sampling_period=numbers[-1])


def cascaded(plant):
    """The same one as an integral and four lags in a row, each with its own pole."""
    lag = 1.0 / FILTER_TIME
    A = np.diag([0.0] + [-lag] * 4) + np.diag([lag] * ORDER, -1)
    B = np.array([[GAIN / INTEGRAL_TIME], [GAIN * lag], [0], [0], [0]])
    return cl.design.regulator(plant, (A, B, [[0, 0, 0, 0, 1]], [[0]])).named("Lags")


def test_a_regulator_by_its_coefficients_is_watched_and_the_same_one_by_lags_is_not(plant):
    # Rounded to single precision, the denominator has no pole at one any more: it is no integral.
    _, denominator = polynomials(*QUANSER)
    poles, rounded = (
        np.abs(np.roots(each)) for each in (denominator, denominator.astype(np.float32))
    )
    assert max(poles) == pytest.approx(1.0, abs=1e-9) and max(rounded) < 0.9995
    found = cl.study(plant, [companion(plant, *QUANSER), cascaded(plant)])
    assert [each.controller.name for each in found.ranking] == ["Regulator", "Lags"]
    assert re.search(
        rf"{re.escape(SENTENCE)} level_2 .* by up to [1-9].* LREAL", found.best.warnings[-1]
    )
    assert SENTENCE not in " ".join(found["Lags"].warnings)
    # It is one more thing to watch, so the other one is recommended.
    assert found.recommended is found["Lags"]
    assert "with fewer warnings than Regulator" in found.verdict


def test_its_answer_says_so_in_a_line(plant):
    found = cl.study(plant, [companion(plant, *QUANSER)])
    assert SENTENCE in str(found) and found.recommended is found.best
    assert SENTENCE in found.as_dict()["ranking"][0]["warnings"][-1]


def test_an_error_that_is_larger_is_watched_where_no_level_is_off_by_a_hundredth():
    rig = cl.load("three-tanks")
    found = cl.study(rig, [companion(rig, 6.0, 200.0, 10.0, 3, 1.0)])
    said = found.best.warnings[-1]
    assert re.search(rf"{re.escape(SENTENCE)} its error would be 1\.\d+ times that; ", said)


def test_a_number_that_single_precision_has_not_is_told(plant):
    lags = cascaded(plant)
    tiny = replace(lags, values=lags.values | {"pump.error_gain.level_2": 1e-42})
    (said,) = [words for words in cl.study(plant, [tiny]).best.warnings if "REAL" in words]
    assert "1e-42" in said and "LREAL" in said


def test_controllers_of_the_catalogue_have_nothing_to_watch_in_single_precision():
    rig = cl.load("quadruple-tank")
    found = cl.study(rig, [cl.design.simc(rig), cl.design.lqi_kalman(rig)])
    assert not any(SENTENCE in words for each in found.ranking for words in each.warnings)
