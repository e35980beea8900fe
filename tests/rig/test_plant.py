"""The plant of a rig: the simulation, moved by what stands in its image."""

import numpy as np
import pytest
from rig_bench import bench

import clepsydra as cl
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.instructor import Instructor
from clepsydra.rig.plant import RigPlant

STEPS = [(5, "pump_1", 4.0), (20, "pump_2", 2.0), (40, "pump_1", 2.5)]


def test_it_goes_where_the_simulation_goes():
    with bench() as rig:
        told = []
        for sample in range(120):
            for at, pump, value in STEPS:
                if at == sample:
                    rig.write(f"{pump}.out", value)
            told.append([rig.read(f"level_{k}.pv").value for k in (1, 2, 3, 4)])
            rig.step()
    steps = [cl.step(pump, to=value, at=float(at)) for at, pump, value in STEPS]
    run = cl.simulate(cl.load("quadruple-tank"), None, steps, duration="2 min")
    found = np.array(told)
    for place, level in enumerate(f"level_{k}" for k in (1, 2, 3, 4)):
        # The rig has no fused operation, and its own number of integration steps.
        assert found[:, place] == pytest.approx(run.values[level][:120], rel=1e-7)
    assert np.ptp(found[:, 0]) > 0.5


def test_its_local_panel_controls_it_and_takes_over_without_a_bump():
    with bench(remote=False) as rig:
        rig.write("level_1.sp", 7.0)
        rig.step(300)
        assert rig.read("level_1.pv").value == pytest.approx(7.0, abs=0.02)
        position = rig.read("pump_1.position").value
        rig.write("pump_1.out", position)
        rig.write("pump_2.out", rig.read("pump_2.position").value)
        rig.write("operator.remote", 1.0)
        rig.step(50)
        rig.write("operator.remote", 0.0)
        rig.step(2)
        assert rig.read("pump_1.position").value == pytest.approx(position, abs=0.02)


def test_a_silent_controller_leaves_outputs_fail_safe_until_it_is_heard():
    with bench() as rig:
        rig.write("pump_1.out", 3.5)
        rig.step(3)
        assert rig.read("pump_1.position").value == 3.5
        rig.step(1, heard=False)
        assert rig.read("pump_1.position").value == 0.0
        rig.step(1)
        assert rig.read("pump_1.position").value == 3.5


def test_what_is_killed_goes_on_where_it_stood():
    with bench() as rig, bench() as other:
        for each in (rig, other):
            each.write("pump_1.out", 4.0)
            each.step(25)
        again = ProcessImage(rig.path, rig.settings.layout)
        plant = RigPlant(rig.settings, again)
        assert plant.sample == 25
        plant.tell(25.0)
        for _ in range(10):
            plant.step(heard=True, time=26.0)
            other.step()
        assert np.array_equal(again.published().values, other.image.published().values)


@pytest.mark.parametrize(
    ("fault", "shown"), [("dead", 0.0), ("out of range", 10.5), ("stuck", None)]
)
def test_a_sensor_fails_on_demand_and_is_sound_again(fault, shown):
    with bench() as rig:
        before = rig.read("level_1.pv").value
        Instructor(rig.process, rig.image).fail("level_1", fault)
        rig.write("pump_1.out", 4.0)
        rig.step(20)
        reading = rig.read("level_1.pv")
        assert reading.value == pytest.approx(before if shown is None else shown, abs=1e-12)
        assert reading.good == (fault != "dead")
        Instructor(rig.process, rig.image).fail("level_1", "none")
        rig.step()
        assert rig.read("level_1.pv").value > before + 0.3


def test_a_sensor_drifts_by_a_tenth_of_its_range_in_a_thousand_samples():
    with bench() as rig:
        Instructor(rig.process, rig.image).fail("level_1", "drifting")
        start = rig.read("level_1.pv").value
        rig.step(100)
        assert rig.read("level_1.pv").value - start == pytest.approx(0.1, abs=1e-9)


def test_what_sticks_moves_once_it_is_asked_to_go_far():
    with bench() as rig:
        Instructor(rig.process, rig.image).fail("pump_1", "sticking")
        rig.write("pump_1.out", 3.4)
        rig.step(2)
        assert rig.read("pump_1.position").value == 3.0
        rig.write("pump_1.out", 3.6)
        rig.step(2)
        assert rig.read("pump_1.position").value == 3.6


def told_with_noise(seed):
    with bench(seed=seed) as rig:
        Instructor(rig.process, rig.image).noise(True)
        rig.plant.tell(0.0)
        told = []
        for _ in range(1500):
            told.append(rig.image.read("level_1") - rig.image.read("level_1.true"))
            rig.step()
    return np.array(told)


def test_noise_is_of_its_seed_and_as_large_as_the_process_says():
    first, again, other = (told_with_noise(seed) for seed in (7, 7, 8))
    assert np.array_equal(first, again) and not np.array_equal(first, other)
    # 1,500 samples tell a deviation within 5 % in all but one of 100,000 draws.
    assert np.std(first) == pytest.approx(0.05, rel=0.08)
    assert np.mean(first) == pytest.approx(0.0, abs=0.006)
