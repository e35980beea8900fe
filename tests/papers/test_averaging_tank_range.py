"""What the averaging tank's conclusion says of large steps, and what its rows find."""

import numpy as np
import pytest

from clepsydra.base.signal import path
from clepsydra.papers.averaging_tank import operating_range
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS
from clepsydra.papers.averaging_tank.operating_range import LARGE_STEPS, PERIOD, Step, range_runs
from clepsydra.papers.averaging_tank.range_controllers import (
    KINDS,
    VOLUMES,
    controller_of,
    gains_at,
)

pytestmark = pytest.mark.thorough

VERDICTS = {
    "large steps": "remark",
    "cyclic calculation": "remark",
    "cause of the decline": "remark",
    "gain scheduling": "remark",
    "sampling": "remark",
}


@pytest.fixture(scope="module")
def findings(audited):
    return audited("averaging-tank").experiments["operating-range"]


def test_every_row_has_the_verdict_that_was_found_by_hand(findings):
    assert {row.name: row.verdict for row in findings.rows} == VERDICTS
    (cyclic,) = (row for row in findings.rows if row.name == "cyclic calculation")
    assert "6.20 times with it and 7.62 times without" in cyclic.computed
    # LQI does not decline in every large step.
    declines = [operating_range.decline("outflow", "LQI", step) for step in LARGE_STEPS]
    assert sum(found < 0.02 for found in declines) == 3


def test_the_tank_holds_every_step():
    """C from 5 to 8 kmol/m³ and V from 2 to 4 m³ would end at the rim of the catalogue's tank."""
    largest = max(step.volume for step in LARGE_STEPS)
    for constant in ("outflow", "inflow"):
        for kind in ("PI", "LQI"):
            run = range_runs(constant, kind, [Step(0.6, largest)])
            assert 4.0 < np.max(run["volume"]) < 5.9


def test_figures_show_every_law(findings):
    titles = [figure.title for figure in findings.figures]
    assert len(titles) == 4
    by_size = findings.figures[2]
    assert {curve.label for panel in by_size.panels for curve in panel.curves} == set(KINDS)


def test_the_errors_of_a_small_step_of_v_add_up_to_nothing():
    """An integrator under PI control without limits: a ramp of the input is no steady state."""
    run = range_runs("outflow", "PI", [Step(0.0, 0.001)])
    error = run["volume.setpoint"] - run["volume"]
    assert np.max(np.abs(error)) == pytest.approx(0.002)
    assert np.sum(error) * PERIOD == pytest.approx(0.0, abs=1e-9)


def test_scheduled_laws_have_the_fixed_gains_at_the_equilibrium():
    for law in ("PI", "LQI"):
        fixed = controller_of("outflow", law, PERIOD).values
        scheduled = controller_of("outflow", f"{law}, scheduled", PERIOD).values
        tables = {
            name: [value for key, value in scheduled.items() if key.startswith(f"{name}.")]
            for name in fixed
            if name not in scheduled
        }
        assert tables
        for name, table in tables.items():
            # Both have six digits, of K in %/% or in the units of the law.
            assert table[VOLUMES.index(2.0)] == pytest.approx(fixed[name], rel=1e-5)


def test_recomputed_gains_come_from_the_weights_of_the_document():
    """Sampled ever faster, they come to those of the continuous Riccati equation."""
    feedback, integral = gains_at(COLUMNS[0], 2.0)
    state = controller_of("outflow", "LQI, recomputed", 1e-3).initial_state
    outputs = ("inflow", "inflow.impurity")
    found, summed = (
        np.array([[state[path(path(u, what), by)] for by in names] for u in outputs])
        for what, names in (
            ("feedback", ("tank.impurity", "tank.level")),
            ("integral_gain", ("concentration", "volume")),
        )
    )
    assert found == pytest.approx(feedback, rel=5e-3, abs=1e-6)
    assert summed == pytest.approx(integral, rel=5e-3, abs=1e-6)
