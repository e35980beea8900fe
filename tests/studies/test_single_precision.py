"""What a study says of a controller whose PLC would compute in REAL."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import bilinear_zpk, tf2ss, zpk2tf

import clepsydra as cl

#: A regulator K (1 + s Ti) / (s Ti (1 + s Tf)^4) for one of Quanser's tanks [s].
GAIN, INTEGRAL_TIME, FILTER_TIME, PERIOD = 0.1, 40.0, 4.0, 0.5
SENTENCE = "In REAL (single precision)"


@pytest.fixture(scope="module")
def plant() -> cl.Plant:
    return cl.load("docs/examples/quanser-coupled-tanks.toml")


def polynomials() -> tuple[np.ndarray, np.ndarray]:
    lag = -1.0 / FILTER_TIME
    poles = [0.0] + [lag] * 4
    return zpk2tf(*bilinear_zpk([-1 / INTEGRAL_TIME], poles, GAIN * lag**4, fs=1 / PERIOD))


def companion(plant):
    """The regulator by the coefficients of its denominator, in which rounding moves every pole."""
    return cl.design.regulator(plant, tf2ss(*polynomials()), sampling_period=PERIOD)


def cascaded(plant):
    """The same one as an integral and four lags in a row, each with its own pole."""
    lag = 1.0 / FILTER_TIME
    A = np.diag([0.0] + [-lag] * 4) + np.diag([lag] * 4, -1)
    B = np.array([[GAIN / INTEGRAL_TIME], [GAIN * lag], [0], [0], [0]])
    return cl.design.regulator(plant, (A, B, [[0, 0, 0, 0, 1]], [[0]])).named("Lags")


def test_a_regulator_by_its_coefficients_is_watched_and_the_same_one_by_lags_is_not(plant):
    # Rounded to single precision, the denominator has no pole at one any more: it is no integral.
    _, denominator = polynomials()
    poles, rounded = (
        np.abs(np.roots(each)) for each in (denominator, denominator.astype(np.float32))
    )
    assert max(poles) == pytest.approx(1.0, abs=1e-9) and max(rounded) < 0.9995
    found = cl.study(plant, [companion(plant), cascaded(plant)])
    assert [each.controller.name for each in found.ranking] == ["Regulator", "Lags"]
    assert re.search(
        rf"{re.escape(SENTENCE)} level_2 .* by up to [1-9].* LREAL", found.best.warnings[-1]
    )
    assert SENTENCE not in " ".join(found["Lags"].warnings)
    # It is one more thing to watch, so the other one is recommended.
    assert found.recommended is found["Lags"]
    assert "with less to watch than Regulator" in found.verdict


def test_its_answer_says_so_in_a_line(plant):
    found = cl.study(plant, [companion(plant)])
    assert SENTENCE in str(found) and found.recommended is found.best
    assert SENTENCE in found.as_dict()["ranking"][0]["warnings"][-1]


def test_a_number_that_single_precision_has_not_is_told(plant):
    lags = cascaded(plant)
    tiny = replace(lags, values=lags.values | {"pump.error_gain.level_2": 1e-42})
    (said,) = [words for words in cl.study(plant, [tiny]).best.warnings if "REAL" in words]
    assert "1e-42" in said and "LREAL" in said


def test_controllers_of_the_catalogue_have_nothing_to_watch_in_single_precision():
    rig = cl.load("quadruple-tank")
    found = cl.study(rig, [cl.design.simc(rig), cl.design.lqi_kalman(rig)])
    assert not any(SENTENCE in words for each in found.ranking for words in each.warnings)
