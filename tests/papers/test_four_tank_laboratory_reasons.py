"""What the rows of the laboratory report tell a reader who has them alone, by second routes."""

import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from clepsydra.papers.audit import audit
from clepsydra.papers.four_tank_laboratory import simulator, step_and_pours
from clepsydra.papers.four_tank_laboratory.reach import ENOUGH, FAR
from clepsydra.papers.four_tank_laboratory.readings import HOLES_IN_WORDS, NOISES
from clepsydra.papers.four_tank_laboratory.set_ups import MINIMUM, NON_MINIMUM, SET_UPS
from clepsydra.papers.four_tank_laboratory.simulator import SEEDS, runs

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[2]

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
    assert row.verdict == "remark" and "to beyond the next pour, all." in row.reason


def test_a_number_at_the_edge_of_the_runs_decides_nothing(rows):
    """27.98 % lies above all runs of one noise, and among the highest ones of the other."""
    found = runs(NON_MINIMUM, "decentralised", "percent").scored("overshoot", 2)
    assert np.all(found < 27.98)
    found = runs(NON_MINIMUM, "decentralised", "percent", noise="one deviation")
    above = np.sum(found.scored("overshoot", 2) >= 27.98)
    assert 0 < above < ENOUGH
    row = row_of(rows, "Table 5", "overshoot 2, non-minimum phase")
    told = f"none with noise as three deviations to {above} with noise as one deviation"
    assert row.verdict == "remark" and told in row.reason


@pytest.mark.parametrize("shift", [100, 600])
def test_no_verdict_hangs_on_the_seed(rows, monkeypatch, shift):
    """Everything again with other noise, by hand and with controllers."""
    simulated = simulator._simulated
    monkeypatch.setattr(
        simulator, "_simulated", lambda *a, seed, **k: simulated(*a, seed=seed + shift, **k)
    )
    caches = (simulator.runs, simulator.by_hand, step_and_pours._scored)
    for each in caches:
        each.cache_clear()
    try:
        others = audit(["four-tank-laboratory"], workers=1).rows
    finally:
        for each in caches:
            each.cache_clear()
    assert [row.reason for row in others] != [row.reason for row in rows]
    assert {(row.place, row.name): row.verdict for row in others} == {
        (row.place, row.name): row.verdict for row in rows
    }


