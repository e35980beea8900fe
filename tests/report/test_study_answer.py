"""The answer of a study: its parts, and how they stand on terminals and as Markdown."""

import io
import re
from dataclasses import replace

import pytest
from rich.console import Console

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.report.screen import Screen
from clepsydra.report.study_answer import better_words, lead, study_answer
from clepsydra.studies.recommendation import Recommendation, Remark, recommend
from clepsydra.studies.result import Standing


def screen(result, width, **more):
    stream = io.StringIO()
    Console(file=stream, width=width, force_terminal=False).print(
        Screen(study_answer(result, **more))
    )
    return [line.rstrip() for line in stream.getvalue().splitlines()]


@pytest.mark.thorough
@pytest.mark.parametrize("name", catalogue_names())
def test_a_study_of_every_process_answers_in_a_screen(studied, name):
    found = studied(name)
    for width in (80, 100):
        lines = screen(found, width)
        assert len(lines) <= 24 and max(map(len, lines)) <= width  # one more says what was written
        start = next(k for k, line in enumerate(lines) if line.lstrip().startswith("controller "))
        rows = [*found.ranking[:5]]
        if found.recommended not in rows:
            rows[-1] = found.recommended
        for place, each in enumerate(rows, start=1):  # each in a line of its own
            assert re.match(
                rf"{each.rank} +{re.escape(each.controller.name)} ", lines[start + place]
            )
        assert lines[start + 6].startswith(f"{len(found.ranking) - 5} more")
        assert any(f'--controller "{found.recommended.controller.name}"' in line for line in lines)


@pytest.mark.parametrize("width", [80, 100])
def test_the_answer_fits_a_terminal_and_begins_with_the_verdict(result, width):
    lines = screen(result, width)
    assert len(lines) <= 24 and max(map(len, lines)) <= width  # one more says what was written
    assert " ".join(lines).startswith(result.verdict[:60])


def test_the_settings_of_the_recommended_stand_in_units_of_the_file_and_in_percent(result):
    lines = screen(result, 80)
    (row,) = (line for line in lines if line.startswith("level_1 by pump_1"))
    values = result.ranking[0].controller.values
    gain, time = values["level_1.proportional_gain"], values["level_1.integral_time"]
    assert row.split()[3:] == [f"{gain:.2f}", "V/V", f"{gain:.2f}", f"{time:.1f}", "s", "1"]
    assert any(line.startswith("ISA settings, reverse action ") for line in lines)


def test_loops_that_act_in_different_ways_each_say_how(result):
    first = result.ranking[0]
    values = first.controller.values
    turned = {**values, "level_2.proportional_gain": -values["level_2.proportional_gain"]}
    mixed = replace(first, controller=replace(first.controller, values=turned))
    rows = [
        line.split()
        for line in screen(replace(result, ranking=(mixed,)), 80)
        if re.match("level_. by pump", line)
    ]
    assert [row[-1] for row in rows] == ["reverse", "direct"]
    assert rows[1][3] == f"{values['level_2.proportional_gain']:.2f}"  # without its sign


def test_an_error_is_told_beside_that_of_the_first(result):
    first, second = result.ranking
    assert row_of(result, second)[-2:] == ["1.20", "1.92"]  # its max|S| in the last column
    assert row_of(result, first)[-2:] == ["1.00", "1.62"]


def row_of(result, candidate):
    """The cells of a controller in a table of 100 columns."""
    start = f"{candidate.rank}  {candidate.controller.name}"
    (row,) = (line for line in screen(result, 100) if line.startswith(start))
    return row.removeprefix(start).split()


def test_what_was_slowed_down_says_by_how_much(result):
    first, second = result.ranking
    slow = replace(second, controller=replace(second.controller, slowed=1.952))
    assert row_of(replace(result, ranking=(first, slow)), slow)[0] == "1.95×"


def test_a_best_that_is_no_better_is_not_praised():
    plant = cl.load("quadruple-tank")
    controllers = [cl.design.feedback_linearisation(plant), cl.design.simc(plant)]
    found = cl.study(plant, controllers, accept=6.0)
    best, simplest = found.ranking
    said = " ".join(screen(found, 100))
    assert "The best, Feedback linearisation, has " in said
    alike = replace(simplest, mean_error=1.01 * best.mean_error)
    said = " ".join(screen(replace(found, ranking=(best, alike)), 100))
    assert "Feedback linearisation is first in the ranking, by less than 2 %." in said


