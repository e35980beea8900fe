"""Areas of holes: at rest against Torricelli by hand, and from records with noisy pumps."""

import math

import numpy as np
import pytest
from refusals import refused
from scipy.stats import binom

import clepsydra as cl
from clepsydra import InputError
from clepsydra.identification.orifice_areas import orifice_areas, orifice_areas_at_rest

PLANT = cl.load("laboratory-four-tanks:report,volts")
PROCESS = PLANT.process
HOLES = {"outlet_1": 0.1563, "outlet_2": 0.1283, "outlet_3": 0.0637, "outlet_4": 0.0566}  # cm²


def record(levels, volts):
    return {f"tank_{i}.level": 0.01 * h for i, h in enumerate(levels, 1)} | {
        f"pump_{i}": u for i, u in enumerate(volts, 1)
    }


def test_levels_at_rest_by_hand():
    """Torricelli tank by tank, from the flows of the pumps."""
    levels, volts = (19.0, 21.0, 13.0, 11.0), (6.0, 8.0)
    root = [math.sqrt(2 * 981.0 * h) for h in levels]
    flows = 4.32 * volts[0], 3.74 * volts[1]
    upper = 0.375 * flows[1], 0.375 * flows[0]
    lower = 0.625 * flows[0] + upper[0], 0.625 * flows[1] + upper[1]
    expected = [q / v for q, v in zip((*lower, *upper), root, strict=True)]
    found = orifice_areas_at_rest(PROCESS, [record(levels, volts)])
    for i, area in enumerate(expected, 1):
        assert 1e4 * found[f"outlet_{i}"] == pytest.approx(area, rel=1e-10), i


def test_several_records_agree_on_the_holes():
    points = [
        PLANT.at(inputs={"pump_1": one, "pump_2": two}).point.as_dict()
        for one, two in ((5.0, 5.0), (6.0, 3.0), (3.0, 6.5))
    ]
    found = orifice_areas_at_rest(PROCESS, points)
    assert {name: 1e4 * area for name, area in found.items()} == pytest.approx(HOLES, rel=1e-6)


@pytest.mark.thorough
def test_a_transient_without_noise():
    steps = {"0 s": (5.0, 6.0), "50 s": (7.0, 3.0)}
    events = [
        cl.step(pump, to=volts, at=time)
        for time, both in steps.items()
        for pump, volts in zip(("pump_1", "pump_2"), both, strict=True)
    ]
    run = cl.simulate(PLANT, None, events, duration="100 s")
    found = orifice_areas(PROCESS, run.time, run.values)
    for name, area in HOLES.items():
        assert 1e4 * found[name].value == pytest.approx(area, rel=1e-5), name


SEEDS, SAMPLES, PERIOD = 200, 1200, 0.05


@pytest.fixture(scope="module")
def noisy_records():
    """Minutes with noisy pumps, all seeds side by side: Runge and Kutta on Torricelli's law."""
    area, holes = 15.5179, np.array(list(HOLES.values()))[:, None]
    mean = np.array([4.32 * 6.0, 3.74 * 5.0])[:, None]  # [cm³/s]
    random = np.random.default_rng(5)

    def rates(levels, flows):
        one, two = flows
        out = holes * np.sqrt(2 * 981.0 * levels)
        into = np.stack([0.625 * one + out[2], 0.625 * two + out[3], 0.375 * two, 0.375 * one])
        return (into - out) / area

    at_rest = PLANT.at(inputs={"pump_1": 6.0, "pump_2": 5.0}).point.as_dict()
    levels = np.repeat([[100 * at_rest[f"tank_{i}.level"]] for i in (1, 2, 3, 4)], SEEDS, axis=1)
    found = np.empty((SAMPLES, *levels.shape))
    for k in range(SAMPLES):
        found[k] = levels
        flows = mean * (1.0 + 0.1 * random.standard_normal((2, SEEDS)))
        k1 = rates(levels, flows)
        k2 = rates(levels + PERIOD / 2 * k1, flows)
        k3 = rates(levels + PERIOD / 2 * k2, flows)
        k4 = rates(levels + PERIOD * k3, flows)
        levels = levels + PERIOD / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return found / 100.0


@pytest.mark.thorough
def test_the_intervals_cover_the_truth_as_often_as_they_say(noisy_records):
    time = PERIOD * np.arange(SAMPLES)
    still = {"pump_1": np.full(SAMPLES, 6.0), "pump_2": np.full(SAMPLES, 5.0)}
    covered = dict.fromkeys(HOLES, 0)
    for seed in range(SEEDS):
        one = {f"tank_{i + 1}.level": noisy_records[:, i, seed] for i in range(4)} | still
        for name, found in orifice_areas(PROCESS, time, one).items():
            covered[name] += 1e4 * found.low <= HOLES[name] <= 1e4 * found.high
    low, high = binom.ppf([0.005, 0.995], SEEDS, 0.95)
    for name, count in covered.items():
        assert low <= count <= high, (name, count)


def test_refusals():
    sound = record((19.0, 21.0, 13.0, 11.0), (6.0, 8.0))
    with refused(expected="at least one"):
        orifice_areas_at_rest(PROCESS, [])
    with refused(place="record 1, tank_2.level"):
        orifice_areas_at_rest(PROCESS, [sound | {"tank_2.level": math.nan}])
    with refused(place="record 2, pump_1"):
        orifice_areas_at_rest(PROCESS, [sound, {k: v for k, v in sound.items() if k != "pump_1"}])
    with refused(value="no flow through outlet_3"):
        orifice_areas_at_rest(PROCESS, [sound | {"tank_3.level": 0.0}])
    with refused(expected="orifices"):
        orifice_areas_at_rest(cl.load("averaging-tank").process, [sound])
    time = np.arange(4.0)
    whole = {name: np.full(4, value) for name, value in sound.items()}
    for change, words in (
        ({"tank_1.level": np.full(3, 0.1)}, "3 values"),
        ({"pump_2": [1.0, 2.0, math.nan, 1.0]}, "1 of them no numbers"),
    ):
        with pytest.raises(InputError, match=words):
            orifice_areas(PROCESS, time, whole | change)
    with refused(expected="rising"):
        orifice_areas(PROCESS, [0.0, 2.0, 1.0, 3.0], whole)
