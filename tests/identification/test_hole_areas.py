"""Areas of holes: at rest against Torricelli by hand, and from records with noisy pumps."""

import math

import numpy as np
import pytest
from refusals import refused
from scipy.stats import binom

from clepsydra import InputError, Kernel
from clepsydra.identification.hole_areas import hole_areas, hole_areas_at_rest
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.loop.open_loop import _OpenLoop, simulate
from clepsydra.loop.process_period import process_period
from clepsydra.process.reader import load_process

pytestmark = pytest.mark.thorough

PROCESS = load_process("laboratory-four-tanks:report,volts")
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
    found = hole_areas_at_rest(PROCESS, [record(levels, volts)])
    for i, area in enumerate(expected, 1):
        assert 1e4 * found[f"outlet_{i}"] == pytest.approx(area, rel=1e-10)


def test_several_records_agree_on_the_holes():
    points = [
        find_equilibrium(PROCESS, inputs={"pump_1": one, "pump_2": two}).as_dict()
        for one, two in ((5.0, 5.0), (6.0, 3.0), (3.0, 6.5))
    ]
    found = hole_areas_at_rest(PROCESS, points)
    assert {name: 1e4 * area for name, area in found.items()} == pytest.approx(HOLES, rel=1e-6)


def test_a_transient_without_noise():
    run = simulate(
        find_equilibrium(PROCESS),
        {"pump_1": np.repeat([5.0, 7.0], 1000), "pump_2": np.repeat([6.0, 3.0], 1000)},
        substeps=1,
    )
    found = hole_areas(PROCESS, run.time, run.values)
    for name, area in HOLES.items():
        assert 1e4 * found[name].value == pytest.approx(area, rel=1e-5)


@pytest.fixture(scope="module")
def noisy_records():
    """400 seeds of two minutes with noisy pumps, in one batch."""
    point = find_equilibrium(PROCESS)
    samples, seeds = 1200, 400
    still = {name: np.full(samples, value) for name, value in (("pump_1", 6.0), ("pump_2", 5.0))}
    loop = _OpenLoop(point, still, 1, {})
    drawn = 0.1 * np.random.default_rng(5).standard_normal((2, seeds, samples))
    noise = {f"pump_{i}.noise": drawn[i - 1] for i in (1, 2)}
    program = process_period(PROCESS, loop.motion, loop.recorded, shown="start")
    kernel = Kernel(program, individual=list(noise))
    rest = {s.name: float(v) for s, v in zip(PROCESS.motion.contents, loop.contents, strict=True)}
    result = kernel.run(samples, inputs={**still, **noise}, state=rest)
    levels = {name: result.output(name) for name in (f"tank_{i}.level" for i in (1, 2, 3, 4))}
    return np.arange(samples) * PROCESS.sampling_period, still, levels


def test_the_intervals_cover_the_truth_as_often_as_they_say(noisy_records):
    time, still, levels = noisy_records
    covered = dict.fromkeys(HOLES, 0)
    for seed in range(400):
        one = {name: values[seed] for name, values in levels.items()} | still
        for name, found in hole_areas(PROCESS, time, one).items():
            covered[name] += 1e4 * found.low <= HOLES[name] <= 1e4 * found.high
    low, high = binom.ppf([0.005, 0.995], 400, 0.95)
    for name, count in covered.items():
        assert low <= count <= high, (name, count)


def test_refusals():
    sound = record((19.0, 21.0, 13.0, 11.0), (6.0, 8.0))
    with refused(expected="at least one"):
        hole_areas_at_rest(PROCESS, [])
    with refused(place="record 1, tank_2.level"):
        hole_areas_at_rest(PROCESS, [sound | {"tank_2.level": math.nan}])
    with refused(place="record 2, pump_1"):
        hole_areas_at_rest(PROCESS, [sound, {k: v for k, v in sound.items() if k != "pump_1"}])
    with refused(value="no flow through outlet_3"):
        hole_areas_at_rest(PROCESS, [sound | {"tank_3.level": 0.0}])
    with refused(expected="orifices"):
        hole_areas_at_rest(load_process("averaging-tank"), [sound])
    time = np.arange(4.0)
    whole = {name: np.full(4, value) for name, value in sound.items()}
    for change, words in (
        ({"tank_1.level": np.full(3, 0.1)}, "3 values"),
        ({"pump_2": [1.0, 2.0, math.nan, 1.0]}, "1 of them no numbers"),
    ):
        with pytest.raises(InputError, match=words):
            hole_areas(PROCESS, time, whole | change)
    with refused(expected="rising"):
        hole_areas(PROCESS, [0.0, 2.0, 1.0, 3.0], whole)
