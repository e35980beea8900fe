"""Open-loop runs from words: where they start, how long they last, and closed forms."""

import csv

import numpy as np
import pandas
import pytest
from refusals import refused
from scipy.special import gammainc

from clepsydra import ClepsydraError, InputError
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.loop.open_loop_plan import plan_simulation
from clepsydra.loop.profile import read_assignment
from clepsydra.loop.simulation import simulate
from clepsydra.loop.trajectory_file import write_trajectories
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

ONE_TANK = """
name = "one"
sampling_period = "2 s"
controlled = ["level"]
manipulated = ["feed"]
[reservoirs.drain]
[tanks.tank]
area = "100 cm^2"
height = "30 cm"
[orifices.outlet]
source = "tank"
destination = "drain"
area = "0.5 cm^2"
[flows.feed]
destination = "tank"
range = ["0 l/min", "8 l/min"]
nominal = "{nominal}"
[sensors.level]
tank = "tank"
range = ["0 cm", "30 cm"]
"""

LATE = """
controlled = ["level"]
manipulated = ["feed"]
[reservoirs.drain]
[delays.channel]
destination = "tank"
time = "10 min"
[tanks.tank]
area = "1 m^2"
height = "4 m"
[linear_outlets.outlet]
source = "tank"
destination = "drain"
coefficient = "0.02 m^2/s"
[flows.feed]
destination = "channel"
range = ["0 l/s", "80 l/s"]
nominal = "20 l/s"
[sensors.level]
tank = "tank"
range = ["0 m", "4 m"]
"""


@pytest.fixture
def plant(tmp_path):
    """Return a function: nominal inflow → process."""

    def make(nominal: str) -> Process:
        path = tmp_path / "one.toml"
        path.write_text(ONE_TANK.format(nominal=nominal))
        return load_process(path)

    return make


def test_linear_tanks_in_series_fill_as_the_gamma_distribution():
    """h_n / h_n(∞) = P(n, t / T) for n equal first-order tanks after a step from empty."""
    process = load_process("eight-tanks")
    rest = find_equilibrium(process).as_dict()
    times = [
        rest[f"tank_{n}.level"] * element.vessel.capacity / element.height / rest["feed"]
        for n, element in (
            (n, next(e for e in process.elements if e.name == f"tank_{n}")) for n in range(1, 9)
        )
    ]
    assert np.ptp(times) < 1e-9 * times[0]
    run = simulate(process, start="empty", duration="40 min")
    for n in range(1, 9):
        expected = rest[f"tank_{n}.level"] * gammainc(n, run.time / times[0])
        assert np.allclose(run.values[f"tank_{n}.level"], expected, rtol=0, atol=1e-6 * 1.5)
    assert run.error_estimate is not None and run.error_estimate < 1e-6


def test_a_tank_drains_as_torricelli_says(plant):
    """√h falls linearly: √h(t) = √h(0) − a √(g/2) t / A."""
    process = plant("3 l/min")
    gravity = next(p.initial for p in process.parameters if p.name == "gravity")
    run = simulate(process, {"feed": "0 l/min"}, state={"tank.level": "20 cm"}, duration="30 s")
    slope = 0.5e-4 * np.sqrt(gravity / 2) / 0.01
    expected = (np.sqrt(0.2) - slope * run.time) ** 2
    assert 0.01 < expected[-1] < 0.02
    assert np.allclose(run.values["tank.level"], expected, rtol=0, atol=0.3e-6)


def test_without_inputs_the_process_stays_at_rest():
    run = simulate("quadruple-tank")
    for signal in run.signals:
        values = run.values[signal.name]
        assert np.allclose(values, values[0], rtol=1e-12, atol=0)
    assert run.happenings == ()


def test_kernel_and_reference_solver_agree():
    words = {"pump_1": ["3.5 V @ 10 s", "4 V @ 30 s..90 s"], "inflow_2": "2 cm^3/s @ 50 s"}
    kernel, reference = (
        simulate("quadruple-tank", words, duration="3 min", solver=solver)
        for solver in ("kernel", "reference")
    )
    assert reference.error_estimate is None and reference.substeps == 0
    assert np.array_equal(kernel.values["pump_1"], reference.values["pump_1"])
    difference = max(
        np.max(np.abs(kernel.values[signal.name] - reference.values[signal.name])) / signal.span
        for signal in kernel.process.state
    )
    assert 0 < difference < 1e-8


def test_the_default_duration_is_six_of_the_slowest_time_constants_after_the_last_change():
    process = load_process("quadruple-tank")  # 90.6 s: six of them are 543.8 s
    assert plan_simulation(process).duration == 600.0
    change = read_assignment("pump_1=3.2V@5min", process, "--input")
    assert plan_simulation(process, [change]).duration == 900.0


