import io
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

import clepsydra as cl
from clepsydra import Signal
from clepsydra.report.analysis_page import analysis_answer
from clepsydra.report.analysis_tables import relative_gain_grid, roots_grid, static_gain_grid
from clepsydra.report.figures import figures_of, performance_words
from clepsydra.report.html import report_text
from clepsydra.report.law_tables import parameter_tables, status_words
from clepsydra.report.score_tables import (
    glossary,
    reasons,
    score_tables,
    tuning_grid,
)
from clepsydra.report.screen import Screen
from clepsydra.report.study_answer import ranking_columns
from clepsydra.studies.result import Standing

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


def printed(renderable):
    stream = io.StringIO()
    Console(file=stream, width=100, force_terminal=False).print(renderable)
    return stream.getvalue()


def column(result, title):
    (found,) = [entry for entry in ranking_columns(result) if entry.title == title]
    return [text for text, _ in found.cells]


def test_the_ranking_shows_what_decided(result):
    assert column(result, "load error, × best") == ["1.00", "1.30"]
    assert column(result, "relative error") == ["1.00", "1.20"]
    assert column(result, "total variation, × least") == ["1.00", "12.5"]


def test_physical_numbers_lead_and_multiples_follow(result):
    titles = [entry.title for entry in ranking_columns(result)]
    assert titles.index("settles") < titles.index("overshoot") < titles.index("relative error")


def test_the_ranking_shows_the_worst_signal_in_percent_of_its_range(result):
    first, *others = result.ranking
    noise = {"noise_movement[pump_1]": 0.25, "noise_movement[pump_2]": 0.5}  # of 10 V
    loud = replace(first, scores=first.scores | noise)
    changed = replace(result, ranking=(loud, *others))
    assert column(changed, "noise") == ["5.0 %", "–"]


def test_signals_of_different_units_are_compared_in_percent_of_their_ranges():
    plant = cl.load(EXAMPLES / "blending-station.toml")
    result = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    level, salinity = (plant.process.signal(name).span for name in ("level", "salinity"))
    told = ((0.1, 0.01), (0.02, 0.2))  # who deviates most in the one, and in the other
    ranking = tuple(
        replace(each, scores={
            "peak_deviation[level]": high * level, "peak_deviation[salinity]": salt * salinity,
        })
        for each, (high, salt) in zip(result.ranking, told, strict=True)
    )  # fmt: skip
    (deviates,) = [
        each
        for each in ranking_columns(replace(result, ranking=ranking))
        if each.title == "deviates"
    ]
    assert deviates.cells == (("10 %", pytest.approx(10)), ("20 %", pytest.approx(20)))
    assert "holds salinity to ±20 g/l (20 % of range)" in performance_words(
        plant.process, ranking[1]
    )


def test_a_level_that_averages_is_not_judged_by_its_setpoint():
    plant = cl.load("equalisation-tank")
    result = cl.study(plant, [cl.design.arrest_time(plant)])
    held = {"settles", "deviates", "overshoot"}
    assert not held & {each.title for each in ranking_columns(result)}
    both = replace(plant.process, controlled=("level", "other"))
    assert held <= {each.title for each in figures_of(both)}


def test_a_column_sorts_by_its_number_and_none_stands_last(result):
    first, *others = result.ranking
    times = {"settling_time[level_1]": 300.0, "settling_time[level_2]": 20.0}
    slow = replace(first, scores=first.scores | times)
    none = {key: value for key, value in first.scores.items() if "settling_time[" not in key}
    changed = replace(result, ranking=(slow, replace(others[0], scores=none)))
    (settles,) = [entry for entry in ranking_columns(changed) if entry.title == "settles"]
    assert settles.cells == (("5.00 min", 300.0), ("–", np.inf))


def test_one_criterion_needs_no_mean(result):
    alone = tuple(replace(c, criteria={"error": c.mean_error}) for c in result.ranking)
    titles = [entry.title for entry in ranking_columns(replace(result, ranking=alone))]
    assert not [title for title in titles if title.startswith("error")]


def test_a_standing_is_a_word(result):
    standings = (Standing.NERVOUS, Standing.STABLE, Standing.UNSAFE)
    twins = tuple(replace(result.ranking[0], standing=standing) for standing in standings)
    page = report_text(replace(result, ranking=twins))
    assert all(f">{word}</td>" in page for word in ("nervous", "thin margins", "unsafe"))


