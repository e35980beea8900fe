"""What single precision does to the scores of a loop."""

import numpy as np
import pytest
from plants import plant
from scipy.signal import cont2discrete, tf2ss

import clepsydra as cl
from clepsydra.deploy.proof.single_loop import is_change, score_change
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.studies.designs import DESIGNS


def test_single_precision_moves_a_loop_by_its_rounding_and_no_score_that_counts():
    analysis = plant("quadruple-tank").analysis
    controller = DESIGNS["PI, SIMC"](analysis)
    scenario = default_scenario(analysis.model)
    loop = Loop(controller, analysis.model)
    double, single = (loop.run(scenario, precision=p) for p in ("double", "single"))
    moved = np.abs(single.values["level_1"] - double.values["level_1"]).max()
    assert 0.0 < moved < 1e-4  # of 10 V, in the noise of the sensor
    change = score_change(controller, analysis.model, scenario)
    assert change["score"] and change["change"] > 0.0 and not change["is_change"]
    assert change["ranking"] == pytest.approx(1.0, abs=1e-4)


def test_the_coefficients_of_a_slow_regulator_change_the_scores():
    """PI with three lags of ten samples: rounded, the polynomial has its integral elsewhere."""
    rig = plant("three-tanks")
    lags = np.polymul([10.0, 1.0], np.polymul([10.0, 1.0], [10.0, 1.0]))
    continuous = [6.0 * 200.0, 6.0], np.polymul([200.0, 0.0], lags)
    above, below, _ = cont2discrete(continuous, 1.0, method="bilinear")
    regulator = cl.design.regulator(rig, tf2ss(above.ravel(), below), sampling_period=1.0)
    change = score_change(regulator, rig.linear)
    assert change["is_change"] and change["ranking"] > 1.05


@pytest.mark.parametrize(
    ("ranking", "expected"),
    [(1.0, False), (1.004, False), (0.996, False), (1.006, True), (0.99, True), (np.nan, True)],
)
def test_a_change_is_one_of_the_third_digit(ranking, expected):
    assert is_change(ranking) is expected
