"""A fan of plants: its edges are quantiles of runs that were made one by one."""

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.studies.robustness.fan import CHANCES, fan_of


@pytest.fixture(scope="module")
def found():
    plant = cl.load("quadruple-tank")
    return cl.robustness(cl.design.simc(plant), plant, draws=9, sensitivity=False)


def curves(run, name, every):
    own = run.true_measurement(name) if name in run.process.controlled else run.values[name]
    return own[::every]


@pytest.mark.parametrize("name", ["level_1", "pump_2"])
def test_edges_are_quantiles_of_the_runs(found, name):
    fan = fan_of(found.loops, 9)
    rows = np.sort([curves(found.run(draw), name, fan.every) for draw in range(1, 10)], axis=0)
    # Of nine values in order the median is the fifth, and a quarter lies at the third.
    for chance, place in ((0.25, 2), (0.5, 4), (0.75, 6)):
        np.testing.assert_allclose(
            fan.shares[name][CHANCES.index(chance)], rows[place], rtol=1e-9, atol=1e-12
        )
    np.testing.assert_allclose(
        fan.on_paper[name], curves(found.run(0), name, fan.every), rtol=1e-9, atol=1e-12
    )
    assert fan.draws == 9


def test_plants_without_a_steady_state_are_no_part_of_it():
    plant = cl.load("quadruple-tank")
    some = {"default": "0 %", "outlet_1.area": {"from": "0.06 cm^2", "to": "0.4 cm^2"}}
    found = cl.robustness(
        cl.design.simc(plant), plant, draws=30, uncertainty=some, sensitivity=False
    )
    fan = fan_of(found.loops, 30)
    assert 0 < fan.draws == found.simulated < 30
    assert all(np.isfinite(each).all() for each in fan.shares.values())


def test_long_scenarios_are_thinned(found, monkeypatch):
    monkeypatch.setattr("clepsydra.studies.robustness.fan._VALUES", 10_000)
    thin, whole = fan_of(found.loops, 9), found.run(0)
    assert thin.every == -(-whole.samples * 10 // 10_000)
    np.testing.assert_allclose(thin.time, whole.time[:: thin.every])
