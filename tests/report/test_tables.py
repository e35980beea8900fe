import io
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from clepsydra import Signal
from clepsydra.report.analysis_answer import analysis_answer
from clepsydra.report.analysis_tables import relative_gain_grid, roots_grid, static_gain_grid
from clepsydra.report.controller_tables import parameter_tables, status_words
from clepsydra.report.html import report_text
from clepsydra.report.score_tables import (
    glossary,
    ranking_columns,
    ranking_rows,
    score_tables,
)
from clepsydra.report.screen import Screen
from clepsydra.studies.result import Standing


def printed(renderable):
    stream = io.StringIO()
    Console(file=stream, width=100, force_terminal=False).print(renderable)
    return stream.getvalue()


def column(result, title):
    place = [entry.title for entry in ranking_columns(result)].index(title)
    return [row.cells[place] for row in ranking_rows(result)]


def test_the_ranking_shows_what_decided_first(result):
    titles = [entry.title for entry in ranking_columns(result)]
    assert titles[:4] == ["setpoint error", "load error", "relative error", "moves"]
    assert column(result, "load error") == ["1.00", "1.30"]
    assert column(result, "relative error") == ["1.00", "1.20"]
    assert column(result, "moves") == ["1.00", "12.50"]


def test_the_ranking_shows_the_worst_signal_in_percent_of_its_range(result):
    first, *others = result.ranking
    noise = {"noise_movement[pump_1]": 0.25, "noise_movement[pump_2]": 0.5}  # of 10 V
    loud = replace(first, scores=first.scores | noise)
    changed = replace(result, ranking=(loud, *others))
    assert column(changed, "noise") == ["5.00", "–"]


def test_one_criterion_needs_no_mean(result):
    alone = tuple(replace(c, criteria={"error": c.mean_error}) for c in result.ranking)
    titles = [entry.title for entry in ranking_columns(replace(result, ranking=alone))]
    assert titles[:2] == ["error", "moves"]


def test_a_standing_is_a_word(result):
    standings = (Standing.NERVOUS, Standing.STABLE, Standing.UNSAFE)
    twins = tuple(replace(result.ranking[0], standing=standing) for standing in standings)
    changed = replace(result, ranking=twins)
    words = ["nervous", "thin margins", "unsafe"]
    assert [row.standing for row in ranking_rows(changed)] == words
    page = report_text(changed)
    assert all(f">{word}</td>" in page for word in words)


def test_beyond_the_third_a_reason_has_no_numbers(result):
    reason = (
        "Robust (max|S| 1.07). Setpoint error 1.78 times the best; 7.85 times the least total "
        "variation. Behind PI: its mean is 34 % larger, most of all by the load error (6.04 "
        "against 3.81)."
    )
    level = "Robust. 1.2 times the least total variation. Level with PI to within 2 %."
    first = result.ranking[0]
    twins = tuple(replace(first, reason=words) for words in (reason,) * 4 + (level, "Unsafe."))
    rows = ranking_rows(replace(result, ranking=twins))
    assert [row.reason for row in rows[:3]] == [reason] * 3
    assert [row.reason for row in rows[3:]] == [
        "Behind PI: its mean is 34 % larger.",
        "Level with PI to within 2 %.",
        "Unsafe.",
    ]


def test_the_glossary_defines_the_scores_that_are_there(result):
    defined = dict(glossary(result))
    assert "three samples in a row" in defined["Settling time, measured"]
    assert "IAE" in defined and "ITAE" not in defined


def test_rows_keep_the_order_and_the_reasons_of_the_study(result):
    rows = ranking_rows(result)
    assert [row.rank for row in rows] == [1, 2]
    assert [row.reason for row in rows] == [entry.reason for entry in result.ranking]


def test_what_has_no_end_is_shown_as_infinite(result):
    never = replace(result.ranking[0], maximum_sensitivity=np.inf)
    changed = replace(result, ranking=(never, *result.ranking[1:]))
    assert column(changed, "max|S|") == ["∞", "1.92"]


def test_scores_carry_the_units_of_their_signal(result):
    outputs, inputs, plant = score_tables(result.process, result.ranking[0])
    assert plant.signals == ()
    units = {title: cells[0][1] for title, _, cells in (*outputs.rows, *inputs.rows)}
    assert units["IAE"] == "V s"
    assert units["ISE"] == "V² s"
    assert units["Rise time"] == "s"
    assert units["Total variation"] == "V"
    assert outputs.signals == ("level_1", "level_2")
    assert inputs.signals == ("pump_1", "pump_2")


def test_scores_of_a_level_in_metres_are_shown_in_centimetres(result):
    process = result.process
    sensors = tuple(
        replace(signal, unit="m", display_unit="cm", high=0.2) for signal in process.measurements
    )
    candidate = replace(
        result.ranking[0],
        scores={"iae[level_1]": 0.5, "ise[level_1]": 0.03, "rise_time[level_1]": 7},
    )
    table, *_ = score_tables(replace(process, measurements=sensors), candidate)
    assert [cells[0] for _, _, cells in table.rows] == [
        ("50.0", "cm s"),
        ("300", "cm² s"),
        ("7.00", "s"),
    ]


def test_parameters_with_an_index_stand_side_by_side(result):
    loops, outputs = parameter_tables(result.ranking[0].controller)
    assert (loops.columns, outputs.columns) == (("level_1", "level_2"), ("pump_1", "pump_2"))
    assert loops.rows + outputs.rows == (
        ("proportional_gain", "V/V", ("3.000", "2.700")),
        ("integral_time", "s", ("30.00", "40.00")),
        ("setpoint_weight", "", ("1.000", "1.000")),
        ("tracking_time", "s", ("30.00", "40.00")),
        ("low_limit", "V", ("0", "0")),
        ("high_limit", "V", ("10.00", "10.00")),
    )


def test_rows_of_a_matrix_stand_together():
    names = ("a.gain.x", "a.gain.y", "a.bias", "b.bias", "b.gain.x", "b.gain.y", "floor")
    controller = SimpleNamespace(
        law=SimpleNamespace(parameters=[Signal(name, "V") for name in names]),
        values={name: float(place) for place, name in enumerate(names)},
    )
    indexed, owned, single = parameter_tables(controller)
    assert indexed.rows == (
        ("a.gain", "V", ("0", "1.000")),
        ("b.gain", "V", ("4.000", "5.000")),
    )
    assert owned.rows == (("bias", "V", ("2.000", "3.000")),)
    assert single.rows == (("floor", "V", ("6.000",)),)


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
        "an input in use is not a number, or the mode is none of manual, automatic, tracking (10 s)"
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
    assert 'class="numbers best"' not in report_text(replace(result, ranking=unsafe))
    assert report_text(result).count('class="numbers best"') == 1


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
    assert "12.26 cm" in text
