"""One declaration adds a score to runs, batches, tunings, rankings and reports."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.scores.sample import Fold, magnitude
from clepsydra.scores.score import SCORES, Of, Ranks, Score

SQUARED_MOVES = Score(
    "squared_moves",
    "Squared moves",
    "Sum of the squares of all moves of the manipulated variable.",
    Of.MANIPULATED,
    powers=(2, 0),
    integrand=lambda sample: sample.move * sample.move,
    fold=Fold.SUM,
)
LEFT_SUM = Score(
    "left_sum",
    "Left sum",
    "Sampling period times absolute error at each sample, added up.",
    powers=(1, 1),
    integrand=lambda sample: sample.period * magnitude(sample.error),
    fold=Fold.SUM,
)
PEAK_TIME = Score(
    "peak_time",
    "Peak time",
    "From a load step until the output is furthest from its setpoint, in the slowest case.",
    powers=(0, 1),
    over=lambda run, name: run.worst(
        lambda time, output, setpoint: time[np.argmax(np.abs(output - setpoint))] - time[0],
        run.load_responses(name),
    ),
)


@pytest.fixture
def own_scores(monkeypatch):
    monkeypatch.setattr(SCORES, "_things", dict(SCORES))
    for score in (SQUARED_MOVES, LEFT_SUM, PEAK_TIME):
        score.registered()


@pytest.fixture
def plant():
    return cl.load("quadruple-tank")


def test_a_run_and_its_report_have_it(own_scores, plant):
    run = cl.simulate(plant, cl.design.simc(plant))
    for pump in ("pump_1", "pump_2"):
        moves = np.diff(run.values[pump])
        assert run.scores[f"squared_moves[{pump}]"] == pytest.approx(moves @ moves, rel=1e-12)
    error = run.values["level_1.setpoint"] - run.true_measurement("level_1")
    period = run.process.sampling_period
    left_sum = period * np.sum(np.abs(error))
    assert run.scores["left_sum[level_1]"] == pytest.approx(left_sum, rel=1e-12)
    loads = [part for part in run.scenario.segments if part.kind == "load"]
    assert loads
    after = [np.abs(error[round(s.start / period) : round(s.stop / period) + 1]) for s in loads]
    slowest = max(int(np.argmax(each)) for each in after) * period
    assert run.scores["peak_time[level_1]"] == pytest.approx(slowest, rel=1e-12) and slowest > 0.0


def test_a_tuning_is_for_it_by_a_batch_that_adds_up_the_same_number(own_scores, plant):
    start = cl.design.simc(plant)
    goal = {"left_sum[level_1]": 0.01, "squared_moves[pump_1]": 1.0}
    # Calmer than the start, where both take steps of the same length.
    calm = {"level_1": {"K": (1.5, 3.0)}}
    tuned = cl.tune(start, plant, goal, parameters=calm)
    assert tuned.tuning.objective < tuned.tuning.start_objective
    for controller, added in ((start, tuned.tuning.start_scores), (tuned, tuned.tuning.scores)):
        own = cl.simulate(plant, controller).scores
        for name in goal:
            assert added[name] == pytest.approx(own[name], rel=1e-9), name
    with refused(value="peak_time"):  # it needs the trajectory
        cl.tune(start, plant, "peak_time")


def test_a_study_ranks_by_it(own_scores, tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(
        'process = "quadruple-tank"\n[ranking]\nscores = ["squared_moves", "peak_time"]\n'
        '[controllers.slow]\ndesign = "simc"\n[controllers.fast]\ndesign = "amigo"\n'
    )
    result = cl.study(file)
    assert "squared moves" in result.rule and "peak time" in result.rule
    assert set(result.ranking[0].criteria) == {"Squared moves", "Peak time"}


def test_a_key_belongs_to_one_score(own_scores):
    with refused(place="clepsydra.scores", value="squared_moves"):
        Score("squared_moves", "Others", "Others.").registered()


def test_a_ranking_judges_by_what_is_declared_to_rank(own_scores, plant):
    """A score of held levels joins the usual ones; one of moves decides between those that tie."""
    simc, events = cl.design.simc(plant), [cl.step("level_1", "0.5 V")]
    tried = [simc, simc.with_values({"level_1": {"K": 2.0}}, name="mild")]
    plain = cl.study(plant, tried, events, duration="3 min")
    for score, ranks in ((LEFT_SUM, Ranks.HELD), (SQUARED_MOVES, Ranks.MOVEMENT)):
        del SCORES._things[score.key]
        replace(score, ranks=ranks).registered()
    study = cl.study(plant, tried, events, duration="3 min")
    for before, after in zip(plain.ranking, study.ranking, strict=True):
        assert set(after.criteria) - set(before.criteria) == {"left sum"}
    sums = [each.scores["left_sum[level_1]"] for each in study.ranking]
    first, second = (each.criteria["left sum"] for each in study.ranking)
    assert second / first != 1.0 and min(sums) > 0.0
    assert [each.wear for each in study.ranking] != [each.wear for each in plain.ranking]


def test_what_counts_as_nothing_is_declared(own_scores, plant):
    """Two controllers that both move less than is negligible are told apart by nothing."""
    simc, events = cl.design.simc(plant), [cl.step("level_1", "1 mV")]
    tried = [simc, simc.with_values({"level_1": {"K": 6.0}}, name="strong")]
    wears = [each.wear for each in cl.study(plant, tried, events, duration="3 min").ranking]
    assert wears[0] == wears[1] == 1.0
    declared = SCORES._things.pop("total_variation")
    replace(declared, negligible=0.0).registered()
    wears = [each.wear for each in cl.study(plant, tried, events, duration="3 min").ranking]
    assert wears[0] != wears[1]