def test_beyond_the_third_a_reason_has_no_numbers(result):
    reason = (
        "Robust (max|S| 1.07). Setpoint error 1.78 times the best; 7.85 times the least total "
        "variation. Behind PI: its mean is 34 % larger, most of all by the load error (6.04 "
        "against 3.81)."
    )
    level = "Robust. 1.2 times the least total variation. As good as PI to within 2 %."
    first = result.ranking[0]
    twins = tuple(replace(first, reason=words) for words in (reason,) * 4 + (level, "Unsafe."))
    found = reasons(twins)
    assert found[:3] == [reason] * 3
    assert found[3:] == [
        "Behind PI: its mean is 34 % larger.",
        "As good as PI to within 2 %.",
        "Unsafe.",
    ]


def test_the_glossary_defines_the_scores_that_are_there(result):
    defined = dict(glossary(result))
    assert "three samples in a row" in defined["Settling time, measured"]
    assert "IAE" in defined and "ITAE" not in defined


def test_what_has_no_end_is_shown_as_infinite(result):
    never = replace(result.ranking[0], maximum_sensitivity=np.inf)
    changed = replace(result, ranking=(never, *result.ranking[1:]))
    assert column(changed, "max|S|") == ["∞", "1.92"]


def test_what_does_not_settle_is_never_settled_in_ranking_and_details(result):
    first = result.ranking[0]
    restless = {"settling_time[level_1]": np.inf, "settling_time[level_2]": 9.0}
    changed = replace(result, ranking=(replace(first, scores=restless),))
    assert column(changed, "settles") == ["never"]
    (table,) = score_tables(result.process, changed.ranking[0])
    assert table.rows == (("Settling time", "never", "9.00 s"),)
    assert "What never settles does not settle within the run." in report_text(changed)


def test_the_bounds_of_a_tuning_are_told_with_their_unit(result):
    tuning = result.ranking[0].tuning
    reached = replace(
        tuning,
        start_scores={"lowest[tank_1.level]": 0.04},
        scores={"lowest[tank_1.level]": 0.05},
    )
    assert tuning_grid(reached, result.process).rows[-1] == (
        "Lowest tank_1.level", "4.00 cm", "5.00 cm"
    )  # fmt: skip


def test_scores_carry_the_units_of_their_signal(result):
    outputs, inputs = score_tables(result.process, result.ranking[0])
    units = {row[0]: row[1].split(" ", 1)[1] for row in (*outputs.rows, *inputs.rows)}
    assert units["IAE"] == "V s"
    assert units["ISE"] == "V² s"
    assert units["Rise time"] == "s"
    assert units["Total variation"] == "V"
    assert outputs.head == ("", "level_1", "level_2")
    assert inputs.head == ("", "pump_1", "pump_2")


def test_scores_of_a_level_in_metres_are_shown_in_centimetres(result):
    process = result.process
    sensors = tuple(
        replace(signal, unit="m", display_unit="cm", high=0.2) for signal in process.measurements
    )
    candidate = replace(
        result.ranking[0],
        scores={"iae[level_1]": 0.5, "ise[level_1]": 0.03, "rise_time[level_1]": 7},
    )
    (table,) = score_tables(replace(process, measurements=sensors), candidate)
    assert [row[1:] for row in table.rows] == [
        ("50.0 cm s", "–"),
        ("300 cm² s", "–"),
        ("7.00 s", "–"),
    ]


def test_parameters_with_an_index_stand_side_by_side(result):
    loops, outputs = parameter_tables(result.ranking[0].controller)
    assert loops.head == ("", "level_1", "level_2", "unit")
    assert outputs.head == ("", "pump_1", "pump_2", "unit")
    assert loops.rows + outputs.rows == (
        ("proportional_gain", "3.000", "2.700", "V/V"),
        ("integral_time", "30.00", "40.00", "s"),
        ("setpoint_weight", "1.000", "1.000", ""),
        ("tracking_time", "30.00", "40.00", "s"),
        ("low_limit", "0", "0", "V"),
        ("high_limit", "10.00", "10.00", "V"),
    )


