"""What the averaging tank's conclusion says of large steps, and what its rows find."""

import numpy as np
import pytest

from clepsydra.papers.averaging_tank import operating_range
from clepsydra.papers.averaging_tank.lqi import COLUMNS
from clepsydra.papers.averaging_tank.operating_range import PERIOD, Step, range_run
from clepsydra.papers.averaging_tank.range_controllers import KINDS, controller_of, gains_at

pytestmark = pytest.mark.thorough

FAILS = {
    "PI, f_in constant, cause of the decline",
    "LQI, f_in constant, cause of the decline",
    "PI, scheduled, f_out constant",
    "LQI, scheduled, f_out constant",
    "LQI, recomputed, f_out constant",
    "PI, scheduled, f_in constant",
    "LQI, scheduled, f_in constant",
    "LQI, recomputed, f_in constant",
    "PI optimal, f_out constant, sampling",
    "LQI optimal, f_out constant, sampling",
    "PI optimal, f_in constant, sampling",
}
HOLDS = {
    *(f"{law}, f_{flow} constant, large steps" for law in ("PI", "LQI") for flow in ("out", "in")),
    "PI, f_out constant, cause of the decline",
    "LQI, f_out constant, cause of the decline",
    "PI by hand, f_out constant, sampling",
    "LQI by hand, f_out constant, sampling",
    "PI by hand, f_in constant, sampling",
    "LQI by hand, f_in constant, sampling",
    "LQI optimal, f_in constant, sampling",
    "PI by hand, actuators and transport delay",
    "LQI by hand, actuators and transport delay",
}


@pytest.fixture(scope="module")
def findings():
    return operating_range.run()


def test_every_claim_has_the_verdict_that_was_found_by_hand(findings):
    verdicts = {row.name: row.verdict for row in findings.rows}
    assert {name for name, verdict in verdicts.items() if verdict == "claim fails"} == FAILS
    assert {name for name, verdict in verdicts.items() if verdict == "claim holds"} == HOLDS


def test_figures_show_every_law(findings):
    titles = [figure.title for figure in findings.figures]
    assert len(titles) == 4
    by_size = findings.figures[2]
    assert {curve.label for panel in by_size.panels for curve in panel.curves} == set(KINDS)


def test_the_errors_of_a_small_step_of_v_add_up_to_nothing():
    """An integrator under PI control without limits: a ramp of the input is no steady state."""
    run = range_run("outflow", "PI", Step(0.0, 0.001))
    error = run["volume.setpoint"] - run["volume"]
    assert np.max(np.abs(error)) == pytest.approx(0.002)
    assert np.sum(error) * PERIOD == pytest.approx(0.0, abs=1e-9)


def test_scheduled_laws_have_the_fixed_gains_at_the_equilibrium():
    for law in ("PI", "LQI"):
        fixed = controller_of("outflow", law, PERIOD).values
        scheduled = controller_of("outflow", f"{law}, scheduled", PERIOD).values
        place = [scheduled[f"schedule_point_{k}"] for k in range(1, 6)].index(2.0) + 1
        for name, value in scheduled.items():
            if name.endswith(f"_at_{place}"):
                assert value == pytest.approx(fixed[name.removesuffix(f"_at_{place}")], rel=1e-9)


def test_recomputed_gains_come_from_the_weights_of_the_document():
    """Sampled ever faster, they come to those of the continuous Riccati equation."""
    feedback, integral = gains_at(COLUMNS[0], 2.0)
    state = controller_of("outflow", "LQI, recomputed", 1e-3).initial_state
    order = {"volume": 1, "concentration": 2}  # states: level, impurity
    found = np.array([[state[f"feedback_{i}_{order[n]}"] for n in ("concentration", "volume")]
                      for i in (1, 2)])  # fmt: skip
    summed = np.array([[state[f"integral_gain_{i}_{j}"] for j in (1, 2)] for i in (1, 2)])
    assert found == pytest.approx(feedback, rel=5e-3, abs=1e-6)
    assert summed == pytest.approx(integral, rel=5e-3, abs=1e-6)
