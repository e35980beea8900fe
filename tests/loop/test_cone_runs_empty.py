"""A pointed cone that runs empty: where the slope of the level on the volume has no bound."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from written_plants import plant_of

import clepsydra as cl

CONE_AND_STORE = """
name = "cone-and-prism"
sampling_period = "10 s"
gravity = "9.81 m/s^2"
controlled = ["level"]
[reservoirs.basin]
[tanks.funnel]
shape = "cone"
rim_diameter = "40 cm"
height = "33 cm"
[tanks.store]
area = "0.05 m^2"
height = "50 cm"
[linear_outlets.join]
source = "funnel"
destination = "store"
coefficient = "1 cm^2/s"
submerged = true
[orifices.out]
source = "store"
destination = "basin"
area = "0.2 cm^2"
[pumps.p]
source = "basin"
destination = "funnel"
gain = "2 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "5 V"
[sensors.level]
tank = "store"
range = ["0 cm", "50 cm"]
"""


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    return plant_of(tmp_path_factory.mktemp("cone"), CONE_AND_STORE)


def drained(plant, duration, solver):
    return cl.simulate(
        plant, None, [cl.step("p", to="0 V", at=0)], duration=duration, solver=solver
    )


def by_hand(plant, times):
    """Both levels [cm], the volume of the cone integrated by SciPy's BDF in cm and s."""

    def rates(_, state):
        cone = np.cbrt(max(state[0], 0.0) * 3.0 * 33.0**2 / (np.pi * 20.0**2))
        small = state[1] / 0.1
        laminar = np.sqrt(0.1) * (45 * small - 18 * small**3 + 5 * small**5) / 32
        root = max(laminar, 0.0) if state[1] < 0.1 else np.sqrt(state[1])
        between = 1.0 * (cone - state[1])
        return [-between, (between - 0.2 * np.sqrt(2 * 981.0) * root) / 500.0]

    at = plant.point.as_dict()
    cone, store = (100.0 * at[f"{tank}.level"] for tank in ("funnel", "store"))
    start = [np.pi * (20.0 / 33.0) ** 2 * cone**3 / 3.0, store]
    found = solve_ivp(
        rates, (0.0, times[-1]), start, method="BDF", t_eval=times, rtol=1e-10, atol=1e-13
    )
    cones = np.cbrt(np.maximum(found.y[0], 0.0) * 3.0 * 33.0**2 / (np.pi * 20.0**2))
    return cones, found.y[1]


def test_the_reference_solver_passes_the_tip_and_is_right(plant):
    """Within 1e-6 of the height of integrations of the same equations by other means.

    What is integrated is the volume: in the tip the level is as unsure as its cube root.
    """
    run = drained(plant, "4 min", "reference")
    cone, store = by_hand(plant, run.time)
    found, above = 100.0 * run.values["funnel.level"], cone > 1e-3  # [cm]
    assert found[above] == pytest.approx(cone[above], abs=33e-6)
    assert np.sum(above) >= 20 and np.all(found[~above] < 2e-3)
    assert 100.0 * run.values["store.level"] == pytest.approx(store, abs=50e-6)
    assert run.values["funnel.level"][-1] < 2e-6  # of 11 cm


@pytest.mark.thorough
def test_it_runs_through_two_hours(plant):
    run = drained(plant, "2 h", "reference")
    assert run.time[-1] == 7200.0 and run.values["funnel.level"].min() >= 0.0


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_no_level_is_below_its_floor(plant, solver):
    run = drained(plant, "10 min", solver)
    assert all(run.values[name].min() >= 0.0 for name in plant.process.levels)
    assert run.balances[0].error < 1e-9


def test_the_kernel_is_right_within_its_estimate(plant):
    run = drained(plant, "4 min", "kernel")
    cone, store = by_hand(plant, run.time)
    away = [
        np.max(np.abs(100.0 * run.values["funnel.level"] - cone)) / 33.0,
        np.max(np.abs(100.0 * run.values["store.level"] - store)) / 50.0,
    ]
    assert 1e-6 < max(away) < run.error_estimate