def test_many_equal_tanks_are_given_the_time_that_the_last_of_them_takes():
    """The gamma distribution of order 8 is at 26 % after six time constants of one tank."""
    process = load_process("eight-tanks")
    run = simulate(process, {"feed": "1.01 l/min @ 0 s"})
    level = run.values["tank_8.level"]
    rest = find_equilibrium(
        process, inputs={"feed": float(run.values["feed"][0])}, disturbances={}
    ).as_dict()["tank_8.level"]
    assert abs(level[-1] - rest) < 0.02 * abs(level[0] - rest)


def test_the_default_duration_waits_for_dead_times(start):
    """A tank of 50 s behind a channel of ten minutes: 600 s and six times 50 s, so 15 min."""
    point = start(LATE, 1.0)
    assert plan_simulation(point.process).duration == 900.0


def test_a_duration_between_samples_is_rounded_up():
    assert plan_simulation(load_process("quadruple-tank"), duration="59.5 s").samples == 60


def test_empty_means_empty_tanks_and_nothing_else():
    process = load_process("wet-well")
    rest, empty = (plan_simulation(process, start=start).first for start in ("rest", "empty"))
    assert empty.as_dict()["well.level"] == 0.0 < rest.as_dict()["well.level"]
    for name in ("duty.actual", "standby.actual", "duty", "inflow"):
        assert empty.as_dict()[name] == rest.as_dict()[name]


def test_a_given_state_starts_there_and_the_others_at_rest():
    plan = plan_simulation(load_process("quadruple-tank"), state={"tank_1.level": 0.05})
    run = plan.run()
    assert plan.begins == "at rest, but for tank_1.level"
    assert run.values["tank_1.level"][0] == 0.05 == plan.first.as_dict()["tank_1.level"]
    assert run.values["tank_2.level"][0] == plan.point.as_dict()["tank_2.level"]


def test_a_process_that_never_rests_can_start_empty_or_anywhere(plant):
    process = plant("8 l/min")  # 36 cm would be needed, and the tank has 30 cm
    with pytest.raises(ClepsydraError, match=r"tank\.level.*that a simulation has to start empty"):
        plan_simulation(process)
    for plan in (
        plan_simulation(process, start="empty", duration="20 s"),
        plan_simulation(process, state={"tank.level": 0.1}, duration="20 s"),
    ):
        level = plan.run().values["tank.level"]
        assert np.all(np.diff(level) > 0)
    assert plan.begins == "at the given state"


BAD_REQUESTS = {
    "start": ({"start": "full"}, "start: got 'full', expected one of rest, empty; choose one."),
    "solver": ({"solver": "euler"}, "solver: got 'euler', expected one of kernel, reference"),
    "no unit": ({"duration": "20"}, "duration: got '20', expected a quantity convertible to s"),
    "no time": ({"duration": "0 s"}, "duration: got '0 s', expected a time above 0 s"),
    "negative": ({"duration": "-5 min"}, "expected a time above 0 s; write it as in '20 min'."),
    "endless": ({"duration": "1 year"}, "got '365.2 d', expected at most 11.57 d, a million"),
    "state": ({"state": {"tnak_1.level": "5 cm"}}, "perhaps 'tank_1.level' was meant"),
    "overflow": ({"state": {"tank_1.level": "25 cm"}}, "got '25 cm', expected a value from 0 to"),
    "state's unit": ({"state": {"tank_1.level": "5 V"}}, "state, tank_1.level: got '5 V'"),
    "signal": ({"inputs": {"pmup_1": "3 V"}}, "inputs, pmup_1: got 'pmup_1', expected an input"),
    "no mapping": ({"inputs": ["pump_1"]}, "inputs: got 'a list', expected a mapping"),
}


@pytest.mark.parametrize("case", BAD_REQUESTS)
def test_bad_requests_are_refused(case):
    options, words = BAD_REQUESTS[case]
    with pytest.raises(InputError) as refusal:
        simulate("quadruple-tank", **options)
    assert words in str(refusal.value)


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_trajectories_are_read_back_bit_for_bit(tmp_path, ending):
    run = simulate("quadruple-tank", {"pump_1": "3.5 V"}, duration="60 s")
    path = tmp_path / f"run.{ending}"
    write_trajectories(run, path)
    if ending == "parquet":
        table = pandas.read_parquet(path)
    else:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        table = {name: [float(row[name]) for row in rows] for name in rows[0]}
    for signal in run.signals:
        column = signal.name if ending == "parquet" else f"{signal.name} [{signal.unit}]"
        assert np.array_equal(table[column], run.values[signal.name])


def test_an_unknown_kind_of_file_is_refused(tmp_path):
    run = simulate("quadruple-tank", duration="10 s")
    with refused(expected="ends in .parquet or .csv"):
        write_trajectories(run, tmp_path / "run.xls")
    assert list(tmp_path.iterdir()) == []
