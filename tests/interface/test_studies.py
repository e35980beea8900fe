"""Controllers compared and tuned."""

import numpy as np
import pandas
import pytest
from refusals import refused

import clepsydra as cl

EVENTS = [cl.step("level_1", "1 V", at="20 s"), cl.disturbance("inflow_2", "50 %", at="3 min")]


@pytest.fixture(scope="module")
def study(plant, pi):
    slow = cl.design.simc(plant, closed_loop_time_constant="60 s").named("slow")
    return cl.study(plant, [slow, pi, pi], EVENTS, duration="6 min")


def test_it_ranks_what_was_given_in_the_scenario_that_was_given(study, plant):
    names = [candidate.controller.name for candidate in study.ranking]
    assert sorted(names) == ["PI, SIMC", "PI, SIMC, 2", "slow"] and names[-1] == "slow"
    assert study.best is study.ranking[0] and study.best.rank == 1
    assert study.best.controller.plant is plant and study.scenario.duration == 360.0
    assert study["slow"].scores["iae[level_1]"] > study["PI, SIMC"].scores["iae[level_1]"]


def test_a_run_of_a_study_is_that_of_a_simulation(study, plant, pi):
    run = cl.simulate(plant, pi, EVENTS, duration="6 min")
    same = study["PI, SIMC"].run
    assert np.allclose(run.values["tank_1.level"], same.values["tank_1.level"], atol=2e-7)
    assert run.scores["iae[level_1]"] == pytest.approx(
        study["PI, SIMC"].scores["iae[level_1]"], rel=1e-5
    )
    assert len(same.plot().axes) > 3


def test_what_it_says_is_on_the_screen_in_the_table_and_in_the_report(study, tmp_path):
    shown = repr(study)
    assert study.verdict[:40] in shown and all(c.controller.name in shown for c in study.ranking)
    table = study.to_pandas()
    assert list(table.index) == [c.controller.name for c in study.ranking]
    assert table.loc["slow", "max|S|"] == study["slow"].maximum_sensitivity
    study.report(tmp_path / "study.html")
    assert "slow" in (tmp_path / "study.html").read_text("utf-8")
    study.save(tmp_path / "study.parquet")
    assert (tmp_path / "study.parquet").stat().st_size > 1000


def test_an_unknown_controller_of_it_is_a_message(study):
    with pytest.raises(cl.InputError) as error:
        study["slwo"]
    assert error.value.value == "slwo" and "'slow' was meant" in error.value.remedy


def test_where_nothing_applies_there_is_no_best(plant):
    with pytest.raises(cl.InputError) as error:
        _ = cl.study(plant, only="PI, arrest time").best
    assert "does not integrate" in error.value.remedy


def test_a_study_file_says_itself_what_is_studied(tmp_path):
    file = tmp_path / "compare.toml"
    file.write_text(
        'process = "quadruple-tank"\n[controllers.tight]\ndesign = "simc"\n'
        'closed_loop_time_constant = "5 s"\n'
    )
    study = cl.study(file)
    plant = cl.load("quadruple-tank")
    tight = cl.design.simc(plant, closed_loop_time_constant=5.0)
    assert study.best.controller.name == "tight" and study.best.controller.values == tight.values
    with pytest.raises(cl.InputError) as error:
        cl.study(file, [tight])
    assert error.value.place == "study, controllers"


def test_one_design_of_all(plant, pi):
    study = cl.study("quadruple-tank", only="PI, SIMC")
    assert [each.controller.values for each in study.ranking] == [pi.values]
    assert study.scenario.segments == cl.simulate(plant, pi).scenario.segments


def test_a_controller_that_there_is_not_is_answered_with_the_few_that_are_near():
    for wrong, meant in (
        ("PI, SMIC", ["'PI, SIMC'"]),
        ("feedback", ["'Feedback linearisation'", "'State feedback, pole placement'"]),
        ("no such", []),
    ):
        with pytest.raises(cl.InputError) as error:
            cl.study("quadruple-tank", only=wrong)
        assert all(name in error.value.remedy for name in meant)
        assert error.value.remedy.count("'") <= 2 * 3  # at most three names


