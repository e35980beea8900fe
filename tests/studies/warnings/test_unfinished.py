"""An averaging level that is still on its way, against the closed form of a sampled integrator."""

from dataclasses import replace

import pytest

from clepsydra.loop.loop import Loop
from clepsydra.studies.warnings.after import caveats_after, warnings_after


@pytest.fixture
def averaging(tank, proportional, stepped):
    """Return a function that runs a tank that averages under proportional control."""

    def make(gain, length=50):
        analysis = tank()
        controller = proportional(analysis.model, gain)
        run = Loop(controller, analysis.model).run(stepped(analysis.model, 1.0, length=length))
        return replace(run, process=replace(run.process, averaging=("level",)))

    return make


def test_a_level_that_is_still_on_its_way_is_told_by_how_much(averaging):
    """Each sample leaves 0.95 of the error; the segment has 45 samples, its last tenth 4."""
    run = averaging(0.25)
    (caveat,) = caveats_after(run)
    share = (0.95**41 - 0.95**44) / (1.0 - 0.95**44)
    assert "level is not at rest when the setpoint step of level ends after 45 s" in caveat.words
    assert f"by up to {100 * share:.2g} % of its way" in caveat.words
    assert "more" not in caveat.words.partition(":")[0]
    assert caveat in caveats_after(run) and warnings_after(run, {}) == ()


def test_all_steps_that_a_level_does_not_finish_are_counted_and_the_worst_is_told(averaging):
    """Segments of 20 and 25 samples of the same way: 0.05 of what is left in each sample."""
    run = averaging(0.25)
    (whole,) = run.scenario.segments
    middle = whole.start + 20.0
    halves = replace(whole, stop=middle), replace(whole, start=middle)
    scenario = replace(run.scenario, segments=halves)
    (caveat,) = caveats_after(replace(run, scenario=scenario))
    share = (0.95**18 - 0.95**19) / (1.0 - 0.95**19)
    assert "ends after 20 s, nor at the end of 1 more, so that " in caveat.words
    assert f"by up to {100 * share:.2g} % of its way" in caveat.words


def test_a_level_that_came_to_rest_raises_none(averaging):
    """0.8 of the error in each sample; and the slow one of before in five times the time."""
    assert caveats_after(averaging(1.0)) == ()
    assert caveats_after(averaging(0.25, length=250)) == ()


def test_a_level_that_is_held_is_left_to_the_warning_about_settling(averaging):
    run = averaging(0.25)
    assert caveats_after(replace(run, process=replace(run.process, averaging=()))) == ()
