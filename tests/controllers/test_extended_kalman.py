"""The extended Kalman filter beside one in NumPy, beside the linear one, and in an empty tank."""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from refusals import refused
from scan_rig import ScannedLaw
from scipy.linalg import expm

import clepsydra as cl
from clepsydra.controllers.observers.extended_kalman import ExtendedKalman
from clepsydra.linear.linearise import Derivatives
from clepsydra.linear.process_equations import process_equations

PLANT = cl.load("quadruple-tank")
PROCESS, POINT = PLANT.process, PLANT.point
SLOPE = 50.0  # of the sensors [V/m]
BY_HAND = {"pump_1.mode": 0, "pump_2.mode": 0, "level_1.sp": 6.0, "level_2.sp": 6.0}


@pytest.fixture(scope="module")
def designed():
    return cl.design.lqi_extended_kalman(PLANT)


@cache
def motion(steps, period=1.0):
    """Runge-Kutta, in as many steps as asked for."""
    levels, pumps = ca.SX.sym("levels", 4), ca.SX.sym("pumps", 2)

    def rates(at):
        return PROCESS.dynamics(at, pumps, POINT.disturbances, PROCESS.parameter_values)

    h, moved = period / steps, levels
    for _ in range(steps):
        a = rates(moved)
        b = rates(moved + 0.5 * h * a)
        c = rates(moved + 0.5 * h * b)
        d = rates(moved + h * c)
        moved = moved + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return ca.Function("motion", [levels, pumps], [moved])


def moved_on(levels, pumps, steps):
    return np.array(motion(steps)(levels, pumps)).ravel()


def plant(levels, pumps, samples):
    """The true levels, sample by sample, in steps of a fifth of the filter's."""
    found = [np.asarray(levels, float)]
    for k in range(samples - 1):
        found.append(np.maximum(moved_on(found[-1], pumps(k), 5), 0.0))
    return np.array(found)


def scanned(controller, truth, pumps, noise):
    law = ScannedLaw(controller, 1.0)
    estimates = []
    for k, levels in enumerate(truth):
        shown = SLOPE * levels[:2] + noise[k]
        law.scan(
            **BY_HAND, level_1_pv=shown[0], level_2_pv=shown[1],
            pump_1_manual=pumps(k)[0], pump_2_manual=pumps(k)[1],
        )  # fmt: skip
        estimates.append([law.named[f"tank_{j}.level.state"] for j in range(1, 5)])
    return np.array(estimates), law


def far_pumps(k):
    return np.array([1.8, 3.4]) if k < 150 else np.array([3.4, 1.6])


def test_it_is_the_filter_that_numpy_computes(designed):
    """All measurements at once, Joseph's form, and the exponential of SciPy."""
    values, state = designed.values, designed.initial_state
    random = np.random.default_rng(2)
    noise = 0.05 * random.normal(size=(300, 2))
    truth = plant([0.08, 0.15, 0.03, 0.01], far_pumps, 300)
    found, law = scanned(designed, truth, far_pumps, noise)
    P = np.zeros((4, 4))
    for j in range(4):
        for k in range(j, 4):
            P[j, k] = P[k, j] = state[f"tank_{j + 1}.level.covariance.tank_{k + 1}.level"]
    x = np.array([state[f"tank_{j}.level.estimate"] for j in range(1, 5)])
    V = np.diag([values[f"level_{k}.sensor_noise"] ** 2 for k in (1, 2)])
    intensity = np.diag([values[f"pump_{i}.input_noise"] ** 2 for i in (1, 2)])
    loads = [p.name for p in designed.law.parameters if p.part == "load_noise"]
    assert loads == [f"{each.name}.load_noise" for each in PROCESS.disturbances]
    H = np.hstack([SLOPE * np.eye(2), np.zeros((2, 2))])
    derivatives = Derivatives(PROCESS)
    for k, levels in enumerate(truth):
        y = SLOPE * levels[:2] + noise[k]
        K = P @ H.T @ np.linalg.inv(H @ P @ H.T + V)
        x = x + K @ (y - H @ x)
        left = np.eye(4) - K @ H
        P = left @ P @ left.T + K @ V @ K.T
        assert found[k] == pytest.approx(x, rel=1e-9), k
        pumps = far_pumps(k)
        local = derivatives.at(x, pumps, POINT.disturbances)
        S = local.rates_by_input @ intensity @ local.rates_by_input.T
        sizes = np.array([values[name] for name in loads])
        effects = local.rates_by_disturbance * sizes
        S = S + effects @ effects.T
        held = expm(local.rates_by_state)
        P = held @ P @ held.T + 0.5 * (S + held @ S @ held.T)
        x = moved_on(x, pumps, 1)
    assert law.state["tank_3.level.covariance.tank_4.level"] == pytest.approx(
        P[2, 3], rel=1e-7, abs=1e-15
    )
    assert law.state["tank_4.level.covariance.tank_4.level"] == pytest.approx(P[3, 3], rel=1e-7)


