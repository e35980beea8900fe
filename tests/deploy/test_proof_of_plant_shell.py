"""The plant shell in engine, C and Structured Text: equal in every bit, and safe in time."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from deployed import CompiledC, InterpretedText, run_alike
from plants import designed, plant

import clepsydra as cl
from clepsydra import Kernel
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.studies.designs import DESIGNS

SCANS = 10_000
HELD = 20
#: The status word of the shell has eighteen bits.
STATUS_BITS = [2**place for place in range(18)]
DEAD_TIME = Path(__file__).parents[1] / "dead-time.toml"


def held(random, values, chance):
    return np.repeat(random.choice(values, size=SCANS // HELD, p=chance), HELD)


def scans(program, period, seed):
    """A plant with noise, steps, hands, broken channels, short and long faults, and restarts."""
    random = np.random.default_rng(seed)
    found = {}
    for signal in program.inputs:
        name, low, span = signal.name, signal.low, signal.span
        if signal.part == "mode":
            column = held(random, [0.0, 1.0, 2.0, 3.0], [0.1, 0.77, 0.1, 0.03])
        elif signal.part == "good":
            column = held(random, [0.0, 1.0], [0.1, 0.9])
            single = random.random(SCANS) < 0.01
            column[single] = 1.0 - column[single]
        elif signal.part == "pv":
            # From 3 to 21.6 mA now and then, else within the range.
            wide = low + span * np.repeat(random.uniform(-0.06, 1.11, SCANS // HELD), HELD)
            noise = span * random.normal(scale=0.01, size=SCANS)
            inside = low + span * np.repeat(random.uniform(0.1, 0.9, SCANS // HELD), HELD)
            column = np.where(held(random, [0.0, 1.0], [0.8, 0.2]) > 0, wide, inside + noise)
            broken = random.random(SCANS) < 0.005
            column[broken] = random.choice([math.nan, math.inf, -math.inf, 1e301], broken.sum())
        elif name == "start":
            column = np.where(random.random(SCANS) < 0.01, random.integers(0, 3, SCANS), 0.0)
            stuck = held(random, [0.0, 1.0, 2.0, 3.0], [0.91, 0.03, 0.03, 0.03])
            column = np.where(stuck > 0.0, stuck, column)
            column[0] = 1.0  # nothing was kept
        elif name == "acknowledge":
            column = (random.random(SCANS) < 0.05).astype(float)
            column = np.maximum(column, held(random, [0.0, 1.0], [0.9, 0.1]))
        elif name == "time_step":
            column = period * random.choice([1.0, 1.0, 1.0, 1.05, 1.3, 0.5], size=SCANS)
            broken = random.random(SCANS) < 0.01
            column[broken] = random.choice([0.0, -1.0, math.nan, math.inf], broken.sum())
            column[random.random(SCANS) < 0.003] = 600.0 * period
        else:
            column = low + span * np.repeat(random.uniform(-0.1, 1.1, SCANS // HELD), HELD)
            column[random.random(SCANS) < 0.005] = math.nan
        found[name] = column
    # Not a number stands for the printed value of a parameter.
    for parameter in program.parameters[:3]:
        typed = random.random(SCANS) < 0.001
        found[parameter.name] = np.where(typed, math.inf, math.nan)
    return found


CASES = [
    ("PI, SIMC", "quadruple-tank"),
    ("Smith predictor, LQ", DEAD_TIME),
    ("LQI with Kalman filter", "quadruple-tank"),
]


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "process"), CASES)
def test_engine_c_and_structured_text_are_equal_in_every_bit(name, process, tmp_path):
    analysis = plant(process).analysis
    controller = DESIGNS[name](analysis)
    period = analysis.operating_point.process.sampling_period
    spans = {
        n: analysis.operating_point.process.signal(n).span
        for n in (*controller.setpoints, *controller.manipulated)
    }
    settings = PlantShell(
        sensor_delay=dict.fromkeys(controller.measurements, 3.7 * period),
        setpoint_rate={n: spans[n] / (13.0 * period) for n in controller.setpoints},
        rate_limit={n: spans[n] / (7.0 * period) for n in controller.manipulated},
        fail_safe={n: spans[n] / 3.0 for n in controller.manipulated},
    )
    program = with_plant_shell(controller, period, settings).program()
    inputs = scans(program, period, seed=len(name))
    engine = run_alike(program, tmp_path, inputs)
    for column, signal in enumerate(program.outputs):
        if signal.part == "status":
            word = engine[:, column].astype(int)
            assert signal.high == sum(STATUS_BITS)
            for bit in STATUS_BITS:
                assert np.any(word & bit) and not np.all(word & bit), bit
        elif signal.kind == "boolean":
            assert set(engine[:, column]) == {0.0, 1.0}, signal.name
        else:
            assert len(np.unique(engine[:, column])) > 100, signal.name


def in_operation(program, samples):
    """Inputs in automatic with good sensors."""
    on = ("mode", "good", "time_step")
    return {s.name: np.full(samples, 1.0 if s.part in on else s.initial) for s in program.inputs}


@pytest.fixture(scope="module")
def quick():
    """PI control of the quadruple tank every 0.1 s, and its program in the plant shell."""
    process = dataclasses.replace(plant("quadruple-tank").process, sampling_period=0.1)
    controller = cl.design.simc(cl.Plant(process))
    settings = PlantShell(fail_safe={"pump_1": 1.25})
    return controller, with_plant_shell(controller, 0.1, settings).program()


@pytest.mark.parametrize(("faulty", "fails"), [(39, False), (41, True)])
def test_a_fault_of_3_9_s_rides_through_and_one_of_4_1_s_fails_safe(faulty, fails, quick, tmp_path):
    """Scans of 0.1 s, in the engine, in C and in Structured Text."""
    controller, program = quick
    before, after = 20, 30
    samples = before + faulty + after
    at = controller.plant.point.as_dict()
    inputs = in_operation(program, samples)
    for name in controller.measurements:
        inputs[f"{name}.pv"][:] = at[name]
    for name in controller.setpoints:
        inputs[f"{name}.sp"][:] = at[name] + 0.4
    inputs["time_step"][:] = 0.1
    inputs["level_1.good"][before : before + faulty] = 0.0
    places = [[s.name for s in program.outputs].index(n) for n in ("pump_1.out", "pump_1.status")]
    run = Kernel(program).run(samples, inputs=inputs)
    columns = [[run.output(n)[0] for n in ("pump_1.out", "pump_1.status")]]
    for instance in (CompiledC(program, tmp_path), InterpretedText(program)):
        rows = [instance({n: float(c[k]) for n, c in inputs.items()}) for k in range(samples)]
        columns.append([np.array([row[place] for row in rows]) for place in places])
    for moved, status in columns:
        word = status.astype(int)
        held_at = moved[before - 1]
        assert held_at > at["pump_1"]
        last = before + min(faulty, 40)
        assert np.all(moved[before:last] == held_at)
        assert np.all((word[before:last] & 512) == 512)
        assert np.any(word & 1024) == fails
        if fails:
            assert np.all(moved[before + 40 :] == 1.25)
            assert np.all(word[before + 40 :] & 1024)
        else:
            assert np.all(np.diff(moved[before + faulty :]) > 0.0)
            # The integral goes on where it was: one step further, as from scan to scan before.
            step = moved[2] - moved[1]
            assert moved[before + faulty] == pytest.approx(held_at + step, abs=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("start", [1, 2])
def test_buttons_that_are_held_do_not_keep_a_dead_sensor_from_failing_safe(start, tmp_path):
    """`start` and `acknowledge` stuck for ever, in the engine, in C and in Structured Text."""
    settings = PlantShell(fail_safe={"pump_1": 1.25})
    controller = designed("simc", "quadruple-tank")
    program = with_plant_shell(controller, 1.0, settings).program()
    at, samples, before = plant("quadruple-tank").point.as_dict(), 30, 10
    inputs = in_operation(program, samples)
    for name in controller.measurements:
        inputs[f"{name}.pv"][:] = inputs[f"{name}.sp"][:] = at[name]
    inputs["start"][1:], inputs["acknowledge"][1:] = start, 1.0
    inputs["level_1.sp"][5:] += 0.4
    inputs["level_1.good"][before : before + 8] = 0.0
    places = [[s.name for s in program.outputs].index(n) for n in ("pump_1.out", "pump_1.status")]
    run = Kernel(program).run(samples, inputs=inputs)
    columns = [[run.output(n)[0] for n in ("pump_1.out", "pump_1.status")]]
    for instance in (CompiledC(program, tmp_path), InterpretedText(program)):
        rows = [instance({n: float(c[k]) for n, c in inputs.items()}) for k in range(samples)]
        columns.append([np.array([row[place] for row in rows]) for place in places])
    for moved, status in columns:
        assert np.all(np.diff(moved[5:before]) > 0.0)
        assert np.all(moved[before : before + 4] == moved[before - 1])
        assert np.all(moved[before + 4 :] == 1.25)
        assert np.all(status[before + 4 :].astype(int) & 1024)