def test_the_rise_of_6_3_s_is_far_from_all_runs(rows):
    """10 to 90 % of the levels of tank 1 by interpolation, the reading that is nearest."""
    found = runs(MINIMUM, "decentralised", "percent", "lower fitted", "one deviation")
    times = []
    for level in found.levels[0, :, : len(found.time) // 3]:
        ends = [np.flatnonzero(level >= share * 15.0)[0] for share in (0.1, 0.9)]
        one, two = (
            np.interp(share * 15.0, level[end - 1 : end + 1], found.time[end - 1 : end + 1])
            for share, end in zip((0.1, 0.9), ends, strict=True)
        )
        times.append(two - one)
    mean, deviation = np.mean(times), np.std(times, ddof=1)
    assert (mean - 6.3) / deviation > FAR
    row = row_of(rows, "Table 5", "rise 1/2, minimum phase")
    assert f"{mean:.3g} ± {deviation:.2g} s with a1 and a2 fitted" in row.reason


def test_upper_holes_that_nothing_fixes_decide_h4_of_table_3(rows):
    """The balances by plain steps with the cut-off and no noise, the upper holes of the report."""
    levels = {}
    for name, upper in (("a1 and a2 fitted", (0.0637, 0.0566)),
                        ("all holes smaller", (0.0548, 0.0487))):  # fmt: skip
        holes, h, runs_on, last = np.array([0.1333, 0.1114, *upper]), np.zeros(4), True, []
        stopped = 0
        for step in range(20000):  # of 0.05 s
            runs_on = h.max() < 27.5 and (runs_on or h.max() <= 27.0)
            out, (one, two) = holes * np.sqrt(2 * 981.0 * h), 7.5 * K * runs_on
            lower = 0.625 * one + out[2], 0.625 * two + out[3]
            h = h + 0.05 * (np.array([*lower, 0.375 * two, 0.375 * one]) - out) / A
            if step >= 15000:
                last.append(h[3])
                stopped += not runs_on
        # What the reason says of the cut-off of level 2.
        assert 0.1 < stopped / len(last) < 0.2
        levels[name] = np.mean(last)
    assert levels["a1 and a2 fitted"] + 1.0 < 22.15 < levels["all holes smaller"] - 1.0
    row = row_of(rows, "Table 3", "h4, simulation")
    assert row.verdict == "remark" and "both pumps stand still for a part of the time" in row.reason
    for name, level in levels.items():
        told = row.reason.partition(f" cm with {name}")[0].split("; ")[-1]
        for each in told.split(" and "):
            assert float(each.split(" ± ")[0]) == pytest.approx(level, abs=0.15)


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
    assert "to all with noise as one deviation and a lag of all of W. " in row.reason


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
        "recovery": "until back for good, up to the next pour",
        "overshoot": "of the step, up to the first pour",
    }
    for row in rows:
        if row.place in ("Table 5", "Table 6"):
            assert words[row.name.split()[0]] in row.reason
            assert "128 runs in each reading" in row.reason


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
                  "17, 20, 7.5 and 7 cm", "for good, up to the next pour", "800 s for the step",
                  "30 % of noise as three standard deviations or one"):  # fmt: skip
        assert words in row.reason
    found = [
        runs(NON_MINIMUM, "decentralised", "percent", noise=noise).scored("recovery", 2)
        for noise in ("three deviations", "one deviation")
    ]
    spread = f"{np.min(found):.3g} to {np.max(found):.3g} s"
    above = [np.sum(each >= 104.8) for each in found]
    told = f"{above[0]} with noise as three deviations to {above[1]} with noise as one deviation"
    assert f"within 5 % of 15 cm {spread}, {told}" in row.reason


def test_a_number_for_both_tanks_may_be_of_the_slower_of_them(rows):
    """46 s: tank 2 is back sooner in all runs, and the slower tank is not with one noise."""
    above = {noise: [] for noise in NOISES}
    for noise, holes in product(NOISES, HOLES_IN_WORDS):
        found = runs(MINIMUM, "decentralised", "percent", holes, noise)
        third = len(found.time) // 3
        outside = np.array([
            np.abs(found.levels[tank - 1, :, tank * third : (tank + 1) * third] / 15.0 - 1.0) > 0.02
            for tank in (1, 2)
        ])  # fmt: skip
        # Samples of 0.2 s from the pour on: later than 46 s outside of the band.
        assert not outside[1, :, 230:].any()
        above[noise].append(int(outside[:, :, 230:].any(axis=(0, 2)).sum()))
    assert not any(above["three deviations"])
    few, many = min(above["one deviation"]), max(above["one deviation"])
    assert ENOUGH < few < many < SEEDS - ENOUGH
    row = row_of(rows, "Table 5", "recovery 1/2, minimum phase")
    assert row.verdict == "remark"
    assert "from the mean of the runs of tank 2 in every reading" in row.reason
    told = (
        f"Of the slower it is not: within 2 % of 15 cm with noise as one deviation {few} to {many} "
        "of 128 runs lie above it and the others below; in all other readings all lie below."
    )
    assert told in row.reason
    page = (ROOT / "docs/papers/four-tank-laboratory.md").read_text("utf-8")
    assert f"with noise as one deviation, {few} to {many} of 128 runs lie above it" in page


def test_every_number_for_both_tanks_is_judged_by_the_slower_as_well(rows):
    """Rises of both tables and recoveries of three cells; that of 6.3 s is far from it too."""
    both = [row for row in rows if " 1/2, " in row.name]
    assert len(both) == 5
    for row in both:
        assert "whether for each or for the slower of them is not said" in row.reason
        assert "; the slower " in row.reason
    found = runs(MINIMUM, "decentralised", "percent", "lower fitted", "one deviation")
    slower = np.max([found.scored("rise", tank) for tank in (1, 2)], axis=0)
    mean, deviation = slower.mean(), slower.std(ddof=1)
    assert (mean - 6.3) / deviation > FAR
    row = row_of(rows, "Table 5", "rise 1/2, minimum phase")
    told = row.reason.partition("Of the slower it is so as well; ")[2]
    assert f"{mean:.3g} ± {deviation:.2g} s with a1 and a2 fitted and noise as one" in told


