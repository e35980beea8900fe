"""LQI by Bryson's rule against the Riccati equation and closed forms."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from clepsydra.base.errors import InputError
from clepsydra.design.applicability import NotApplicable
from clepsydra.design.bryson import design_lqi
from clepsydra.design.linear_quadratic import lqi_gains


@pytest.mark.parametrize("phase", ["minimum_phase", "nonminimum_phase"])
def test_gains_solve_the_riccati_equation_in_physical_units(phase, request):
    model = request.getfixturevalue(phase).model
    errors, moves, horizon = np.array([0.7, 1.1]), np.array([2.0, 3.0]), 25.0
    gains = lqi_gains(model, errors, moves, horizon)
    A = np.block([[model.A, np.zeros((4, 2))], [model.C, np.zeros((2, 2))]])
    B = np.vstack([model.B, np.zeros((2, 2))])
    Q = np.zeros((6, 6))
    Q[:4, :4] = model.C.T @ np.diag(errors**-2) @ model.C
    Q[4:, 4:] = np.diag((errors * horizon) ** -2)
    R = np.diag(moves**-2)
    P = solve_continuous_are(A, B, Q, R)
    K = np.linalg.solve(R, B.T @ P)
    found = np.hstack([gains.feedback, gains.integral])
    assert found == pytest.approx(K, rel=1e-6, abs=1e-6 * np.abs(K).max() * 1e-3)
    residual = A.T @ P + P @ A - P @ B @ found + Q
    assert np.abs(residual).max() < 1e-7 * np.abs(Q).max()
    poles = np.sort_complex(np.linalg.eigvals(A - B @ found))
    assert np.sort_complex(gains.poles) == pytest.approx(poles, rel=1e-7)
    # Symmetric root locus: the poles are the stable eigenvalues of the Hamiltonian.
    hamiltonian = np.block([[A, -B @ np.linalg.solve(R, B.T)], [-Q, -A.T]])
    stable = np.sort_complex(np.array([p for p in np.linalg.eigvals(hamiltonian) if p.real < 0]))
    assert np.sort_complex(gains.poles) == pytest.approx(stable, rel=1e-6)


def test_one_tank_has_the_closed_form(single_tank):
    # ẋ = −a x + b u, y = c x: with q = c²/ȳ², w = 1/(ȳ T)², r = 1/ū² the integral gain is
    # ū/(ȳ T) and F = (−a + √(a² + b² q/r + 2 b c G))/b.
    a, b, c, error, move, horizon = 0.02, 3e-4, 50.0, 0.8, 2.5, 40.0
    _, model = single_tank([[-a]], [b], [c])
    gains = lqi_gains(model, np.array([error]), np.array([move]), horizon)
    integral = move / (error * horizon)
    assert gains.integral[0, 0] == pytest.approx(integral, rel=1e-9)
    closed = math.sqrt(a**2 + (b * c * move / error) ** 2 + 2 * b * c * integral)
    assert gains.feedback[0, 0] == pytest.approx((closed - a) / b, rel=1e-9)


def johanssons_zeros(tank, gamma_1, gamma_2):
    """Roots of (1 + s T3)(1 + s T4) = (1 − γ1)(1 − γ2)/(γ1 γ2)."""
    ratio = (1 - gamma_1) * (1 - gamma_2) / (gamma_1 * gamma_2)
    return np.roots([tank.T[2] * tank.T[3], tank.T[2] + tank.T[3], 1 - ratio])


@pytest.mark.parametrize("phase", ["minimum_phase", "nonminimum_phase"])
def test_controller_acts_on_measurements_with_the_feedback_of_the_states(phase, request):
    tank = request.getfixturevalue(phase)
    controller = design_lqi(tank.process, tank.model)
    values, at = controller.values, tank.model.point.as_dict()
    horizon = tank.T.max() / 3.0
    if phase == "nonminimum_phase":
        horizon = 1.0 / johanssons_zeros(tank, 0.43, 0.34).max()
        assert horizon == pytest.approx(78.4, abs=0.05)
    voltage = at["pump_1"]
    gains = lqi_gains(tank.model, np.ones(2), np.full(2, voltage), horizon)
    assert controller.measurements == ("level_1", "level_2", "level_3", "level_4")
    for i in (1, 2):
        row = [values[f"feedback_{i}_{j}"] for j in range(1, 5)]
        assert row == pytest.approx(gains.feedback[i - 1] / 50.0, rel=1e-7)
        assert values[f"integral_gain_{i}_1"] == pytest.approx(gains.integral[i - 1, 0], rel=1e-7)
        assert values[f"bias_{i}"] == voltage
        assert values[f"tracking_time_{i}"] == pytest.approx(
            math.hypot(*row[:2]) / math.hypot(*gains.integral[i - 1]), rel=1e-7
        )
    assert [values[f"reference_measurement_{j}"] for j in range(1, 5)] == [
        at[f"level_{j}"] for j in range(1, 5)
    ]


def test_smaller_errors_and_larger_moves_make_it_faster(minimum_phase):
    tank = minimum_phase

    def gain(**options):
        return design_lqi(tank.process, tank.model, **options).values["integral_gain_1_1"]

    usual = gain()
    assert gain(maximum_errors={"level_1": 0.5, "level_2": 0.5}) > 1.9 * usual
    assert gain(maximum_moves={"pump_1": 6.0, "pump_2": 6.0}) > 1.9 * usual


def test_an_unmeasured_state_is_named(minimum_phase):
    tank = minimum_phase
    shown = {k: v for k, v in tank.process.measured_state.items() if k != "level_3"}
    process = dataclasses.replace(tank.process, measured_state=shown)
    with pytest.raises(NotApplicable, match=r"tank_3\.level is not measured"):
        design_lqi(process, tank.model)


def test_outputs_that_cannot_be_held_independently_are_refused(minimum_phase):
    model = minimum_phase.model
    twin = dataclasses.replace(model, B=np.column_stack([model.B[:, 0], 2 * model.B[:, 0]]))
    with pytest.raises(NotApplicable, match="independently"):
        design_lqi(minimum_phase.process, twin)
    single = model.select(inputs=["pump_1"])
    with pytest.raises(NotApplicable, match="1 inputs cannot hold 2 outputs"):
        design_lqi(minimum_phase.process, single)
    spare = model.select(outputs=["level_1"])
    with pytest.raises(NotApplicable, match="2 inputs move 1 controlled outputs"):
        design_lqi(minimum_phase.process, spare)


@pytest.mark.parametrize(
    "options",
    [
        {"maximum_errors": {"level_7": 1.0}},
        {"maximum_errors": {"level_1": 0.0}},
        {"maximum_moves": {"pump_1": math.nan}},
    ],
)
def test_wrong_deviations_are_refused(minimum_phase, options):
    with pytest.raises(InputError):
        design_lqi(minimum_phase.process, minimum_phase.model, **options)
