"""Recomputed LQI: its matrices, its gains at a frozen state, and its guards."""

import casadi as ca
import numpy as np
import pytest
from scan_rig import ScannedLaw, at_rest
from scipy.linalg import expm, solve_discrete_are

import clepsydra as cl
from clepsydra.controllers.blocks.sampled_matrices import (
    doublings_for,
    held_matrix,
)
from clepsydra.linear.linearise import Derivatives


@pytest.fixture(scope="module")
def controller():
    return cl.design.recomputed_lqi(cl.load("quadruple-tank"))


def as_numbers(expression):
    return np.array(ca.evalf(ca.densify(expression)))


#: Stiff, coupled and oscillating.
A = np.array([[-1.5, 0.4, 0.0], [-0.4, -0.1, 0.2], [0.0, 0.3, -3.0]])


@pytest.mark.parametrize("period", [0.01, 0.7, 6.0])
def test_a_held_matrix_is_the_exponential(period):
    doublings = doublings_for(float(np.linalg.norm(A, 1)) * period)
    found = as_numbers(held_matrix(ca.SX(A), ca.SX(period), doublings))
    assert found == pytest.approx(expm(A * period), rel=1e-9, abs=1e-11)


def test_at_rest_nothing_moves(controller):
    law = ScannedLaw(controller, 1.0)
    for _ in range(50):
        outputs = law.scan(**at_rest(controller, controller.plant))
    assert outputs["pump_1.out"] == pytest.approx(3.0, abs=1e-9)
    for name, value in controller.initial_state.items():
        # Weights and first gains have six digits each.
        assert law.state[name] == pytest.approx(value, rel=1e-5, abs=1e-9), name


@pytest.mark.parametrize(
    ("levels", "period"), [((8.0, 3.0, 1.0, 4.0), 1.0), ((2.0, 9.0, 5.0, 0.5), 2.0)]
)
def test_at_a_frozen_state_the_gains_come_to_those_of_the_stationary_regulator(
    controller, levels, period
):
    """By hand the pumps stand at 4 and 1 V; the levels [V] are anything."""
    law = ScannedLaw(controller, period)
    hand = {"pump_1.mode": 0, "pump_2.mode": 0, "pump_1.manual": 4.0, "pump_2.manual": 1.0}
    shown = {f"level_{k}.pv": value for k, value in enumerate(levels, start=1)}
    for _ in range(2500):
        law.scan(**hand, **shown, level_1_sp=6.0, level_2_sp=6.0)
    at = np.array([levels[controller.measurements.index(f"level_{k}")] for k in range(1, 5)]) / 50
    point = controller.plant.point
    local = Derivatives(point.process).at(at, np.array([4.0, 1.0]), point.disturbances)
    A, B, C = local.rates_by_state, local.rates_by_input, local.measured_by_state[:2]
    errors, moves, horizon = (
        np.array([controller.values[f"level_{k}.largest_error"] for k in (1, 2)]),
        np.array([controller.values[f"pump_{k}.largest_move"] for k in (1, 2)]),
        controller.values["level_1.horizon"],
    )
    both = np.zeros((6, 6))
    both[:4, :4], both[:4, 4:] = A, B
    S = np.diag([0.0] * 4 + list(moves**-2.0))
    S[:4, :4] = C.T @ np.diag(errors**-2.0) @ C
    block = expm(period * np.block([[-both.T, S], [np.zeros((6, 6)), both]]))
    whole = block[6:, 6:]
    W = whole.T @ block[:6, 6:] / period
    held = np.block([[whole[:4, :4], np.zeros((4, 2))], [period * C, np.eye(2)]])
    moved = np.vstack([whole[:4, 4:], np.zeros((2, 2))])
    Q = np.diag([0.0] * 4 + list((errors * horizon) ** -2.0))
    Q[:4, :4] = W[:4, :4]
    N = np.vstack([W[:4, 4:], np.zeros((2, 2))])
    P = solve_discrete_are(held, moved, Q, W[4:, 4:], s=N)
    K = np.linalg.solve(W[4:, 4:] + moved.T @ P @ moved, moved.T @ P @ held + N.T)
    found = np.array(
        [[law.state[f"pump_{i}.feedback.tank_{j}.level"] for j in range(1, 5)] for i in (1, 2)]
    )
    summed = np.array(
        [[law.state[f"pump_{i}.integral_gain.level_{j}"] for j in (1, 2)] for i in (1, 2)]
    )
    assert found == pytest.approx(K[:, :4], rel=1e-9, abs=1e-9 * np.abs(K[:, :4]).max())
    assert summed == pytest.approx(K[:, 4:], rel=1e-9, abs=1e-9 * np.abs(K[:, 4:]).max())
    # And they are others than at the operating point.
    start = controller.initial_state
    before = np.array(
        [[start[f"pump_{i}.feedback.tank_{j}.level"] for j in range(1, 5)] for i in (1, 2)]
    )
    assert np.max(np.abs(found - before)) > 0.02 * np.abs(before).max()


def test_gains_that_change_move_no_output(controller):
    """At errors of zero and levels that stand, the gains converge and the pumps stand still."""
    law = ScannedLaw(controller, 1.0)
    shown = {"level_1.pv": 8.0, "level_2.pv": 3.0, "level_3.pv": 1.0, "level_4.pv": 4.0}
    first = law.scan(**shown, level_1_sp=8.0, level_2_sp=3.0)
    gains = []
    for _ in range(300):
        outputs = law.scan(**shown)
        gains.append(law.state["pump_1.feedback.tank_1.level"])
        for i in (1, 2):
            assert outputs[f"pump_{i}.out"] == pytest.approx(first[f"pump_{i}.out"], abs=1e-9)
    assert max(gains) - min(gains) > 1e-3 * abs(gains[0])


@pytest.mark.parametrize("fault", [
    {"level_3.good": 0.0}, {"level_2.pv": np.nan}, {"level_1.sp": np.inf}, {"time_step": 0.0},
])  # fmt: skip
def test_a_fault_leaves_gains_and_cost(controller, fault):
    law = ScannedLaw(controller, 1.0)
    law.scan(**at_rest(controller, controller.plant) | {"level_1.pv": 8.0})
    before = dict(law.state)
    law.scan(**fault)
    for name, value in before.items():
        if any(part in name for part in (".cost.", ".feedback.", ".integral_gain.")):
            assert law.state[name] == value
    assert law.named["gains_recomputed"] == 0.0


def test_lost_definiteness_leaves_gains_and_cost():
    controller = cl.design.recomputed_lqi(cl.load("averaging-tank"))
    law = ScannedLaw(controller, 0.1)
    law.state |= {f"{x}.cost.{x}": -1e6 for x in ("tank.level", "tank.impurity")}
    assert set(law.state) == set(controller.initial_state)
    before = dict(law.state)
    law.scan(**at_rest(controller, controller.plant))
    for name, value in before.items():
        if ".cost." in name or ".feedback." in name:
            assert law.state[name] == value