def test_rows_on_glover_mcfarlane_tell_how_it_is_sampled(rows):
    """By Tustin's rule where the decoupling is; that W is, the test of its diagonal shows."""
    for row in rows:
        if row.place == "Table 6":
            is_by_tustin = "on PI and W sampled by Tustin's rule." in row.reason
            is_a_sum = "on PI as it runs, with a sum over the samples" in row.reason
            is_minimum = row.name.endswith(", minimum phase")
            assert (is_by_tustin, is_a_sum) == (not is_minimum, is_minimum)
    assert not any("Tustin" in row.reason for row in rows if row.place == "Table 5")


def test_section_2_2_3_shows_the_contrary_of_what_is_to_be_found_there(rows):
    """The balances by plain steps, with the holes of the report: 183 and 81 s to 2 %."""
    settled, widely = {}, {}
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
        outside = np.abs(np.array(levels) / h[:2] - 1.0) > 0.05
        widely[set_up] = 0.05 * (np.flatnonzero(outside.any(axis=1))[-1] + 1)
    assert widely[NON_MINIMUM] < widely[MINIMUM]
    row = row_of(rows, "Exercise 2.2.4", "manual control")
    assert f"within 5 % it is {widely[MINIMUM]:.0f}, " in row.reason
    assert f"and {widely[NON_MINIMUM]:.0f} s in non-minimum phase" in row.reason
    assert row.computed.startswith(f"minimum phase {settled[MINIMUM]:.0f}, ")
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


@pytest.mark.parametrize("place", ["Exercise 4.1.2", "Exercise 4.2.3"])
def test_that_the_non_minimum_phase_recovers_later_hangs_on_no_pour(rows, place):
    """After 3, 9 and 12 cm, in either band, by the last sample outside of it."""
    kind = {"Exercise 4.1.2": "decentralised", "Exercise 4.2.3": "robust"}[place]
    for pour, band, tank in product((3.0, 9.0, 12.0), (0.05, 0.02), (1, 2)):
        one, other = (
            found.time[np.flatnonzero(np.abs(level / 15.0 - 1.0) > band)[-1]]
            for set_up in SET_UPS
            for found in [runs(set_up, kind, "percent", noise="none", poured=pour)]
            for third in [len(found.time) // 3]
            for level in [found.levels[tank - 1, 0, tank * third : (tank + 1) * third]]
        )
        assert other > one + 1.0, (pour, band, tank)
    row = row_of(rows, place, "recovery")
    assert row.verdict == "claim holds"
    assert "6.25 cm poured, or without noise 3, 9 and 12 cm), by the printed" in row.reason


def test_no_recovery_is_judged_by_a_pour_that_is_not_printed(rows):
    """Each is a remark, and tells the pour, whose it is, and what others make of it."""
    found = [row for row in rows if row.name.startswith("recovery") and row.place[:5] == "Table"]
    assert len(found) == 5
    for row in found:
        assert row.verdict == "remark"
        assert "6.25 cm (ours; the report prints neither how much nor how fast)" in row.reason
        assert "It hangs on the pour, and mostly grows with it: after 3, 6.25, 9" in row.reason


def test_a_reading_of_a_loop_with_a_decoupling_names_its_lag(rows):
    """Ends of a range of runs, and what is shown, in the non-minimum phase of Table 6 alone."""
    for row in rows:
        if row.place in ("Table 5", "Table 6"):
            has_lag = row.place == "Table 6" and "non-minimum" in row.name
            shown = row.reason.partition("Shown is the median")[2].split(". Readings")[0]
            assert shown.endswith("and a lag of all of W") is has_lag
    row = row_of(rows, "Table 6", "rise 2, non-minimum phase")
    assert (
        "none with noise as three deviations and a lag of W's diagonal alone to all with noise as "
        "three deviations and a lag of all of W;" in row.reason
    )