def test_rows_of_a_matrix_stand_together():
    names = ("a.gain.x", "a.gain.y", "a.bias", "b.bias", "b.gain.x", "b.gain.y", "floor")
    controller = SimpleNamespace(
        law=SimpleNamespace(parameters=[Signal(name, "V") for name in names]),
        values={name: float(place) for place, name in enumerate(names)},
    )
    indexed, owned, single = parameter_tables(controller)
    assert indexed.rows == (("a.gain", "0", "1.000", "V"), ("b.gain", "4.000", "5.000", "V"))
    assert owned.rows == (("bias", "2.000", "3.000", "V"),)
    assert single.rows == (("floor", "6.000", "V"),)


def test_status_words_are_told_with_their_durations(run):
    low, high = (int(np.sum(run.values["pump_1"] == limit)) for limit in (0.0, 10.0))
    assert low and high
    same = run.values | {"pump_2.status": run.values["pump_1.status"]}  # so one sentence says both
    assert status_words(replace(run, values=same)) == [
        "pump_1, pump_2: the mode is automatic (71 min); the output stands at its low limit "
        f"({low} s); the output stands at its high limit ({high} s)"
    ]


def test_status_words_count_samples_of_any_length(run):
    slow = replace(run.scenario, sampling_period=2.5)
    status = np.zeros(run.scenario.samples)
    status[:4] = 1 + 16 + 32
    values = run.values | {"pump_1.status": status, "pump_2.status": 0 * status}
    first, second = status_words(replace(run, scenario=slow, values=values))
    assert first == (
        "pump_1: the mode is automatic (10 s); a sensor that the law needs reports a fault (10 s); "
        "an input in use is not a number, or the mode is not manual, automatic or tracking (10 s)"
    )
    assert second == "pump_2: the mode is manual, nothing else to tell"


def test_a_pair_of_roots_is_one_row(result):
    roots = np.array([2j, -2j, -0.5 + 0.25j, -0.5 - 0.25j])
    times = np.array([np.inf, np.inf, 2.0, 2.0])
    analysis = replace(
        result.analysis, poles=roots, time_constants=times, zeros=np.array([0.0128 + 0j])
    )
    assert roots_grid(analysis).rows == (
        ("poles", "±2.00j", "∞"),
        ("poles", "−0.500 ± 0.250j", "2.00 s"),
        ("zero", "+0.0128", ""),
    )


def test_the_least_bad_is_not_shown_as_the_best(result):
    unsafe = tuple(replace(entry, standing=Standing.UNSAFE) for entry in result.ranking)
    assert ">recommended<" not in report_text(replace(result, ranking=unsafe))
    assert report_text(result).count(">recommended<") == 1


def test_the_analysis_shows_johanssons_relative_gain_and_time_constants(result):
    # λ = γ1 γ2 / (γ1 + γ2 − 1) = 0.42 / 0.3; T = (A / a) √(2 h / g)
    grid = relative_gain_grid(result.analysis)
    assert grid.rows == (
        ("level_1", "● 1.400", "−0.400"),
        ("level_2", "−0.400", "● 1.400"),
    )
    level = result.point.state
    times = np.array([28, 32, 28, 32]) / np.array([0.071, 0.057] * 2) * np.sqrt(2 * level / 9.81)
    shown = [float(row[2].split()[0]) for row in roots_grid(result.analysis).rows[:4]]
    assert shown == pytest.approx(sorted(times, reverse=True), rel=0.005)


def test_static_gains_name_their_units(result):
    grid = static_gain_grid(result.analysis)
    assert grid.head == ("", "pump_1 [V]", "pump_2 [V]")
    # dh/dv at rest: h = (γ k v + …)² / (2 g a²), so dh1/dv1 = 2 h1 γ1 k1 / q1; 0.5 V/cm.
    level, flow = 100 * result.point.state[0], 0.7 * 3.33 * 3 + 0.4 * 3.35 * 3
    assert float(grid.rows[0][1]) == pytest.approx(0.5 * 2 * level * 0.7 * 3.33 / flow, rel=0.005)


def test_the_analysis_fits_100_columns_and_ends_with_what_to_do(result):
    text = printed(Screen(analysis_answer(result.analysis)))
    assert max(len(line) for line in text.splitlines()) <= 100
    assert text.rstrip().splitlines()[-1].startswith("Next: ")
    assert "6.13 V" in text
