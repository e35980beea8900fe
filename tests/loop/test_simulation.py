"""Open-loop runs: where they start, how long they last, and closed forms."""

import csv

import numpy as np
import pandas
import pytest
from refusals import refused
from scipy.special import gammainc
from written_plants import plant_of

import clepsydra as cl
from clepsydra.loop.open_loop_plan import plan_simulation

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
def tank(tmp_path):
    """Return a function: nominal inflow → plant."""

    def make(nominal: str) -> cl.Plant:
        return plant_of(tmp_path, ONE_TANK.format(nominal=nominal))

    return make


@pytest.fixture(scope="module")
def four_tanks():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def eight_tanks():
    return cl.load("eight-tanks")


def test_linear_tanks_in_series_fill_as_the_gamma_distribution(eight_tanks):
    """h_n / h_n(∞) = P(n, t / T) for n equal first-order tanks after a step from empty."""
    rest = eight_tanks.point.as_dict()
    volumes = {element.name: element for element in eight_tanks.process.elements}
    times = [
        rest[f"tank_{n}.level"] * tank.vessel.capacity / tank.height / rest["feed"]
        for n, tank in ((n, volumes[f"tank_{n}"]) for n in range(1, 9))
    ]
    assert np.ptp(times) < 1e-9 * times[0]
    run = cl.simulate(eight_tanks, start="empty", duration="40 min")
    for n in range(1, 9):
        expected = rest[f"tank_{n}.level"] * gammainc(n, run.time / times[0])
        assert np.allclose(run.values[f"tank_{n}.level"], expected, rtol=0, atol=1e-6 * 1.5)
    assert run.error_estimate is not None and run.error_estimate < 1e-6


def test_a_tank_drains_as_torricelli_says(tank):
    """√h falls linearly: √h(t) = √h(0) − a √(g/2) t / A."""
    plant = tank("3 l/min")
    gravity = plant.process.signal("gravity").initial
    shut = [cl.step("feed", to=0.0, at=0.0)]
    run = cl.simulate(plant, None, shut, state={"tank.level": "20 cm"}, duration="30 s")
    slope = 0.5e-4 * np.sqrt(gravity / 2) / 0.01
    expected = (np.sqrt(0.2) - slope * run.time) ** 2
    assert 0.01 < expected[-1] < 0.02
    assert np.allclose(run.values["tank.level"], expected, rtol=0, atol=0.3e-6)


def test_without_inputs_the_process_stays_at_rest(four_tanks):
    run = cl.simulate(four_tanks)
    for signal in run.signals:
        values = run.values[signal.name]
        assert np.allclose(values, values[0], rtol=1e-12, atol=0)
    assert run.events == ()


def test_kernel_and_reference_solver_agree(four_tanks):
    events = [
        cl.step("pump_1", to="3.5 V", at="10 s"),
        cl.ramp("pump_1", to="4 V", at="30 s", over="1 min"),
        cl.step("inflow_2", to="2 cm^3/s", at="50 s"),
    ]
    kernel, reference = (
        cl.simulate(four_tanks, None, events, duration="3 min", solver=solver)
        for solver in ("kernel", "reference")
    )
    assert reference.error_estimate is None and reference.substeps == 0
    assert np.array_equal(kernel.values["pump_1"], reference.values["pump_1"])
    difference = max(
        np.max(np.abs(kernel.values[signal.name] - reference.values[signal.name])) / signal.span
        for signal in kernel.process.state
    )
    assert 0 < difference < 1e-8


def test_the_default_duration_is_six_of_the_slowest_time_constants_after_the_last_change(
    four_tanks,
):
    # 90.6 s: six of them are 543.8 s.
    assert cl.simulate(four_tanks).time[-1] == 600.0
    late = [cl.step("pump_1", to="3.2 V", at="5 min")]
    assert cl.simulate(four_tanks, None, late).time[-1] == 900.0


def test_many_equal_tanks_are_given_the_time_that_the_last_of_them_takes(eight_tanks):
    """The gamma distribution of order 8 is at 26 % after six time constants of one tank."""
    run = cl.simulate(eight_tanks, None, [cl.step("feed", to="1.01 l/min", at=0.0)])
    level = run.values["tank_8.level"]
    rest = eight_tanks.at(inputs={"feed": "1.01 l/min"}).point.as_dict()["tank_8.level"]
    assert abs(level[-1] - rest) < 0.02 * abs(level[0] - rest)


