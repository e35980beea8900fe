"""What the rows of the laboratory report tell a reader who has them alone, by second routes."""

import math

import numpy as np
import pytest

from clepsydra.papers.four_tank_laboratory.reach import ENOUGH
from clepsydra.papers.four_tank_laboratory.set_ups import MINIMUM, NON_MINIMUM, SET_UPS
from clepsydra.papers.four_tank_laboratory.simulator import runs

pytestmark = pytest.mark.thorough

A = 15.5179  # cm²
K = np.array([4.32, 3.74])  # cm³/(s V)


@pytest.fixture(scope="module")
def rows(audited):
    return audited("four-tank-laboratory").rows


def row_of(rows, place, name):
    (row,) = [each for each in rows if (each.place, each.name) == (place, name)]
    return row


def test_what_the_digits_of_a_hole_leave_of_its_level(rows):
    """h2 of Table 2 from a2 = 0.1331 ± 0.00005 cm² and 980 cm/s², by (6)."""
    flow = 7.5 * (0.375 * K[1] + 0.625 * K[0])
    low, high = ((flow / area) ** 2 / (2 * 980.0) for area in (0.13315, 0.13305))
    row = row_of(rows, "Table 2", "h2")
    assert f"leaves {low:.2f} to {high:.2f} cm open" in row.reason


def test_no_verdict_hangs_on_what_a_recovery_is(rows):
    """85.75 s: back within 5 % runs reach it from both sides, within 2 % none is as soon."""
    found = runs(NON_MINIMUM, "decentralised", "percent")
    third = len(found.time) // 3
    ends = []
    for band in (0.05, 0.02):
        outside = np.abs(found.levels[0, :, third : 2 * third] / 15.0 - 1.0) > band
        ends.append([found.time[np.flatnonzero(each)[-1]] for each in outside])
    wide, narrow = np.array(ends)
    assert min(np.sum(wide < 85.5), np.sum(wide > 85.5)) >= ENOUGH and narrow.min() > 86.0
    row = row_of(rows, "Table 5", "recovery 1, non-minimum phase")
    assert row.verdict == "remark" and "within 2 % of 15 cm" in row.reason


def test_a_number_at_the_edge_of_the_runs_decides_nothing(rows):
    """27.98 % lies above all runs of one noise, and among the highest ones of the other."""
    for noise, seldom in (("three deviations", {0}), ("one deviation", set(range(1, 7)))):
        found = runs(NON_MINIMUM, "decentralised", "percent", noise=noise).scored("overshoot", 2)
        assert np.sum(found >= 27.975) in seldom
    row = row_of(rows, "Table 5", "overshoot 2, non-minimum phase")
    assert row.verdict == "remark" and "The side of it where fewer runs lie has" in row.reason


def test_no_verdict_hangs_on_the_reading_of_the_noise(rows):
    """A number is reproduced only where both readings of the 30 % leave it open."""
    values = {}
    for noise in ("three deviations", "one deviation"):
        found = runs(NON_MINIMUM, "robust", "percent", noise=noise).scored("overshoot", 2)
        values[noise] = np.quantile(found, (0.025, 0.975), method="nearest")
    # 1.78 % is within one and not within the other.
    assert values["three deviations"][0] < 1.78 < values["three deviations"][1]
    assert values["one deviation"][0] > 1.785
    row = row_of(rows, "Table 6", "overshoot 2, non-minimum phase")
    assert row.verdict == "remark"
    assert "none with the report's holes and 30 % of noise as one deviation" in row.reason


def test_one_gravity_gives_all_printed_digits_of_the_areas(rows):
    """Flows of (22) to (25) by the printed levels: 980 cm/s² for all eight, 981 for three."""
    agree = {979.8: 0, 979.82: 0, 980.0: 0, 980.07: 0, 980.09: 0, 981.0: 0}
    for set_up, places in (
        (MINIMUM, ("(24)", "(24)", "(22)", "(23)")),
        (NON_MINIMUM, ["(25)"] * 4),
    ):
        one, two = 7.5 * K
        g = set_up.split
        for tank, flow in enumerate(
            (g * one + (1 - g) * two, g * two + (1 - g) * one, (1 - g) * two, (1 - g) * one)
        ):
            printed = set_up.holes[tank].text
            for gravity in agree:
                area = flow / math.sqrt(2 * gravity * set_up.levels[tank].number.value)
                agree[gravity] += f"{area:.4f}" == printed
            area = flow / math.sqrt(2 * 980.0 * set_up.levels[tank].number.value)
            row = row_of(rows, places[tank], f"a{tank + 1}, {set_up.phase}")
            assert row.computed == pytest.approx(area, rel=1e-9) and "g = 980 cm/s²" in row.reason
    assert list(agree.values()) == [7, 8, 8, 8, 7, 3]


def test_no_reason_speaks_of_what_the_report_does_not_state(rows):
    tables = [row.reason for row in rows if row.place in ("Table 5", "Table 6")]
    assert all("the course's exercise" in reason and "stated" not in reason for reason in tables)