def test_columns_that_have_no_room_are_counted_and_stand_below_on_request(result):
    wide, narrow = (
        next(line for line in screen(result, width) if line.lstrip().startswith("controller "))
        for width in (100, 60)
    )
    lost = re.split("  +", wide.strip())[len(re.split("  +", narrow.strip())) :]
    assert lost and f"{len(lost)} columns more: --all" not in "\n".join(screen(result, 100))
    assert f"{len(lost)} columns more: --all" in "\n".join(screen(result, 60))
    lines = screen(result, 60, every=True)
    heads = [line for line in lines if line.lstrip().startswith("controller ")]
    assert len(heads) > 1 and max(map(len, lines)) <= 60 and "--all" not in "\n".join(lines)
    assert all(any(title in head for head in heads) for title in re.split("  +", wide.strip()))
    for each in result.ranking:  # with the name again in each part
        assert sum(
            line.startswith(f"{each.rank}  {each.controller.name}") for line in lines
        ) == len(heads)


def test_every_column_of_the_ranking_is_explained_with_the_reasons(result):
    slow = replace(result.best, controller=replace(result.best.controller, slowed=1.5))
    lines = screen(replace(result, ranking=(slow, *result.ranking[1:])), 1000, why=True)
    head = next(line for line in lines if line.lstrip().startswith("controller "))
    points = " ".join(line for line in lines if line.startswith(" •")).lower()
    titles = [title for title in re.split("  +", head.strip()) if title != "controller"]
    assert "slowed" in titles and all(
        f"• {title.lower()}" in points.replace("•  ", "• ") or f"{title.lower()} is" in points
        for title in titles
    )
    assert "b the setpoint weight" in points and "direct: it falls" in points


def test_columns_go_from_the_right_and_names_stay_whole(result):
    wide, narrow = (
        next(line for line in screen(result, width) if line.lstrip().startswith("controller"))
        for width in (100, 60)
    )
    assert "max|S|" in wide and "max|S|" not in narrow
    assert wide.split()[: len(narrow.split())] == narrow.split()
    long = replace(result.ranking[0].controller, name="State feedback by pole placement, observed")
    longer = replace(result, ranking=(replace(result.ranking[0], controller=long),))
    words = set(re.findall(r"[A-Za-z]+", " ".join(screen(longer, 60))))
    assert {"State", "feedback", "placement", "observed"} <= words


def test_what_to_watch_is_short_and_the_rest_is_counted(result):
    told = (
        Remark("pump_1 stands at a limit", "it is still", "give it more range"),
        Remark("a level spills"),
        Remark("noise"),
        Remark("Drift"),
    )
    far = Remark("It overshoots a step of the setpoint by 34 %", remedy="lower b to 0.5: 9 %")
    first = replace(result.ranking[0], warnings=told, overshoots=(far,))
    lines = screen(replace(result, ranking=(first,), warnings=()), 80)
    assert [line for line in lines if line.startswith(" !")] == [
        " !  It overshoots a step of the setpoint by 34 %.",
        " !  pump_1 stands at a limit.",
        " !  3 more to watch, and what to do: --why.",
    ]
    whole = screen(replace(result, ranking=(first,), warnings=()), 80, why=True)
    assert " !  pump_1 stands at a limit; give it more range." in whole and " !  Drift." in whole
    assert not any("more to watch" in line for line in whole)
    alone = replace(first, warnings=told[:1])
    assert [
        line for line in screen(replace(result, ranking=(alone,), warnings=()), 80) if "!" in line
    ] == [
        " !  It overshoots a step of the setpoint by 34 %; lower b to 0.5: 9 %.",
        " !  pump_1 stands at a limit; give it more range.",
    ]
    assert told[0] in " ".join(screen(replace(result, ranking=(first,)), 100, why=True))


def test_a_scenario_without_a_load_is_told_once_for_all_controllers():
    plant = cl.load("three-tanks")
    controllers = [cl.design.simc(plant), cl.design.amigo(plant)]
    step = [cl.step("level_3", "2 cm", at="1 min")]
    found = cl.study(plant, controllers, step, duration="20 min")
    said = " ".join(screen(found, 100))
    assert "In every run: no load changes in the scenario, so that nothing says how well" in said
    said = " ".join(screen(found, 100, why=True))
    assert said.count("Every controller: No load changes in the scenario") == 1
    assert all(each.warnings == () for each in found.ranking)
    with_load = [*step, cl.step("inflow_3", "10 cm^3/s", at="10 min")]
    (other, _) = cl.study(plant, controllers, with_load, duration="20 min").ranking
    assert other.caveats == ()


