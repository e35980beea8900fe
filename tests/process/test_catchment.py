"""A catchment: its runoff in closed form, its balance, and what is refused."""

import numpy as np
import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra import InputError

PLANT = """
name = "storm-tank"
sampling_period = "10 s"
controlled = ["level_1"]

[reservoirs.river]

[tanks.tank_1]
area = "100 m^2"
height = "4 m"

[catchments.roofs]
destination = "tank_1"
area = "1 ha"
runoff_share = 0.9
time = "10 min"
range = ["0 mm/h", "90 mm/h"]
nominal = "0 mm/h"
step = "36 mm/h"

[pumps.pump_1]
source = "tank_1"
destination = "river"
gain = "12 L/(s V)"
range = ["0 V", "10 V"]

[sensors.level_1]
tank = "tank_1"
range = ["0 m", "4 m"]

[operating_point]
level_1 = "2 m"
"""


@pytest.fixture
def plant(tmp_path):
    return plant_of(tmp_path, PLANT)


def test_rain_runs_off_as_through_a_first_order_lag(plant):
    """Ψ A i = 90 l/s in the end: q = 90 l/s (1 − e^(−t/T)), and h rises by its integral over A."""
    run = cl.simulate(plant, None, [cl.step("roofs", "36 mm/h", at="0 s")], duration="30 min")
    time, steady, lag = run.time, 0.09, 600.0
    runoff = steady * (1.0 - np.exp(-time / lag))
    # The tolerance of the solver, 1e-8 of what moves.
    assert run.values["roofs.runoff"] == pytest.approx(runoff, abs=1e-8)
    volume = steady * time - lag * runoff
    assert run.values["tank_1.level"] == pytest.approx(2.0 + volume / 100.0, abs=1e-7)


def test_the_linear_model_has_its_pole_and_its_gain(plant):
    """From rain to runoff ψ A/(T s + 1)."""
    poles = np.sort(np.linalg.eigvals(plant.linear.A).real)
    assert poles == pytest.approx([-1.0 / 600.0, 0.0], abs=1e-12)


def test_a_study_tries_the_cloudburst(plant):
    run = cl.simulate(plant, cl.design.arrest_time(plant))
    assert any("roofs" in part.signal for part in run.scenario.segments if part.kind == "load")
    assert run.scores["peak_deviation[level_1]"] > 0.1


@pytest.mark.parametrize(
    ("line", "by", "said"),
    [
        ("runoff_share = 0.9", "runoff_share = 1.2", "runoff_share"),
        ('time = "10 min"', 'time = "0 s"', "time"),
        ('area = "1 ha"', 'area = "1 m"', "area"),
        ('nominal = "0 mm/h"\nstep', 'nominal = "99 mm/h"\nstep', "nominal"),
        ('destination = "tank_1"\narea', 'destination = "tank_9"\narea', "tank_9"),
    ],
)
def test_what_is_none_is_refused(tmp_path, line, by, said):
    assert PLANT.count(line) == 1
    with pytest.raises(InputError, match=said):
        plant_of(tmp_path, PLANT.replace(line, by))
