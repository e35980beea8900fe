"""The observer that runs the process: against SciPy, and its correction against the matrix."""

import numpy as np
import pytest
from law_function import by_path

import clepsydra as cl

PLANT = cl.load("quadruple-tank")
CORRECTION = 1e-3 * np.array([[4.0, 0.1], [0.2, 3.0], [1.0, 0.5], [-0.3, 0.7]])


@pytest.fixture(scope="module")
def scanned():
    """The law of four tanks with two sensors, and a scan by names."""
    controller = cl.design.feedback_linearisation(PLANT, measurements=["level_1", "level_2"])
    law = controller.law

    def scan(state, correction, **inputs):
        given = {signal.name: signal.initial for signal in law.inputs} | {"time_step": 2.0}
        given |= {"pump_1.mode": 0.0, "pump_2.mode": 0.0} | by_path(law.inputs, inputs)
        numbers = controller.values | {
            f"tank_{j + 1}.level.correction.level_{k + 1}": value
            for (j, k), value in np.ndenumerate(correction)
        }
        start = {entry.name: 0.0 for entry in law.state}
        start |= {f"tank_{k}.level.estimate": x for k, x in enumerate(state, start=1)}
        following, _, _ = law.function(
            list(start.values()), [given[s.name] for s in law.inputs],
            [numbers[p.name] for p in law.parameters],
        )  # fmt: skip
        after = dict(zip(start, np.array(following).ravel(), strict=True))
        return np.array([after[f"tank_{k}.level.estimate"] for k in range(1, 5)])

    return scan


def integrated(state, u, time):
    from scipy.integrate import solve_ivp

    process = PLANT.process
    parameters = process.parameter_values
    run = solve_ivp(
        lambda _, x: np.array(process.dynamics(x, u, np.zeros(2), parameters)).ravel(),
        (0.0, time), state, "DOP853", rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    return run.y[:, -1]


@pytest.mark.parametrize("start", [[0.12, 0.13, 0.02, 0.015], [0.05, 0.01, 0.1, 0.08]])
def test_it_goes_on_as_the_process_does(scanned, start):
    """What is by hand is what it hears of; a step of 2 s of time constants above 20 s."""
    state = np.array(start)
    for u in ([3.0, 3.0], [6.0, 1.0], [0.0, 9.0]):
        found = scanned(
            state, 0.0 * CORRECTION, pump_1_manual=u[0], pump_2_manual=u[1],
            level_1_pv=0.0, level_2_pv=0.0,
        )  # fmt: skip
        expected = integrated(state, u, 2.0)
        assert found == pytest.approx(expected, abs=1e-7)
        # A hundredth of what happened in the step at most.
        assert np.max(np.abs(expected - state)) > 1e-5
        state = expected


def test_a_surprise_corrects_it_by_the_matrix(scanned):
    state, y = np.array([0.12, 0.13, 0.02, 0.015]), np.array([6.3, 6.1])
    hand = {"pump_1.manual": 4.0, "pump_2.manual": 2.0}
    found = scanned(state, CORRECTION, level_1_pv=y[0], level_2_pv=y[1], **hand)
    corrected = state + CORRECTION @ (y - 50.0 * state[:2])
    assert found == pytest.approx(integrated(corrected, [4.0, 2.0], 2.0), abs=1e-8)
    # A sensor that fails surprises nobody.
    failed = scanned(state, CORRECTION, level_1_pv=y[0], level_2_pv=y[1], level_1_good=0.0, **hand)
    assert failed == pytest.approx(integrated(state, [4.0, 2.0], 2.0), abs=1e-8)


def test_an_unusable_time_step_leaves_the_estimate(scanned):
    state = np.array([0.12, 0.13, 0.02, 0.015])
    kept = scanned(state, CORRECTION, pump_1_manual=4.0, level_1_pv=6.3, time_step=0.0)
    assert kept.tolist() == state.tolist()
