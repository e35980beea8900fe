"""ISEG of the averaging tank: the row beside another solver, without our own loops."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def rows(audited):
    return {
        row.name: row for row in audited("averaging-tank").experiments["generalised-error"].rows
    }


def test_every_row_has_the_verdict_that_was_found_by_hand(rows):
    assert {name: row.verdict for name, row in rows.items()} == {
        # By (79e) with the derivative of the step, and without it.
        "ISEG of PID control": "remark",
    }


def squares(flows, inlet, horizon, weight):
    """∫ (e² + weight (dy/dt)²) of C and V with f_in constant, by a solver for stiff equations."""

    def slope(t, x):
        errors = np.array([5.25 - x[0], 2.1 - x[1]])
        rates = np.array([0.2 / x[1] * (inlet(x, errors) - x[0]), 0.2 - flows(x, errors)])
        return *rates, *errors, *(errors**2 + weight * rates**2)

    start = [5.0, 2.0, *np.zeros(4)]
    found = solve_ivp(slope, (0.0, horizon), start, "Radau", rtol=1e-8, atol=1e-11, max_step=0.01)
    return found.y[4:, -1]


@pytest.mark.parametrize(("gain", "of_c"), [(50.0, 0.0837), (10.0 * 2.0**0.5, 0.0442)])
def test_what_the_control_adds_to_iseg(rows, gain, of_c):
    """(82), and K_pC = 10 √2, whose C goes to its setpoint with √0.5 s: 0.5^0.5 · 0.25²."""
    found = squares(
        lambda x, errors: np.clip(0.2 - 5.0 * (errors[1] + x[3] / 30.0), 0.0, 1.0),
        lambda x, errors: 5.0 + gain * (errors[0] + x[2] / 10.0),
        20.0,
        0.5,
    )
    assert found == pytest.approx([of_c, 0.0098], abs=5e-5)
    row = rows["ISEG of PID control"]
    assert f"{of_c:.4f}" in row.reason and f"{156.25 + of_c:.2f}" in row.computed
    assert row.computed.endswith("V 25.01")
    assert of_c > 0.5**0.5 * 0.25**2
