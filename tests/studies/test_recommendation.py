"""What a study recommends: the simplest controller that is good enough."""

from types import SimpleNamespace

import pytest

import clepsydra as cl
from clepsydra.studies.recommendation import (
    Remark,
    as_good_as_first,
    recommend,
    rival_of,
    watched,
)
from clepsydra.studies.result import Standing
from clepsydra.studies.warnings.after import caveats_after


def candidates(*kinds, loops=2, watch=()):
    """Candidates from (complexity, mean error) or (complexity, mean error, standing).

    With what there is to watch by rank, ("It winds up.",).
    """
    run = SimpleNamespace(
        process=SimpleNamespace(controlled=("a", "b")[:loops], averaging=("drum",)),
        error_estimate=None,
    )
    return [
        SimpleNamespace(
            rank=rank,
            run=run,
            controller=SimpleNamespace(
                complexity=complexity,
                setpoints=("a",),
                slowed=1.0,
                name=f"number {rank}",
                values={},
            ),
            scores={},
            warnings=dict(watch).get(rank, ()),
            caveats=(),
            overshoots=(),
            mean_error=error,
            standing=(*standing, Standing.ROBUST)[0],
        )
        for rank, (complexity, error, *standing) in enumerate(kinds, start=1)
    ]


def rank_of(*kinds, loops=2, watch=(), **more):
    return recommend(candidates(*kinds, loops=loops, watch=watch), **more).simplest.rank


PLANT = cl.load("quadruple-tank")
LOOPS = cl.design.simc(PLANT).complexity
ADVANCED = cl.design.simc(PLANT, decoupling="static").complexity
MODEL = cl.design.lqi_kalman(PLANT).complexity


def test_the_simplest_kind_within_the_bound_is_recommended():
    assert rank_of((MODEL, 1.0), (ADVANCED, 1.2), (LOOPS, 1.5)) == 3
    assert rank_of((MODEL, 1.0), (ADVANCED, 1.2), (LOOPS, 1.51)) == 2
    assert rank_of((MODEL, 1.0), (ADVANCED, 1.2), (LOOPS, 1.51), accept=2.0) == 3
    assert rank_of((MODEL, 1.0), (ADVANCED, 1.6), (LOOPS, 2.0)) == 1


def test_of_one_kind_the_first_is_taken():
    assert rank_of((MODEL, 1.0), (LOOPS, 1.3), (LOOPS, 1.4)) == 2


def test_what_stands_worse_is_not_good_enough():
    assert rank_of((MODEL, 1.0), (LOOPS, 0.5, Standing.NERVOUS)) == 1
    assert recommend(candidates((LOOPS, 1.0, Standing.UNSAFE))) is None
    assert recommend([]) is None


def test_a_plant_of_one_loop_gets_its_pi_however_much_better_another_is():
    assert rank_of((MODEL, 1.0), (LOOPS, 9.0), loops=1) == 2
    assert rank_of((MODEL, 1.0), (LOOPS, 9.0, Standing.STABLE), loops=1) == 1


def test_of_one_kind_the_one_with_less_to_watch_is_taken_as_long_as_it_is_good_enough():
    kinds = (MODEL, 1.0), (LOOPS, 1.3), (LOOPS, 1.4), (LOOPS, 1.6)
    assert rank_of(*kinds, watch={2: ["It rings."]}) == 3
    assert rank_of(*kinds, watch={2: ["It rings."], 3: ["It rings."]}) == 2
    assert rank_of(*kinds, watch={2: ["It rings.", "It is slow."], 3: ["It rings."]}) == 3
    found = recommend(candidates(*kinds, watch={2: ["It rings."]}))
    assert found.why == "good enough, with fewer warnings than number 2"
    assert rank_of((LOOPS, 1.0), (MODEL, 1.1), watch={1: ["It rings."]}) == 1


