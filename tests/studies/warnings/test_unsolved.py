"""A study warns of samples in which the search of a controller found nothing."""

import clepsydra as cl

STEP = [cl.step("level_1", "+1 V", at="2 s")]


def warnings():
    plant = cl.load("quadruple-tank")
    mine = [cl.design.mpc(plant)]
    (found,) = cl.study(plant, controllers=mine, events=STEP, duration="30 s").ranking
    run = found.run
    return run, [str(each) for each in found.warnings if "came to no end" in str(each)]


def test_plans_that_are_not_found_are_counted_and_warned_of(monkeypatch):
    monkeypatch.setattr("clepsydra.controllers.predictive.law.LARGEST_RESIDUAL", -1.0)
    run, told = warnings()
    unsolved = round(run.final_state["controller.unsolved"])
    assert unsolved > 0
    assert told[0].lower().startswith(f"in {unsolved} of {run.scenario.samples} samples")


def test_where_every_plan_is_found_nothing_is_told():
    run, told = warnings()
    assert run.final_state["controller.unsolved"] == 0 and told == []
