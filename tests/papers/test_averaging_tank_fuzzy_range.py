"""Fuzzy control at large steps and at long scans, beside the document's tables in NumPy alone."""

import numpy as np
import pytest
from plain_fuzzy import stepped

from clepsydra.papers.averaging_tank import fuzzy_range
from clepsydra.papers.averaging_tank.fuzzy import FILTERED, LITERAL, fuzzy_run
from clepsydra.papers.averaging_tank.operating_range import LARGE_STEPS, Step

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def rows(audited):
    return {row.name: row for row in audited("averaging-tank").experiments["fuzzy-range"].rows}


def test_both_are_remarks(rows):
    """Neither the steps nor the execution period is printed."""
    assert {name: row.verdict for name, row in rows.items()} == {
        "fuzzy control, large steps": "remark",
        "fuzzy control in a PLC": "remark",
    }


@pytest.mark.parametrize("reading", [FILTERED, LITERAL], ids=["2 ms", "no filter"])
@pytest.mark.parametrize("scan", [0.01, 0.02])
def test_a_scan_by_the_tables_alone(rows, reading, scan):
    """Mamdani's inference in plain NumPy, and the tank solved exactly between its moves."""
    C, V, inflow, outflow, _ = stepped((0.25, 0.1), scan, 10.0, reading.filter_time)
    run = fuzzy_run(reading, horizon=10.0, period=scan)
    # Rounding moves a limit cycle little by little: the same at first, and the same range.
    early = slice(0, 50)
    assert run.values["inflow"][early] == pytest.approx(inflow[early], abs=1e-9)
    assert run.values["outflow"][early] == pytest.approx(outflow[early], abs=1e-9)
    end = np.arange(len(V)) * scan > 8.0
    errors = 400.0 * np.max(np.abs(C[end] - 5.25)), 1000.0 * np.max(np.abs(V[end] - 2.1))
    found = fuzzy_range.rest_of(run)
    assert found == pytest.approx((*errors, inflow[end].min(), inflow[end].max()), rel=0.05)
    assert found[1] > 2.0  # % of its step
    if reading is FILTERED:
        of_c, of_v = (f"{each:.1f} %" for each in found[:2])
        assert f"{1e3 * scan:g} ms: C within {of_c}, V {of_v}" in rows[
            "fuzzy control in a PLC"
        ].computed  # fmt: skip


def test_a_large_step_by_the_tables_alone(rows):
    """One that the row names as worse than under PI control."""
    C, V, *_ = stepped((-2.5, 1.0), 1e-3, 30.0, 2e-3)
    errors = np.trapezoid([np.abs(2.5 - C) / 2.5, np.abs(3.0 - V)], dx=1e-3)
    ours = fuzzy_range.fuzzy_error(FILTERED, Step(-0.5, 0.5))
    assert ours == pytest.approx(errors.mean(), rel=2e-3)
    row = rows["fuzzy control, large steps"]
    assert f"7 of 9 steps; not of {Step(-0.5, 0.5).words}, {ours:.2f} s" in row.computed


def test_the_tank_holds_every_step():
    for step in LARGE_STEPS:
        volume = fuzzy_run(FILTERED, step.sizes, 30.0, 1e-3).true_measurement("volume")
        assert np.min(volume) > 0.9 and np.max(volume) < 4.1


def test_no_remark_hangs_on_the_filter_that_is_not_printed(rows):
    literal = fuzzy_range.large_steps(LITERAL)
    assert literal.computed.startswith("smallest error in 7 of 9 steps")