def test_of_one_loop_good_enough_is_beside_the_best_pi_or_pid():
    kinds = (MODEL, 1.0), (LOOPS, 4.0), (LOOPS, 5.9), (LOOPS, 6.1)
    assert rank_of(*kinds, loops=1, watch={2: ["It rings."]}) == 3
    assert rank_of(*kinds, loops=1, watch={2: ["It rings."], 3: ["It rings."]}) == 2
    assert rank_of(*kinds, loops=1, watch={2: ["It rings."]}, accept=1.2) == 2


@pytest.mark.parametrize("error", [2e-6, 2e-3])
def test_an_error_of_the_simulation_does_not_speak_against_a_controller(error):
    first, second = candidates((LOOPS, 1.0), (LOOPS, 1.1))
    first.run.error_estimate = error
    first.run.scenario = SimpleNamespace(segments=())
    (caveat,) = first.caveats = caveats_after(first.run)
    assert caveat.seen == (error > 1e-3)
    assert watched(first) == () and recommend([first, second]).simplest is first
    first.warnings = (Remark("It winds up"),)
    assert recommend([first, second]).simplest is second


def test_overshoot_and_slowing_are_watched_before_the_warnings():
    (each,) = candidates((LOOPS, 1.0))
    assert watched(each) == ()
    each.overshoots = (Remark("It overshoots by 11 %", remedy="lower b to 0.6: 8 %"),)
    each.controller.slowed = 7.483
    each.warnings = (Remark("pump stands at a limit", "nothing is corrected meanwhile"),)
    assert [found.advice for found in watched(each)] == [
        "It overshoots by 11 %; lower b to 0.6: 8 %.",
        "Its rule was slowed 7.48 times, until it was robust.",
        "pump stands at a limit.",
    ]
    each.warnings = (Remark("pump winds up", "it went on", "choose another form"),)
    assert watched(each)[-1].advice == "pump winds up; choose another form."


def test_the_rival_of_the_first_is_of_another_kind_or_of_another_error():
    ranking = candidates((LOOPS, 1.0), (LOOPS, 1.01), (LOOPS, 1.05), (MODEL, 1.06))
    assert rival_of(ranking).rank == 3  # beyond the 2 % within which the ranking calls them equal
    assert [each.rank for each in as_good_as_first(ranking)] == [2]
    assert rival_of(candidates((LOOPS, 1.0), (MODEL, 1.0), (LOOPS, 1.5))).rank == 2
    assert rival_of(candidates((LOOPS, 1.0), (LOOPS, 1.01))).rank == 2
    assert rival_of(candidates((LOOPS, 1.0))) is None


@pytest.mark.parametrize(
    ("design", "arguments", "words"),
    [
        ("simc", {}, "PI or PID loops"),
        ("simc", {"decoupling": "static"}, "loops with decoupling"),
        ("fuzzy_pi", {}, "loops with decoupling"),
        ("variable_structure_pid", {}, "loops with decoupling"),
        ("lqi_kalman", {}, "a model in the controller, and no further sensors"),
        ("polynomial", {}, "a model in the controller, and no further sensors"),
        ("feedback_linearisation", {}, "a model, and more measurements"),
        ("lqi", {}, "a model, and more measurements"),
    ],
)
def test_a_design_says_how_much_its_controller_asks_for(design, arguments, words):
    controller = getattr(cl.design, design)(PLANT, **arguments)
    assert controller.complexity.words.startswith(words)


def test_a_study_recommends_by_the_bound_that_it_is_given():
    controllers = [cl.design.simc(PLANT), cl.design.feedback_linearisation(PLANT)]
    found = cl.study(PLANT, controllers, duration="10 min", accept=1.0)
    assert found.recommended is found.best
    ratio = found.ranking[1].mean_error / found.best.mean_error
    lenient = cl.study(PLANT, controllers, duration="10 min", accept=1.01 * ratio)
    assert lenient.recommended.controller.name == "PI, SIMC"
    assert lenient.verdict.startswith("Use PI, SIMC on ")
    assert lenient.as_dict()["recommended"] == "PI, SIMC"
    with pytest.raises(cl.InputError) as error:
        cl.study(PLANT, controllers, accept=0.5)
    assert error.value.place == "study, accept"
