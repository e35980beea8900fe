"""Fuzzy control at large steps and at long scans, beside the document's tables in NumPy alone."""

import numpy as np
import pytest
from plain_fuzzy import stepped

from clepsydra.papers.averaging_tank import fuzzy_range
from clepsydra.papers.averaging_tank.fuzzy import FILTERED, LITERAL, fuzzy_loop, fuzzy_run
from clepsydra.papers.averaging_tank.operating_range import LARGE_STEPS, Step, relative_errors
from clepsydra.papers.averaging_tank.step_batch import step_batch

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def rows(audited):
    return {row.name: row for row in audited("averaging-tank").experiments["fuzzy-range"].rows}


def test_all_are_remarks(rows):
    """Neither the steps nor the execution period is printed."""
    assert {name: row.verdict for name, row in rows.items()} == {
        "fuzzy control, large steps": "remark",
        "fuzzy control in a PLC": "remark",
        "LQI away from the equilibrium": "remark",
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


def error_of(step):
    """Mean of IAE over the size of a step, by the tables alone."""
    of_c, of_v = step.sizes
    C, V, *_ = stepped(step.sizes, 1e-3, 30.0, 2e-3)
    both = [(5.0 + of_c - C, of_c), (2.0 + of_v - V, of_v)]
    found = [np.trapezoid(np.abs(error), dx=1e-3) / abs(size) for error, size in both if size]
    return np.mean(found)


def test_large_steps_by_the_tables_alone(rows):
    """One that the row names as worse than under PI control, and one beside its small one."""
    ours = fuzzy_range.fuzzy_errors(FILTERED)
    named = Step(-0.5, 0.5)
    assert ours[named] == pytest.approx(error_of(named), rel=2e-3)
    row = rows["fuzzy control, large steps"].computed
    assert f"7 of 9 steps; not of {named.words}, {ours[named]:.2f} s" in row
    down = Step(-0.5, 0.0)
    ratio = error_of(down) / error_of(down.small)
    assert ours[down] / ours[down.small] == pytest.approx(ratio, rel=5e-3)
    assert ratio == pytest.approx(12.0, abs=0.5)
    ratios = [ours[step] / ours[step.small] for step in LARGE_STEPS]
    assert f"{min(ratios):.1f} to {max(ratios):.1f} times" in row


def test_lqi_has_the_larger_error_but_once(rows):
    row = rows["LQI away from the equilibrium"].computed
    assert row.count("9 of 9") == 3 and "LQI, f_out constant, by hand: 8 of 9" in row
    by_hand = relative_errors("outflow", "LQI")[Step(-0.5, 0.5)]
    assert by_hand < fuzzy_range.fuzzy_errors(FILTERED)[Step(-0.5, 0.5)]


def test_the_tank_holds_every_step():
    controller, model = fuzzy_loop(FILTERED, 1e-3)
    volume = step_batch(controller, model, [s.sizes for s in LARGE_STEPS], 30.0)["volume"]
    assert np.min(volume) > 0.9 and np.max(volume) < 4.1


def test_no_remark_hangs_on_the_filter_that_is_not_printed():
    literal = fuzzy_range.large_steps(LITERAL)
    assert literal.computed.startswith("smallest error in 7 of 9 steps")
    assert fuzzy_range.away_from_equilibrium(LITERAL).computed.count("9 of 9") == 3
