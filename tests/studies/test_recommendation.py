"""What a study recommends: the simplest controller that is good enough."""

from types import SimpleNamespace

import pytest

import clepsydra as cl
from clepsydra.studies.recommendation import recommend
from clepsydra.studies.result import Standing


def candidates(*kinds, loops=2):
    """Candidates from (complexity, mean error) or (complexity, mean error, standing)."""
    run = SimpleNamespace(process=SimpleNamespace(controlled=("a", "b")[:loops]))
    return [
        SimpleNamespace(
            rank=rank,
            run=run,
            controller=SimpleNamespace(complexity=complexity, setpoints=("a",)),
            mean_error=error,
            standing=(*standing, Standing.ROBUST)[0],
        )
        for rank, (complexity, error, *standing) in enumerate(kinds, start=1)
    ]


def rank_of(*kinds, loops=2, **more):
    return recommend(candidates(*kinds, loops=loops), **more).simplest.rank


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
