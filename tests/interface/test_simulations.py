"""Simulations: exactly the events asked for, in the order of their times."""

import numpy as np
import pytest

import clepsydra as cl


def test_a_step_a_ramp_and_a_load_are_exactly_these(plant, pi):
    run = cl.simulate(
        plant,
        pi,
        [
            cl.disturbance("inflow_1", "+10 %", at="15 min"),
            cl.step("level_1", "+1 V", at="1 min"),
            cl.ramp("level_2", to="7 V", over="5 min", at="5 min"),
        ],
        duration=1200,
    )
    time, rest = run.time, plant.point.as_dict()
    assert time.size == 1200
    first, second, load = (
        run.values[name] for name in ("level_1.setpoint", "level_2.setpoint", "inflow_1")
    )
    assert np.array_equal(first, np.where(time < 60.0, rest["level_1"], rest["level_1"] + 1.0))
    way = np.clip((time - 300.0) / 300.0, 0.0, 1.0)
    assert second == pytest.approx(rest["level_2"] + way * (7.0 - rest["level_2"]), abs=1e-12)
    assert np.array_equal(load, np.where(time < 900.0, 0.0, 0.5e-6))  # 10 % of 5 cm³/s
    assert np.all(run.values["level_1"][:60] == pytest.approx(rest["level_1"], abs=1e-9))
    assert not run.scenario.noise.any()


def test_events_without_a_time_follow_each_other_as_in_the_default_scenario(plant, pi):
    default = cl.simulate(plant, pi).scenario
    first, second = default.segments[:2]
    run = cl.simulate(plant, pi, [cl.step("level_1", "1 V"), cl.step("level_2", "1 V")])
    assert [s.start for s in run.scenario.segments] == [first.start, second.start]
    assert run.scenario.duration == second.stop


def test_numbers_and_text_are_the_same(plant, pi):
    runs = [
        cl.simulate(plant, pi, [cl.step("level_1", by, at=at)], duration=duration)
        for by, at, duration in (("1 V", "1 min", "5 min"), (1.0, 60, 300), ("10 %", 60.0, "300 s"))
    ]
    for run in runs[1:]:
        assert np.array_equal(run.values["tank_1.level"], runs[0].values["tank_1.level"])


def test_two_steps_at_once_run_and_are_no_response_to_either(plant, pi):
    both = [cl.step("level_1", "1 V", at=60), cl.step("level_2", "1 V", at=60)]
    run = cl.simulate(plant, pi, both, duration="10 min")
    assert run.scenario.segments == () and run.scores["iae[level_1]"] > 0.0
    assert "overshoot[level_1]" not in run.scores


def test_the_overshoot_is_that_of_the_trajectory(plant, pi):
    run = cl.simulate(plant, pi, [cl.step("level_1", "1 V", at=60)])
    level = run.values["level_1"]
    overshoot = 100.0 * (level.max() - run.values["level_1.setpoint"][-1])
    assert run.scores["overshoot[level_1]"] == pytest.approx(overshoot, abs=0.05)
    assert "overshoot" in repr(run) and "level_1" in repr(run.scores)


def test_without_a_controller_a_step_leads_to_the_static_gain(plant):
    """A small step of a pump moves the levels by the static gain of the linear model."""
    run = cl.simulate(plant, None, [cl.step("pump_1", "+10 mV")])
    moved = run.values["level_1"][-1] - run.values["level_1"][0]
    assert moved == pytest.approx(0.01 * plant.analysis.static_gain[0, 0], rel=5e-3)


def test_without_events_nothing_moves(plant):
    run = cl.simulate(plant)
    assert max(np.ptp(run.values[s.name]) / s.span for s in plant.process.state) < 1e-9


def test_it_starts_where_the_plant_was_put(plant, pi):
    lower = plant.at(outputs={"level_1": 4, "level_2": 4})
    for run in (cl.simulate(lower), cl.simulate(lower, cl.design.simc(lower), [], duration=60)):
        assert run.values["level_1"][0] == pytest.approx(4.0)
        assert run.values["level_1"][-1] == pytest.approx(4.0, abs=1e-8)


def test_states_may_start_elsewhere(plant):
    by_text = cl.simulate(plant, state={"tank_1.level": "5 cm"}, duration="1 min")
    by_number = cl.simulate(plant, state={"tank_1.level": 5}, duration=60.0)
    assert by_text.values["tank_1.level"][0] == by_number.values["tank_1.level"][0] == 0.05
    empty = cl.simulate(plant, start="empty", duration=60)
    assert empty.values["tank_3.level"][0] == 0.0 and empty.values["tank_3.level"][-1] > 0.0