def test_the_ranking_is_cut_at_five_and_shown_whole_on_request(result):
    several = tuple(replace(result.ranking[0], rank=rank) for rank in range(1, 9))
    many = replace(result, ranking=several)
    short, whole = "\n".join(screen(many, 80)), "\n".join(screen(many, 80, every=True))
    assert "3 more: --all" in short and not re.search(r"^8 ", short, re.M)
    assert "--all" not in whole and re.search(r"^8 ", whole, re.M)


def test_the_recommended_stands_in_the_last_row_where_it_is_not_among_the_first(result):
    quiet = result.ranking[0]
    several = [replace(quiet, rank=rank, warnings=(Remark("It rings"),)) for rank in range(1, 8)]
    many = replace(result, ranking=(*several, replace(quiet, rank=8)))
    rows = [line[:1] for line in screen(many, 80) if re.match(r"\d  ", line)]
    assert rows == ["1", "2", "3", "4", "8"]


def test_a_best_of_the_same_kind_says_what_there_is_to_watch_with_it(result):
    quiet = replace(result.ranking[0], scores={})
    first = replace(quiet, warnings=(Remark("It rings", "slow it down"),), mean_error=1.0)
    second = replace(quiet, rank=2, mean_error=1.25)
    said = " ".join(screen(replace(result, ranking=(first, second)), 100))
    assert f"The best, {first.controller.title}, has 20 % less error; it rings." in said


def test_a_best_with_nothing_to_watch_says_no_more_than_its_gain(result):
    best = replace(result.ranking[0], scores={}, warnings=(), mean_error=1.0)
    simplest = replace(best, rank=2, mean_error=1.25)
    said = better_words(Recommendation(simplest, best))
    assert said == f"The best, {best.controller.title}, has 20 % less error."


def test_a_best_that_switches_at_levels_says_so():
    plant = cl.load("wet-well:start-stop")
    weak = cl.design.simc(plant).with_values({"level": {"K": "0.05 %/%", "Ti": 3600.0}})
    controllers = [weak, cl.design.start_stop_levels(plant, starts_per_hour=6)]
    load = [cl.step("inflow", "10 l/s", at="5 min")]
    found = cl.study(plant, controllers, load, duration="1 h", accept=9)
    assert found.best.controller.name == "Start/stop levels" != found.recommended.controller.name
    said = " ".join(screen(found, 100))
    assert "less error; it switches at levels, and holds no setpoint" in said
    assert row_of(found, found.best)[-1] == "–"  # it has no max|S|


def test_what_does_not_apply_is_counted_and_named_on_request(result):
    assert any(line.endswith("1 does not apply: --refused") for line in screen(result, 80))
    said = " ".join(screen(result, 80, refused=True))
    assert "Smith predictor does not apply: the process has no dead time" in said


def test_reasons_and_the_rule_come_on_request(result):
    said = " ".join(screen(result, 100, why=True))
    assert result.ranking[1].reason in said and "Order: " in said


def test_on_a_single_loop_the_best_of_all_is_told_from_the_best_pi():
    plant = cl.load("wet-well")
    controllers = [cl.design.pole_placement(plant), cl.design.simc(plant)]
    found = cl.study(plant, controllers)
    said = lead(found, recommend(found.ranking))
    assert said.startswith(
        "The best PI or PID. The best of all, State feedback, pole placement, has "
    )


def test_the_least_bad_is_not_recommended(result):
    unsafe = tuple(replace(entry, standing=Standing.UNSAFE) for entry in result.ranking)
    said = "\n".join(screen(replace(result, ranking=unsafe), 80))
    assert "clepsydra export" not in said and "settings" not in said
    assert "Next: open the report, and change the process or its sampling." in said


def test_a_study_without_any_controller_says_why(result):
    said = screen(replace(result, ranking=(), verdict="No controller applies."), 80)
    assert said[0] == "No controller applies."
    assert any("the process has no dead time" in line for line in said)


def test_a_command_that_is_too_long_can_still_be_copied(result):
    long = replace(result.ranking[0].controller, name="PI with a name " + 3 * "that is long ")
    lines = screen(replace(result, ranking=(replace(result.ranking[0], controller=long),)), 60)
    start = next(k for k, line in enumerate(lines) if line.startswith("Next: "))
    assert lines[start].endswith(" \\") and lines[start + 1].lstrip().startswith("--controller")


def test_names_are_not_read_as_markup(result):
    first = result.ranking[0]
    renamed = replace(first, controller=replace(first.controller, name="[red]P|I[/red]"))
    changed = replace(result, ranking=(renamed,))
    assert "[red]P|I[/red]" in "\n".join(screen(changed, 80))
    assert "\\[red\\]P\\|I\\[/red\\]" in changed._repr_markdown_()