def test_a_tuning_lowers_its_goal_and_keeps_its_limits(plant):
    start = cl.design.simc(plant, closed_loop_time_constant="60 s")
    step = [cl.step("level_1", "0.5 V", at=10)]
    tuned = cl.tune(
        start,
        plant,
        goal="iae[level_1]",
        limits={"overshoot": "5 %", "max|S|": 1.5},
        parameters={"level_1": {"K": (0.1, 3.0), "Ti": ("10 s", "200 s")}},
        events=step,
        duration=300,
    )
    before, after = (cl.simulate(plant, each, step, duration=300) for each in (start, tuned))
    assert after.scores["iae[level_1]"] < 0.6 * before.scores["iae[level_1]"]
    assert after.scores["overshoot[level_1]"] < 5.0 + 0.1
    assert cl.margins(tuned, plant)["max|S|"].max() < 1.5 + 1e-3
    assert tuned.tuning.start_objective == pytest.approx(1.0)
    assert tuned.values["level_2.proportional_gain"] == start.values["level_2.proportional_gain"]
    assert 0.1 <= tuned.values["level_1.proportional_gain"] <= 3.0
    assert "tuned" in tuned.name and "simulations" in repr(tuned)


def test_a_tuning_over_drawn_plants_says_what_most_of_them_keep_before_and_after():
    tanks = cl.load("three-tanks")
    start, step = cl.design.simc(tanks), [cl.step("level_3", "1 cm", at="10 s")]
    over = {"events": step, "duration": "5 min", "draws": 20, "quantile": "90 %"}
    tuned = cl.tune(start, tanks, **over)
    reached, said = tuned.tuning.over_draws, " ".join(repr(tuned).split())
    after, before = (each.scores["iae[level_3]"] for each in (reached.tuned, reached.start))
    reduced = f"at most {100.0 * after:.1f} cm s, before {100.0 * before:.0f} cm s"
    assert f"90 % of 20 plants: IAE of level_3 {reduced}" in said
    assert tuned.tuning.objective == reached.tuned.objective < reached.start.objective
    own = cl.simulate(tanks, tuned, step, duration="5 min").scores["iae[level_3]"]
    assert f"(the plant itself {100.0 * own:.1f} cm s, before" in said
    other = cl.tune(start, tanks, **over, seed=2)
    assert other.tuning.over_draws.start.objective != reached.start.objective


def test_a_study_file_tunes_over_drawn_plants(tmp_path):
    file = tmp_path / "mine.toml"
    text = """
process = "three-tanks"
designs = "none"
[scenario]
duration = "5 min"
[[scenario.setpoint]]
signal = "level_3"
to = "36 cm"
at = "10 s"
[controllers.wary]
design = "simc"
[controllers.wary.tune]
objective = "iae"
draws = 8
quantile = 0.8
"""
    file.write_text(text)
    (found,) = cl.study(file).ranking
    over = found.tuning.over_draws
    assert (over.plants, over.share) == (8, "80 % of 8 plants")
    assert over.tuned.objective < over.start.objective
    file.write_text(text.replace("draws = 8", "draws = 0"))
    with refused(place="line 14", value=0, expected="from 1 to 10,000", remedy="64 will do"):
        cl.study(file)


def test_a_tuned_controller_that_is_changed_says_no_more_that_it_is_tuned(plant, pi):
    one = {"level_1": {"K": (2.5, 3.5)}}
    step = [cl.step("level_1", "0.5 V", at=10)]
    tuned = cl.tune(pi, plant, parameters=one, events=step, duration=20)
    changed = tuned.with_values({"level_1": {"K": 2.0}})
    assert isinstance(tuned, cl.TunedController) and not isinstance(changed, cl.TunedController)


def test_of_a_design_that_was_named_it_is_said_at_once_why_it_does_not_apply(tmp_path):
    """A user who wrote it in a study file asked for it; of all designs only a count is said."""
    file = tmp_path / "two.toml"
    named = '[controllers.{}]\ndesign = "{}"\n'
    file.write_text(
        'process = "three-tanks"\n'
        + named.format("arrest", "arrest_time")
        + named.format("pi", "simc")
    )
    found = cl.study(file)
    ((name, reason),) = found.not_applicable
    said = " ".join(repr(found).split())
    assert f"– {name} does not apply: {reason}" in said
    assert "not applicable:" not in said
    every = cl.study("three-tanks", only="PI, SIMC")
    assert not every.named


@pytest.mark.thorough
def test_the_longest_study_of_the_catalogue_keeps_its_trajectories_in_10_megabytes(tmp_path):
    designs = [getattr(cl.design, name) for name in ("simc", "phase_margin", "lqi", "lqr")]
    study = cl.study(
        "laboratory-four-tanks", [design("laboratory-four-tanks") for design in designs]
    )
    path = tmp_path / "study.parquet"
    kept = study.save(path, largest=10_000_000)
    assert 2 <= kept < len(study.ranking) and path.stat().st_size < 10_000_000
    table = pandas.read_parquet(path, columns=["controller"])
    written = set(table["controller"])
    assert {study.recommended.controller.name, study.best.controller.name} <= written
    assert study.save(path) == len(study.ranking)