def test_the_scores_of_a_step_are_named(rows):
    words = {
        "rise": "10 to 90 %",
        "recovery": "within 5 % of 15 cm for good",
        "overshoot": "of the step, up to",
    }
    for row in rows:
        if row.place in ("Table 5", "Table 6"):
            assert words[row.name.split()[0]] in row.reason and "of 128 runs" in row.reason


def test_rows_on_a_run_by_hand_name_the_lesson_and_no_others(rows):
    named = {(row.place, row.name) for row in rows if "--lesson four-tanks" in row.reason}
    assert named == {
        *((f"Table {table}", f"h{tank}, simulation") for table in (3, 4) for tank in (1, 2, 3, 4)),
        *((row.place, row.name) for row in rows if row.place.startswith("Exercise 2.2.2, Fig.")),
        *((row.place, row.name) for row in rows if row.name.startswith(("transient", "level of"))),
    }


def test_a_row_of_table_5_alone_tells_what_was_run(rows):
    """Noise of what and how often, pairs, levels of the model, window, and how far runs spread."""
    row = row_of(rows, "Table 5", "recovery 2, non-minimum phase")
    for words in ("30 % of their flow every 0.05 s", "tank 1 by pump 2 and tank 2 by pump 1",
                  "at 17, 20, 7.5 and 7 cm", "for good, up to the next pour", "have 800 s",
                  "30 % of noise as three standard deviations or one"):  # fmt: skip
        assert words in row.reason
    found = [
        runs(NON_MINIMUM, "decentralised", "percent", noise=noise).scored("recovery", 2)
        for noise in ("three deviations", "one deviation")
    ]
    assert f"{np.min(found):.3g} to {np.max(found):.3g} s within 5 %" in row.reason


def test_the_number_for_both_tanks_names_the_one_out_of_reach(rows):
    """46 s: within 2 % tank 1 needs more in some runs, and tank 2 less in all."""
    longest = [
        [
            np.abs(found.levels[tank - 1, :, tank * third : (tank + 1) * third] / 15.0 - 1.0) > 0.02
            for noise in ("three deviations", "one deviation")
            for holes in ("report", "fitted")
            for found in [runs(MINIMUM, "decentralised", "percent", holes, noise)]
            for third in [len(found.time) // 3]
        ]
        for tank in (1, 2)
    ]
    # Samples of 0.2 s from the pour on.
    one, two = (
        max(np.flatnonzero(outside.any(axis=0))[-1] for outside in tank) for tank in longest
    )
    assert 0.2 * two < 46.0 < 0.2 * one
    row = row_of(rows, "Table 5", "recovery 1/2, minimum phase")
    assert "all 128 runs of tank 2 lie on one side of it" in row.reason


def test_section_2_2_3_shows_the_contrary_of_what_is_to_be_found_there(rows):
    """The balances by plain steps, with the holes of the report: 183 and 81 s to 2 %."""
    settled = {}
    for set_up, volts in ((MINIMUM, (6.6, 3.6)), (NON_MINIMUM, (4.8, 7.35))):
        holes = np.array([hole.number.value for hole in set_up.holes])
        h, levels = np.zeros(4), []
        for _ in range(20000):  # of 0.05 s
            levels.append(h[:2])
            out, (one, two), split = holes * np.sqrt(2 * 981.0 * h), K * volts, set_up.split
            lower = split * one + out[2], split * two + out[3]
            h = h + 0.05 * (np.array([*lower, (1 - split) * two, (1 - split) * one]) - out) / A
        outside = np.abs(np.array(levels) / h[:2] - 1.0) > 0.02
        settled[set_up] = 0.05 * (np.flatnonzero(outside.any(axis=1))[-1] + 1)
    row = row_of(rows, "Exercise 2.2.4", "manual control")
    assert f"minimum phase {settled[MINIMUM]:.0f} or" in row.computed
    assert f"non-minimum phase {settled[NON_MINIMUM]:.0f} s, printed 78 s" in row.computed


def test_the_lag_of_the_diagonal_alone_decides_without_noise_as_well(rows):
    """Peaks of tank 1 by Glover-McFarlane: higher in non-minimum phase, and not by the noise."""
    quiet = {
        (set_up, kind): 100.0 * (found.levels[0, 0, : len(found.time) // 3].max() / 15.0 - 1.0)
        for set_up in SET_UPS
        for kind in ("decentralised", "robust")
        for found in [runs(set_up, kind, "percent", noise="none", lagged="diagonal")]
    }
    one, other = quiet[MINIMUM, "robust"], quiet[NON_MINIMUM, "robust"]
    assert other > one + 1.0
    row = row_of(rows, "Exercise 4.2.3", "overshoot")
    assert row.verdict == "remark"
    assert f"likewise without noise (minimum phase {one:.3g}" in row.reason
    ratios = [quiet[each, "robust"] / quiet[each, "decentralised"] for each in SET_UPS]
    assert ratios[1] > 1.5 * ratios[0]
    row = row_of(rows, "Exercise 4.2.2", "trade of overshoot for rise time")
    assert f"non-minimum phase overshoot × {ratios[1]:.2f}" in row.reason.split("without noise")[1]
