"""A cascade that a delayed pump fills: regulator and response, by hand and by SciPy alone.

a_i dh_i/dt = flow in − c √(2 g h_i), c = 0.62 π/4 (45 mm)², and the flow into the first tank is
0.12 l/s a percent of what the pump was told twelve samples before.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm, solve_discrete_are

import clepsydra as cl

FILE = Path(__file__).parents[1] / "docs" / "examples" / "three-tanks-behind-a-pipe.toml"
AREAS = np.array([0.8, 0.6, 0.5])  # [m²]
OUTLET = 0.62 * np.pi / 4 * 0.045**2  # [m²]
GRAVITY = 9.81
GAIN, REST = 0.012, 0.35  # [m³/s] at full speed, share of it
PERIOD, LATE = 4.0, 12  # [s], samples
LEVEL = (GAIN * REST / OUTLET) ** 2 / (2 * GRAVITY)  # [m], of each tank at rest


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


@pytest.fixture(scope="module")
def matrices():
    """Return Φ and Γ of the levels and of what the pump was told 1 to 12 samples before."""
    slope = OUTLET * np.sqrt(GRAVITY / (2 * LEVEL))
    continuous = np.zeros((4, 4))
    continuous[:3, :3] = np.diag(-slope / AREAS) + np.diag(slope / AREAS[1:], -1)
    continuous[0, 3] = GAIN / AREAS[0]
    over = expm(continuous * PERIOD)
    held, moved = np.zeros((3 + LATE, 3 + LATE)), np.zeros((3 + LATE, 1))
    held[:3, :3], held[:3, -1] = over[:3, :3], over[:3, 3]
    held[4:, 3:-1] = np.eye(LATE - 1)
    moved[3, 0] = 1.0
    return held, moved


def names():
    levels = [f"tank_{number}.level" for number in (1, 2, 3)]
    return levels + [f"feed.{4 * k}_s_before" for k in range(1, LATE + 1)]


def test_the_tanks_rest_where_torricelli_says(plant):
    found = plant.analysis.operating_point.as_dict()
    for number in (1, 2, 3):
        assert found[f"tank_{number}.level"] == pytest.approx(LEVEL, rel=1e-9)


def test_the_regulator_is_that_of_the_riccati_equation(plant, matrices):
    """Bryson: a tenth of the range of level_3, and the pump's whole way down."""
    held, moved = matrices
    units = np.array([0.25] * 3 + [0.35] * LATE)
    Phi, Gamma, Q = (
        held * units / units[:, None],
        moved * 0.35 / units[:, None],
        np.zeros_like(held),
    )
    Q[2, 2] = 1.0
    P = solve_discrete_are(Phi, Gamma, Q, np.eye(1))
    scaled = np.linalg.solve(1.0 + Gamma.T @ P @ Gamma, Gamma.T @ P @ Phi)
    left = Phi.T @ P @ Phi - P - Phi.T @ P @ Gamma @ scaled + Q
    assert np.abs(left).max() < 2e-14 * np.abs(P).max()
    gain = 0.35 * scaled / units
    values = cl.design.lqr(plant).values
    found = [values[f"feed.feedback.{name}"] for name in names()]
    assert found == pytest.approx(gain[0], rel=5e-6)  # six digits are kept
    # All has arrived at rest, so the pump's move that lifts level_3 by 1 m costs this much more.
    at_rest = np.linalg.solve(np.eye(len(held)) - held + moved @ gain, moved)
    assert values["feed.precompensator.level_3"] == pytest.approx(1.0 / at_rest[2, 0], rel=5e-6)


@pytest.mark.parametrize("design", [cl.design.lqr, cl.design.lqi_kalman])
def test_no_pipe_is_too_long_and_nothing_is_printed(plant, design, capfd):
    run = cl.simulate(plant, design(plant))
    assert run.scores["offset[level_3]"] == pytest.approx(0.0, abs=1e-4)
    assert capfd.readouterr().err == ""


def test_the_loop_moves_as_scipy_says(plant):
    """The filter by its own matrices, the nonlinear tanks by Radau over each period."""
    controller = cl.design.lqr(plant)
    run = cl.simulate(
        plant, controller, [cl.step("level_3", "10 cm", at="20 s")], duration="20 min"
    )
    values = controller.values
    known = [*names(), "feed.52_s_before", "feed.load"]
    sensors = ["level_1", "level_2", "level_3"]
    held = np.array([[values.get(f"{to}.transition.{of}", 0.0) for of in known] for to in known])
    moved = np.array([values.get(f"{to}.input_effect.feed", 0.0) for to in known])
    shown = np.eye(3, len(known))
    correction = np.array([[values[f"{to}.correction.{of}"] for of in sensors] for to in known])
    feedback = np.array([values[f"feed.feedback.{of}"] for of in known])

    def rates(time, levels, flow):
        out = OUTLET * np.sqrt(2 * GRAVITY * levels)
        return (np.array([flow, out[0], out[1]]) - out) / AREAS

    levels, estimate = np.full(3, LEVEL), np.zeros(len(known))
    told = [REST] * LATE
    expected = []
    for k in range(len(run.time)):
        expected.append(levels)
        estimate = estimate + correction @ (levels - LEVEL - shown @ estimate)
        setpoint = 0.1 if k >= 5 else 0.0
        move = values["feed.precompensator.level_3"] * setpoint - feedback @ estimate
        pump = min(max(REST + move, 0.0), 1.0)
        estimate = held @ estimate + moved * (pump - REST)
        told.append(pump)
        levels = solve_ivp(
            rates, (0.0, PERIOD), levels, "Radau", args=(GAIN * told[k],), rtol=1e-10, atol=1e-12
        ).y[:, -1]
    for place, name in enumerate(sensors):
        found = run.values[f"tank_{place + 1}.level"]
        assert np.abs(found - np.array(expected)[:, place]).max() < 1e-5, name
    assert max(found) - LEVEL > 0.09