def test_the_default_duration_waits_for_dead_times(start):
    """A tank of 50 s behind a channel of ten minutes: 600 s and six times 50 s, so 15 min."""
    assert cl.simulate(cl.Plant(start(LATE, 1.0).process)).time[-1] == 900.0


def test_a_duration_between_samples_is_rounded_up(four_tanks):
    assert cl.simulate(four_tanks, duration="59.5 s").time[-1] == 60.0


def test_empty_means_empty_tanks_and_nothing_else():
    well = cl.load("wet-well").process
    rest, empty = (
        plan_simulation(well, start=start).first.as_dict() for start in ("rest", "empty")
    )
    assert empty["well.level"] == 0.0 < rest["well.level"]
    for name in ("duty.actual", "standby.actual", "duty", "inflow"):
        assert empty[name] == rest[name]


def test_a_given_state_starts_there_and_the_others_at_rest(four_tanks):
    run = cl.simulate(four_tanks, state={"tank_1.level": 5.0}, duration="10 s")
    assert run.as_dict()["start"] == "at rest, but for tank_1.level"
    assert run.values["tank_1.level"][0] == 0.05
    assert run.values["tank_2.level"][0] == four_tanks.point.as_dict()["tank_2.level"]


def test_a_process_that_never_rests_can_start_empty_or_anywhere(tank):
    plant = tank("8 l/min")  # 36 cm would be needed, and the tank has 30 cm
    with pytest.raises(cl.NoEquilibrium, match=r"tank\.level.*has to start empty"):
        cl.simulate(plant)
    for options in ({"start": "empty"}, {"state": {"tank.level": "10 cm"}}):
        run = cl.simulate(plant, **options, duration="20 s")
        assert np.all(np.diff(run.values["tank.level"]) > 0)
    assert run.as_dict()["start"] == "at the given state"


#: What is asked for, and place, value and a part of what was expected or of the remedy.
BAD_REQUESTS = {
    "start": ({"start": "full"}, ("start", "full", "one of rest, empty", "choose one")),
    "solver": ({"solver": "euler"}, ("solver", "euler", "one of kernel, reference", "")),
    "no unit": ({"duration": "20"}, ("duration", "20", "a quantity convertible to s", "")),
    "negative": ({"duration": "-5 min"}, ("duration", "-5 min", "a time above 0 s", "'20 min'")),
    "endless": ({"duration": "1 year"}, ("duration", "365.2 d", "at most 11.57 d, a million", "")),
    "state": (
        {"state": {"tnak_1.level": "5 cm"}},
        ("state", "tnak_1.level", "", "'tank_1.level' was meant"),
    ),
    "overflow": (
        {"state": {"tank_1.level": "25 cm"}},
        ("state, tank_1.level", "25 cm", "a value from 0 to", ""),
    ),
    "signal": (
        {"events": [cl.step("pmup_1", to="3 V", at=0.0)]},
        ("step of pmup_1", "pmup_1", "an input or a disturbance of quadruple-tank", "was meant"),
    ),
}


@pytest.mark.parametrize("case", BAD_REQUESTS)
def test_bad_requests_are_refused(four_tanks, case):
    options, (place, value, expected, remedy) = BAD_REQUESTS[case]
    with refused(place=place, value=value, expected=expected, remedy=remedy):
        cl.simulate(four_tanks, **options)


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_trajectories_are_read_back(four_tanks, tmp_path, ending):
    """Bit for bit from Parquet, in SI; from CSV in the units of the file to 13 digits."""
    run = cl.simulate(four_tanks, None, [cl.step("pump_1", to=3.5, at=0.0)], duration="60 s")
    path = tmp_path / f"run.{ending}"
    run.save(path)
    if ending == "parquet":
        table = pandas.read_parquet(path)
        assert all(np.array_equal(table[s.name], run.values[s.name]) for s in run.signals)
        return
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    table = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    assert table["tank_1.level [cm]"] == pytest.approx(
        100.0 * run.values["tank_1.level"], rel=1e-12
    )
    assert np.array_equal(table["level_1 [V]"], run.values["level_1"])
    assert "inflow_1 [cm^3/s]" in table and len(table) == 1 + len(run.signals)


def test_an_unknown_kind_of_file_is_refused(four_tanks, tmp_path):
    run = cl.simulate(four_tanks, duration="10 s")
    with refused(expected="ends in .parquet or .csv"):
        run.save(tmp_path / "run.xls")
    assert list(tmp_path.iterdir()) == []
