"""A search among design numbers where some of them make no controller."""

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import InputError, NotApplicable
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, minimax
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.search_space import SearchSpace
from clepsydra.studies.tuning.tune import Search, tune
from clepsydra.studies.tuning.weight_space import weighed_lqi, weight_space

LOWEST = 0.7


class Squared(SearchSpace):
    """A loop gain that is the start's times the square of a number, refused below 0.7."""

    @property
    def numbers(self):
        return {"root": 1.0}

    def law_values(self, numbers):
        if numbers["root"] < LOWEST:
            raise NotApplicable("by hand", "too small")
        gain = self.controller.values["level.proportional_gain"]
        return {"level.proportional_gain": gain * numbers["root"] ** 2}


@pytest.fixture(scope="module")
def setting():
    basin = cl.load("equalisation-tank")
    return cl.design.simc(basin), basin.linear, default_scenario(basin.linear)


def space_of(start) -> SearchSpace:
    return Squared(start, (TunedParameter("root", 0.1, 3.0),))


@pytest.mark.thorough
def test_a_design_that_does_not_apply_is_never_the_best(setting):
    """The total variation falls with the gain: the best is the last that there is."""
    start, model, scenario = setting
    space = space_of(start)
    goal = Goal(model, scenario, minimax("total_variation[outflow]"))
    found = tune(space, goal, Search(generations=12))
    assert LOWEST <= found.tuned["root"] < 1.05 * LOWEST
    # Half of the sixth digit, to which a controller's gain is rounded.
    assert found.controller.values["level.proportional_gain"] == pytest.approx(
        start.values["level.proportional_gain"] * found.tuned["root"] ** 2, rel=5e-6
    )
    values = space.values_at(np.array([[0.0], [1.0]]))["level.proportional_gain"]
    assert np.isnan(values[0]) and values[1] == pytest.approx(
        9.0 * start.values["level.proportional_gain"]
    )


@pytest.mark.thorough
def test_the_same_gain_is_found_by_way_of_a_number_and_by_itself(setting):
    start, model, scenario = setting
    gain = start.values["level.proportional_gain"]
    goal, search = Goal(model, scenario, minimax("ise[level]")), Search(generations=4)
    one = tune(space_of(start), goal, search)
    law = LawSpace(start, (TunedParameter("level.proportional_gain", 9.0 * gain, 0.5 * gain),))
    other = tune(law, goal, search)
    assert one.objective == pytest.approx(other.objective, rel=1e-7)


def test_the_numbers_of_the_space_are_checked(setting):
    start, _, _ = setting
    for parameters, said in (
        ([TunedParameter("root", 0.1, 3.0)] * 2, "each name once"),
        ([TunedParameter("root", 2.0, 3.0)], "a start within its bounds 2 to 3"),
    ):
        with pytest.raises(InputError, match=said):
            Squared(start, parameters)


def test_gains_of_weights_change_smoothly_by_the_steps_that_a_search_takes():
    design = weight_space(weighed_lqi(cl.load("three-tanks").linear))
    weight = design.numbers["inputs.feed"]
    gains = [
        design.law_values({**design.numbers, "inputs.feed": weight * (1.0 + 1e-6 * i)})
        for i in range(3)
    ]
    for name in ("feed.feedback.level_1", "feed.feedback.level_3", "feed.integral_gain.level_3"):
        steps = np.diff([each[name] for each in gains])
        assert steps[0] != 0.0 and steps[1] == pytest.approx(steps[0], rel=1e-3), name
