"""The balances of liquid and components over everything that a plant can do at once."""

import numpy as np
import pytest
from deploy.random_processes import ProcessFile, processes
from hypothesis import HealthCheck, given, settings

from clepsydra.loop.open_loop import simulate

PLANT = """
controlled = ["level"]
[components.salt]
range = ["0 kg/m^3", "100 kg/m^3"]
[components.acid]
range = ["0 mol/m^3", "1000 mol/m^3"]
[reservoirs.works]
[tanks.well]
area = "2 m^2"
height = "1.5 m"
weir = "0.5 m"
evaporation = "20 mm/h"
[tanks.bowl]
shape = "sphere"
diameter = "2 m"
height = "1.2 m"
weir = "1 m"
[delays.main]
destination = "bowl"
time = "40 s"
[flows.inflow]
destination = "well"
range = ["0 l/s", "80 l/s"]
nominal = "20 l/s"
[flows.inflow.concentration]
salt = "8 kg/m^3"
[flows.inflow.concentration.acid]
range = ["0 mol/m^3", "1000 mol/m^3"]
nominal = "200 mol/m^3"
[flows.taken]
source = "bowl"
range = ["0 l/s", "80 l/s"]
nominal = "0 l/s"
[pumps.duty]
source = "well"
destination = "main"
gain = "3 l/(s V)"
range = ["0 V", "10 V"]
nominal = "10 V"
lag = "3 s"
start_above = { well = "1.2 m" }
stop_below = { well = "0.4 m" }
running = false
[pumps.second]
source = "well"
destination = "works"
gain = "1 l/(s V)"
range = ["0 V", "10 V"]
nominal = "10 V"
trip_above = { bowl = "1.1 m" }
hysteresis = "5 cm"
[orifices.leak]
source = "bowl"
destination = "well"
area = "4 cm^2"
elevation = "10 cm"
[sensors.level]
tank = "well"
range = ["0 m", "1.5 m"]
"""


def test_balances_close_over_spilling_evaporation_delays_and_switches(start):
    """Everything at once for an hour and a half: nothing is lost but to rounding."""
    state = {
        "well__level": 0.8, "well__salt": 3.0, "well__acid": 500.0, "duty__actual": 0.0,
        "bowl__level": 0.6, "bowl__salt": 40.0, "bowl__acid": 0.0,
    }  # fmt: skip
    point, samples = start(PLANT, 5.0, **state), 1080
    inflow = np.full(samples, 15e-3)
    inflow[200:300], inflow[300:420], inflow[600:] = 75e-3, 2e-3, 25e-3
    taken = np.zeros(samples)
    taken[700:] = 60e-3
    acid = np.linspace(0.0, 1000.0, samples)
    profiles = {"inflow": inflow, "taken": taken, "inflow.acid": acid}
    result = simulate(point, profiles, substeps=10)
    happened = {event.event for event in result.events}
    assert happened >= {
        "duty.starts", "duty.stops", "second.trips_bowl_above", "second.is_released",
        "taken.runs_dry", "taken.draws_again",
    }  # fmt: skip
    for name, largest in (("salt", 40.0), ("acid", 1000.0)):
        for tank in ("well", "bowl"):
            concentration = result.values[f"{tank}.{name}"]
            assert np.min(concentration) > -1e-9 and np.max(concentration) < largest + 1e-9
    assert result.values["well.spilt"][-1] > 0.1 and result.values["bowl.spilt"][-1] > 0.1
    assert [balance.name for balance in result.balances] == ["liquid", "salt", "acid"]
    entered = 5.0 * np.array([inflow.sum(), 8 * inflow.sum(), (inflow * acid).sum()])
    assert [b.entered for b in result.balances] == pytest.approx(list(entered), rel=1e-12)
    assert all(balance.error < 1e-12 for balance in result.balances)


EMPTIED = """
controlled = ["level"]
manipulated = ["feed"]
[components.salt]
range = ["0 kg/m^3", "100 kg/m^3"]
[tanks.tank]
area = "300 cm^2"
height = "50 cm"
[flows.feed]
destination = "tank"
range = ["0 l/s", "1 l/s"]
nominal = "0 l/s"
[orifices.hole]
source = "tank"
area = "0.9 cm^2"
destination = "basin"
[reservoirs.basin]
concentration = { salt = "10 kg/m^3" }
[sensors.level]
tank = "tank"
range = ["0 cm", "50 cm"]
"""


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_what_stays_dissolved_in_an_emptied_tank_is_counted(start, solver):
    """A concentration of it no longer says how much it is: the volume is nothing."""
    point = start(EMPTIED, 1.0, tank__level=0.02, tank__salt=50.0)
    result = simulate(point, {"feed": np.zeros(60)}, substeps=20, solver=solver)
    assert result.values["tank.level"][-1] < 1e-9
    salt = result.balances[1]
    assert salt.left < 0.02 * 300e-4 * 50.0
    # CVODES keeps each amount within its tolerance and not their sum to rounding.
    assert salt.error < (1e-12 if solver == "kernel" else 1e-9)


@pytest.mark.parametrize("plants", [1, pytest.param(20, marks=pytest.mark.thorough)])
def test_balances_close_in_plants_drawn_at_random(plants):
    """Of every element that a file may have, started anywhere, with inputs that jump."""

    @settings(
        max_examples=plants, deadline=None, derandomize=True, database=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(processes())
    def every_plant(written: ProcessFile) -> None:
        point, random = written.point(), np.random.default_rng(written.start)
        profiles = {
            s.name: np.repeat(random.uniform(max(s.low, 0.0), min(s.high, 1e3), 6), 10)
            for s in (*point.process.inputs, *point.process.disturbances)
        }
        for balance in simulate(point, profiles, substeps=20).balances:
            assert balance.error < 1e-12, balance.name

    every_plant()
