"""LQI by Bryson's rule against the Riccati equation and closed forms."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are
from scipy.signal import cont2discrete

from clepsydra import InputError, NotApplicable
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.lqi_by_weights import design_lqi_by_weights
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.states.bryson_rule import bryson_weights
from clepsydra.designs.states.linear_quadratic import lqi_gains


def bryson_gains(model, errors, moves, horizon, period):
    return lqi_gains(model, bryson_weights(model, errors, moves, horizon), period, horizon)


def cost_by_quadrature(model, errors, moves, horizon, period):
    """Return Φ, Γ and the cost of one sample in physical units, by Simpson's rule.

    The states between the samples come from SciPy's hold over parts of the period.
    """
    n, q, m = len(model.A), len(model.C), model.B.shape[1]
    points = 401
    weights = np.ones(points)
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    weights *= period / (points - 1) / 3.0
    zeros = np.zeros((q, m))
    cost = np.zeros((n + q + m, n + q + m))
    for weight, time in zip(weights, np.linspace(0.0, period, points), strict=True):
        held, moved = np.eye(n), np.zeros((n, m))
        if time > 0.0:
            held, moved, *_ = cont2discrete((model.A, model.B, model.C, zeros), time)
        shown = model.C @ np.hstack([held, np.zeros((n, q)), moved])
        cost += weight * shown.T @ np.diag(errors**-2) @ shown
    cost[n : n + q, n : n + q] += period * np.diag((errors * horizon) ** -2)
    cost[n + q :, n + q :] += period * np.diag(moves**-2)
    A = np.block([[held, np.zeros((n, q))], [period * model.C, np.eye(q)]])
    B = np.vstack([moved, zeros])
    return A, B, cost


@pytest.mark.parametrize("period", [1.0, 30.0, 100.0])
@pytest.mark.parametrize("phase", ["minimum_phase", "nonminimum_phase"])
def test_gains_solve_the_riccati_equation_in_physical_units(phase, period, request):
    model = request.getfixturevalue(phase).model
    errors, moves, horizon = np.array([0.7, 1.1]), np.array([2.0, 3.0]), 25.0
    gains = bryson_gains(model, errors, moves, horizon, period)
    A, B, cost = cost_by_quadrature(model, errors, moves, horizon, period)
    Q, N, R = cost[:6, :6], cost[:6, 6:], cost[6:, 6:]
    # Value iteration, which needs no solver: P of ever more samples to go.
    P = Q
    for _ in range(20_000):
        K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A + N.T)
        following = Q + A.T @ P @ A - (A.T @ P @ B + N) @ K
        settled = np.abs(following - P).max() < 1e-13 * np.abs(P).max()
        P = following
        if settled:
            break
    assert settled
    found = np.hstack([gains.feedback, gains.integral])
    assert found == pytest.approx(K, rel=1e-6, abs=1e-8 * np.abs(K).max())
    eigenvalues = np.sort_complex(np.linalg.eigvals(A - B @ found))
    assert np.sort_complex(gains.eigenvalues) == pytest.approx(eigenvalues, abs=1e-6)


def test_one_tank_sampled_fast_has_the_closed_form_of_continuous_lqi(single_tank):
    # ẋ = −a x + b u, y = c x: with q = c²/ȳ², w = 1/(ȳ T)², r = 1/ū² the integral gain is
    # ū/(ȳ T) and F = (−a + √(a² + b² q/r + 2 b c G))/b.
    a, b, c, error, move, horizon = 0.02, 3e-4, 50.0, 0.8, 2.5, 40.0
    model = single_tank([[-a]], [b], [c])
    integral = move / (error * horizon)
    closed = math.sqrt(a**2 + (b * c * move / error) ** 2 + 2 * b * c * integral)
    limits = np.array([(closed - a) / b, integral])

    def found(period):
        gains = bryson_gains(model, np.array([error]), np.array([move]), horizon, period)
        return np.array([gains.feedback[0, 0], gains.integral[0, 0]])

    distances = np.array([np.abs(found(period) / limits - 1) for period in (0.4, 0.2, 0.1, 0.05)])
    # Of first order in the period: half the period, half the distance.
    assert np.all(np.abs(distances[:-1] / distances[1:] - 2.0) < 0.05)
    assert np.all(distances[-1] < 2e-3)
    extrapolated = 2 * found(0.005) - found(0.01)
    assert extrapolated == pytest.approx(limits, rel=1e-6)


@pytest.mark.parametrize("phase", ["minimum_phase", "nonminimum_phase"])
def test_sampled_fast_the_gains_tend_to_continuous_lqi(phase, request):
    model = request.getfixturevalue(phase).model
    errors, moves, horizon = np.array([0.7, 1.1]), np.array([2.0, 3.0]), 25.0
    A = np.block([[model.A, np.zeros((4, 2))], [model.C, np.zeros((2, 2))]])
    B = np.vstack([model.B, np.zeros((2, 2))])
    Q = np.zeros((6, 6))
    Q[:4, :4] = model.C.T @ np.diag(errors**-2) @ model.C
    Q[4:, 4:] = np.diag((errors * horizon) ** -2)
    R = np.diag(moves**-2)
    P = solve_continuous_are(A, B, Q, R)
    K = np.linalg.solve(R, B.T @ P)
    distances = []
    for period in (0.1, 0.05, 0.025):
        gains = bryson_gains(model, errors, moves, horizon, period)
        found = np.hstack([gains.feedback, gains.integral])
        distances.append(np.linalg.norm(found - K) / np.linalg.norm(K))
    assert np.abs(np.divide(distances[:-1], distances[1:]) - 2.0).max() < 0.05
    assert distances[-1] < 0.01


def johanssons_zeros(tank, gamma_1, gamma_2):
    """Roots of (1 + s T3)(1 + s T4) = (1 − γ1)(1 − γ2)/(γ1 γ2)."""
    ratio = (1 - gamma_1) * (1 - gamma_2) / (gamma_1 * gamma_2)
    return np.roots([tank.T[2] * tank.T[3], tank.T[2] + tank.T[3], 1 - ratio])


@pytest.mark.parametrize("phase", ["minimum_phase", "nonminimum_phase"])
def test_controller_acts_on_measurements_with_the_feedback_of_the_states(phase, request):
    tank = request.getfixturevalue(phase)
    controller = design_lqi(tank.model)
    values, at = controller.values, tank.model.point.as_dict()
    horizon = tank.T.max() / 3.0
    if phase == "nonminimum_phase":
        horizon = 1.0 / johanssons_zeros(tank, 0.43, 0.34).max()
        assert horizon == pytest.approx(78.4, abs=0.05)
    voltage = at["pump_1"]
    gains = bryson_gains(tank.model, np.ones(2), np.full(2, voltage), horizon, 1.0)
    assert controller.measurements == ("level_1", "level_2", "level_3", "level_4")
    for i in (1, 2):
        row = [values[f"pump_{i}.feedback.level_{j}"] for j in range(1, 5)]
        assert row == pytest.approx(gains.feedback[i - 1] / 50.0, rel=1e-7)
        assert values[f"pump_{i}.integral_gain.level_1"] == pytest.approx(
            gains.integral[i - 1, 0], rel=1e-7
        )
        assert values[f"pump_{i}.bias"] == voltage
        assert values[f"pump_{i}.tracking_time"] == pytest.approx(
            math.hypot(*row[:2]) / math.hypot(*gains.integral[i - 1]), rel=1e-7
        )
    assert [values[f"level_{j}.reference"] for j in range(1, 5)] == [
        at[f"level_{j}"] for j in range(1, 5)
    ]


def test_smaller_errors_and_larger_moves_make_it_faster(minimum_phase, sampled_at):
    # Sampled fast, twice the ratio of move to error makes twice the integral gain.
    model = sampled_at(minimum_phase.model, 0.01)

    def gain(**options):
        return design_lqi(model, **options).values["pump_1.integral_gain.level_1"]

    usual = gain()
    assert gain(maximum_errors={"level_1": 0.5, "level_2": 0.5}) == pytest.approx(
        2 * usual, rel=2e-3
    )
    assert gain(maximum_moves={"pump_1": 6.0, "pump_2": 6.0}) == pytest.approx(2 * usual, rel=2e-3)


def test_an_unmeasured_state_is_named(minimum_phase):
    tank = minimum_phase
    shown = {k: v for k, v in tank.process.measured_state.items() if k != "level_3"}
    process = dataclasses.replace(tank.process, measured_state=shown)
    model = dataclasses.replace(
        tank.model, point=dataclasses.replace(tank.model.point, process=process)
    )
    with pytest.raises(NotApplicable, match=r"tank_3\.level is not measured"):
        design_lqi(model)


def test_outputs_that_cannot_be_held_independently_are_refused(minimum_phase):
    model = minimum_phase.model
    twin = dataclasses.replace(model, B=np.column_stack([model.B[:, 0], 2 * model.B[:, 0]]))
    with pytest.raises(NotApplicable, match="independently"):
        design_lqi(twin)
    single = model.select(inputs=["pump_1"])
    with pytest.raises(NotApplicable, match="1 inputs cannot hold 2 outputs"):
        design_lqi(single)
    spare = model.select(outputs=["level_1"])
    with pytest.raises(NotApplicable, match="2 inputs move 1 controlled outputs"):
        design_lqi(spare)


@pytest.mark.parametrize(
    ("options", "place", "value"),
    [
        ({"maximum_errors": {"level_7": 1.0}}, "LQI, maximum_errors", "level_7"),
        ({"maximum_errors": {"level_1": 0.0}}, "LQI, maximum_errors, level_1", "0.0"),
        ({"maximum_errors": {"level_1": "a"}}, "LQI, maximum_errors, level_1", "a"),
        ({"maximum_errors": 0.5}, "LQI, maximum_errors", "0.5"),
        ({"maximum_moves": {"pump_1": math.nan}}, "LQI, maximum_moves, pump_1", "nan"),
        ({"maximum_moves": {"pump_1": None}}, "LQI, maximum_moves, pump_1", "None"),
        ({"anti_windup": "clamping"}, "LQI, anti_windup", "clamping"),
        ({"anti_windup": "off"}, "LQI, anti_windup", "off"),
    ],
)
def test_wrong_deviations_are_refused(minimum_phase, options, place, value):
    with pytest.raises(InputError) as caught:
        design_lqi(minimum_phase.model, **options)
    assert (caught.value.place, str(caught.value.value)) == (place, value)


@pytest.mark.parametrize("period", [1e-3, 0.1, 10.0, 30.0, 60.0, 300.0, 5000.0])
def test_the_law_in_the_loop_has_the_eigenvalues_of_the_design(minimum_phase, period, sampled_at):
    """The law is the optimal one and no approximation of it, however slow the sampling."""
    model = sampled_at(minimum_phase.model, period)
    horizon = minimum_phase.T.max() / 3.0
    weights = bryson_weights(model, np.ones(2), np.full(2, 3.0), horizon)
    controller = design_lqi_by_weights(model, weights)
    shown = dataclasses.replace(
        model, C=50.0 * np.eye(4), D=np.zeros((4, 2)), outputs=controller.measurements
    )
    loop = sampled_loop(controller, shown)
    gains = bryson_gains(model, np.ones(2), np.full(2, 3.0), horizon, period)
    # The law keeps one integrator for each input, as the design does for each output.
    assert np.sort(np.abs(np.linalg.eigvals(loop.A))) == pytest.approx(
        np.sort(np.abs(gains.eigenvalues)), abs=1e-6
    )
    assert loop.is_stable
    assert f"sensitivity peak {loop.maximum_sensitivity:.2f}." in controller.design
    # Sampled slowly the optimal loop is not robust, and the design by Bryson's rule slows it.
    robust, optimal = sampled_loop(design_lqi(model), shown), loop.maximum_sensitivity
    if optimal > 2.0:
        assert 1.99 < robust.maximum_sensitivity <= 2.0
    else:
        assert robust.maximum_sensitivity == pytest.approx(optimal, rel=1e-6)