def test_far_from_the_operating_point_it_knows_what_the_linear_one_does_not(designed):
    other = cl.design.lqi_kalman(PLANT, measurements=["level_1", "level_2"])
    truth = plant(POINT.state, far_pumps, 600)
    noise = np.zeros((600, 2))
    extended, _ = scanned(designed, truth, far_pumps, noise)
    law, linear = ScannedLaw(other, 1.0), []
    for k, levels in enumerate(truth):
        pumps = far_pumps(k)
        law.scan(
            **BY_HAND, level_1_pv=SLOPE * levels[0], level_2_pv=SLOPE * levels[1],
            pump_1_manual=pumps[0], pump_2_manual=pumps[1],
        )  # fmt: skip
        linear.append([law.named[f"tank_{j}.level.deviation"] for j in range(1, 5)])
    assert PROCESS.levels == tuple(f"tank_{j}.level" for j in range(1, 5))
    linear = np.array(linear) + POINT.state
    errors = [np.abs(found - truth)[:, 2:].max() for found in (extended, linear)]
    assert errors[0] < 1e-6  # the same equations, and the same start
    assert errors[1] > 0.002  # 2 mm, of levels of some centimetres


def test_a_wrong_start_is_forgotten_and_an_empty_tank_does_no_harm(designed):
    """The pumps stand still until all tanks are empty, then run again."""

    def pumps(k):
        return np.zeros(2) if k < 1200 else np.array([3.0, 3.5])

    truth = plant([0.15, 0.05, 0.1, 0.06], pumps, 2000)
    assert truth[1199].max() < 1e-3
    noise = 0.05 * np.random.default_rng(3).normal(size=(2000, 2))
    found, law = scanned(designed, truth, pumps, noise)
    assert np.isfinite(found).all() and found.min() >= 0.0
    assert all(np.isfinite(value) for value in law.state.values())
    errors = np.abs(found - truth)
    assert errors[0, 2] > 0.05 and errors[1100:1200].max() < 5e-3 and errors[1900:].max() < 5e-3


def test_without_measurements_it_goes_on_by_the_equations_and_its_doubt_is_bounded(designed):
    law = ScannedLaw(designed, 1.0)
    level = POINT.state
    shown = {f"level_{k}.pv": SLOPE * level[k - 1] for k in (1, 2)}
    law.scan(**shown, level_1_sp=shown["level_1.pv"], level_2_sp=shown["level_2.pv"])
    for _ in range(3000):
        law.scan(level_1_good=0.0)
    assert [law.state[f"tank_{j}.level.estimate"] for j in range(1, 5)] == pytest.approx(
        level, rel=1e-6
    )
    spans = [signal.span for signal in PROCESS.state]
    for j, span in enumerate(spans, start=1):
        before = designed.initial_state[f"tank_{j}.level.covariance.tank_{j}.level"]
        assert before < law.state[f"tank_{j}.level.covariance.tank_{j}.level"] <= span**2


@pytest.mark.parametrize("fault", [
    {"level_1.pv": np.nan}, {"level_2.pv": -np.inf}, {"time_step": -1.0},
    {"time_step": np.nan}, {"level_1.pv": 1e300},
])  # fmt: skip
def test_nonsense_leaves_numbers(designed, fault):
    law = ScannedLaw(designed, 1.0)
    for _ in range(5):
        law.scan(**{"level_1.pv": 6.0, "level_2.pv": 6.0, "level_1.sp": 6.0} | fault)
    assert all(np.isfinite(value) for value in law.state.values())


def test_a_controlled_output_has_to_be_measured():
    with refused(remedy="level_2"):
        ExtendedKalman(process_equations(PLANT.linear), ("level_1",), (), 1, 0)