def test_a_profile_of_a_file_moves_the_inputs(plant, tmp_path):
    (tmp_path / "inputs.csv").write_text("time [min],pump_1 [V]\n0,3\n1,3.5\n")
    events = cl.profile(tmp_path / "inputs.csv", plant)
    run = cl.simulate(plant, None, events, duration="3 min")
    same = cl.simulate(plant, None, [cl.step("pump_1", to=3.5, at="1 min")], duration="3 min")
    assert np.array_equal(run.values["tank_1.level"], same.values["tank_1.level"])


@pytest.mark.thorough
def test_tables_and_files_hold_the_trajectories(plant, pi, tmp_path):
    pandas = pytest.importorskip("pandas")
    for run in (cl.simulate(plant, pi), cl.simulate(plant, duration=60)):
        table, dataset = run.to_pandas(), run.to_xarray()
        assert np.array_equal(table["tank_1.level"], run.values["tank_1.level"])
        assert dataset["level_1"].attrs["units"] == "V" and dataset["time"].attrs["units"] == "s"
        run.save(tmp_path / "run.csv")
        run.save(tmp_path / "run.parquet")
        read = pandas.read_csv(tmp_path / "run.csv")
        level = 0.01 * read["tank_1.level [cm]"]
        assert np.allclose(level, run.values["tank_1.level"], rtol=1e-12, atol=0.0)
        assert np.array_equal(
            pandas.read_parquet(tmp_path / "run.parquet")["pump_1"], run.values["pump_1"]
        )
        assert len(run.plot().axes) > 3


def test_the_reference_solver_agrees(plant, pi):
    events = [cl.step("level_1", "1 V", at=10)]
    kernel, reference = (
        cl.simulate(plant, pi, events, duration=120, solver=solver)
        for solver in ("kernel", "reference")
    )
    difference = np.abs(kernel.values["tank_1.level"] - reference.values["tank_1.level"])
    assert difference.max() < 1e-6 * 0.2


def test_a_run_whose_step_was_halved_says_how_far_off_it_may_be(plant, pi):
    """The kernel halves it where setpoints are followed, not for a start and stop of pumps."""
    assert 0.0 < cl.simulate(plant, pi, duration="1 min").error_estimate < 1e-6
    assert cl.simulate(plant, pi, duration="1 min", solver="reference").error_estimate is None
    well = cl.load("wet-well:start-stop")
    switched = cl.simulate(well, cl.design.start_stop_levels(well), duration="1 min")
    assert switched.error_estimate is None


def test_a_pour_is_one_load_that_is_judged_until_the_level_is_back(plant, pi):
    """Of two steps of a load the first would last for a second, and never be over."""
    poured = cl.disturbance("inflow_1", to="5 cm^3/s", at="10 s", lasts="20 s")
    run = cl.simulate(plant, pi, [poured], duration="10 min")
    (segment,) = run.scenario.segments
    assert (segment.kind, segment.start, segment.stop, segment.over) == ("load", 10.0, 600.0, 20.0)
    assert segment.size == 5e-6
    flow = run.values["inflow_1"]
    assert list(flow[[9, 10, 29, 30]]) == [0.0, 5e-6, 5e-6, 0.0] and not flow[30:].any()
    assert 0.0 < run.scores["return_time[level_1]"] < 590.0
    assert "inflow_1 to 5 cm³/s at 10 s for 20 s." in " ".join(str(run).split())


def test_events_without_a_time_follow_the_end_of_a_pulse(plant, pi):
    first = cl.disturbance("inflow_1", "+10 %", at="10 s", lasts="20 s")
    events = [first, cl.disturbance("inflow_1", "+10 %"), cl.step("level_1", "1 V", at="50 s")]
    run = cl.simulate(plant, pi, events)
    pulse, late = (change for change in run.changes if change.signal == "inflow_1")
    same = cl.simulate(plant, pi, [cl.disturbance("inflow_1", "+10 %", at="30 s"), events[1]])
    assert late.start == same.changes[1].start
    assert late.value == pulse.value  # as much from what it was before the pulse


def test_noise_is_that_of_the_process_file_alone(pi):
    plant = cl.load("laboratory-four-tanks")
    loop = cl.design.simc(plant)
    steps = [cl.step("level_1", to="50 %", at=5)]
    runs = [
        cl.simulate(plant, loop, steps, duration="2 min", noise=True, seed=seed) for seed in (3, 4)
    ]
    for run in runs:
        assert not run.scenario.noise.any()  # no sensor of that file has any
        drawn = run.values["pump_1.noise"]
        assert drawn.std() == pytest.approx(0.1, rel=4.0 / np.sqrt(2 * drawn.size))
        assert f"pump_1.noise and pump_2.noise from seed {run.scenario.seed}." in str(run)
    assert np.any(runs[0].values["pump_1.noise"] != runs[1].values["pump_1.noise"])
    quiet = cl.simulate(plant, loop, steps, duration="2 min")
    assert not quiet.values["pump_1.noise"].any() and quiet.as_dict()["noise"] == {}
