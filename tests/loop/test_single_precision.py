"""A controller in single precision: an integral that stands still, and what has no such run."""

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import Kernel
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.program.precision import in_single_arithmetic

SCANS = 4000
#: K T / Ti is 2⁻¹⁹ a scan; the output lies between 32 and 64, where singles are 2⁻¹⁸ apart.
GAIN, INTEGRAL_TIME, PERIOD, OUTPUT = 1.0, 2.0**12, 2.0**-7, 50.0
NUMBERS = {
    "proportional_gain": GAIN, "integral_time": INTEGRAL_TIME, "setpoint_weight": 0.0,
    "tracking_time": INTEGRAL_TIME, "low_limit": -1e6, "high_limit": 1e6,
}  # fmt: skip
START = {"integral": OUTPUT, "last_output": OUTPUT} | {f"last_{k}": v for k, v in NUMBERS.items()}


@pytest.fixture(scope="module")
def plant() -> cl.Plant:
    return cl.load("quadruple-tank")


@pytest.mark.parametrize(("error", "units"), [(0.9, 0), (1.1, 1), (2.9, 1), (3.1, 2)])
def test_an_integral_gains_whole_units_in_the_last_place_or_none(plant, error, units):
    program = cl.design.simc(plant).program()
    unit = float(np.spacing(np.float32(OUTPUT)))
    increment = GAIN * PERIOD / INTEGRAL_TIME * error
    assert unit == 2.0**-18
    assert np.float32(OUTPUT) + np.float32(increment) == OUTPUT + units * unit
    gained = []
    for each in (program, in_single_arithmetic(program)):
        run = Kernel(each).run(
            SCANS,
            inputs={"level_1.sp": float(np.float32(error)), "time_step": PERIOD},
            parameters={p.name: NUMBERS[p.part] for p in program.parameters},
            state={s.name: START[s.part] for s in program.state},
        )
        gained.append(float(run.state("level_1.integral")[0]) - OUTPUT)
    assert gained == [pytest.approx(SCANS * increment, rel=1e-6), SCANS * units * unit]


def test_the_law_alone_is_computed_in_single_precision(plant):
    loop, scenario = Loop(cl.design.simc(plant), plant.linear), default_scenario(plant.linear)
    double, single = (loop.run(scenario, precision=p).values for p in ("double", "single"))
    apart = {name: np.max(np.abs(single[name] - double[name])) for name in double}
    assert 0.0 < apart["pump_1"] < 1e-5 and 0.0 < apart["tank_1.level"] < 1e-7
    levels = single["tank_1.level"]
    assert not np.array_equal(levels, levels.astype(np.float32))
    outputs = single["pump_1"]
    assert np.array_equal(outputs, outputs.astype(np.float32))
