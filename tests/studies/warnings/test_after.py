"""Warnings of a run: trips, wind-up, saturation and what does not settle."""

import math
from dataclasses import replace

import numpy as np
import pytest

from clepsydra import PidForm
from clepsydra.loop.loop import Loop
from clepsydra.studies.warnings.after import run_warnings, warnings_after

TRIP = 'trip_above = { tank = "40 cm" }\nhysteresis = "1 cm"'


@pytest.mark.parametrize(("step", "trips"), [(3.5, True), (2.5, False)])
def test_a_trip_is_told_with_its_time(tank, proportional, stepped, step, trips):
    """The level goes from 5 V to 8 V, where it trips at 40 cm: r - 8 = step e^(-t/5 s)-like."""
    analysis = tank(trip=TRIP)
    loop = Loop(proportional(analysis.model, 1.0), analysis.model)
    run = loop.run(stepped(analysis.model, step))
    words = run_warnings(run)
    assert len(words) == trips
    if trips:
        assert words[0].startswith("pump trips: tank above 40 cm, at ")
        first = float(words[0].split(" at ")[1].split(" s")[0])
        # Sampled: the error shrinks by 0.8 a sample, from 3.5 at 5 s; at 8 V it is 0.5.
        samples = math.floor(math.log(0.5 / 3.5) / math.log(0.8))
        within = (3.5 * 0.8**samples - 0.5) / (0.2 * 3.5 * 0.8**samples)
        assert first == pytest.approx(5.0 + samples + within, abs=0.06)


def test_wind_up_is_told_where_the_output_stood_at_its_limit(tank, pid, stepped):
    analysis = tank()

    def words(anti_windup, step):
        controller = pid(
            analysis.model,
            PidForm(anti_windup=anti_windup),
            proportional_gain=2.0,
            integral_time=20.0,
        )
        run = Loop(controller, analysis.model).run(stepped(analysis.model, step))
        return [w for w in run_warnings(run) if "winds up" in w]

    assert len(words("none", 4.0)) == 1
    assert words("none", 1.0) == words("conditional_integration", 4.0) == []


@pytest.fixture
def resting(tank, proportional, stepped):
    analysis = tank()
    run = Loop(proportional(analysis.model, 1.0), analysis.model).run(stepped(analysis.model, 0.0))
    assert run_warnings(run) == ()
    return run


@pytest.mark.parametrize(
    ("count", "value", "said"),
    [
        (30, 10.0, "pump stands at a limit for 60 % of the time, mostly at 10 V: nothing is "),
        (30, 0.0, "pump stands at a limit for 60 % of the time, mostly at 0 V: nothing is "),
        (10, 10.0, "pump stands at a limit for 20 % of the time, mostly at 10 V: nothing is "),
        (2, 10.0, ""),
    ],
)
def test_saturation_is_told_with_its_share_and_its_end(resting, count, value, said):
    pump = resting.values["pump"].copy()
    pump[:count] = value
    words = run_warnings(replace(resting, values=resting.values | {"pump": pump}))
    assert len(words) == bool(said)
    assert not said or words[0].startswith(said)
    assert not said or ("for most of it" in words[0]) == (count == 30)


@pytest.mark.parametrize(
    ("values", "strokes"),
    [
        ([0.0, 10.0, 0.0, 10.0, 0.0], 4),
        ([0.0, 5.0, 10.0, 5.0, 0.0, 5.0, 10.0, 5.0, 0.0], 4),
        ([10.0, 0.0, 10.0, 5.0], 0),  # as soon as can be, and to rest
        ([1.0, 9.0] * 12, 0),  # it moves much, but never to an end
    ],
)
def test_what_goes_from_end_to_end_after_a_step_is_told(resting, values, strokes):
    (step,) = resting.scenario.segments
    pump = resting.values["pump"].copy()
    begin = round(step.start / resting.scenario.sampling_period)
    pump[begin : begin + len(values)] = values
    run = replace(resting, values=resting.values | {"pump": pump})
    told = [words for words in run_warnings(run) if "from one end" in words]
    assert len(told) == bool(strokes)
    assert not strokes or f"{strokes} times after the setpoint step of level" in told[0]
    noise = replace(run.scenario, segments=(replace(step, kind="noise"),))
    assert not any("from one end" in words for words in run_warnings(replace(run, scenario=noise)))


def test_what_does_not_settle_is_told_but_for_levels_that_average(resting):
    scores = {"settling_time[level]": math.inf, "settling_time_2[level]": math.inf}
    (warning,) = warnings_after(resting, scores)
    assert warning.startswith("level does not settle")
    assert warnings_after(resting, {"settling_time[level]": 3.0}) == ()
    buffer = replace(resting, process=replace(resting.process, averaging=("level",)))
    assert warnings_after(buffer, scores) == ()


def test_the_time_of_an_overflow_is_told(resting):
    level = resting.values["tank.level"].copy()
    level[20:] = 0.51
    words = run_warnings(replace(resting, values=resting.values | {"tank.level": level}))
    assert len(words) == 1
    assert words[0].startswith("tank.level rises above its rim at 20 s (range 0 m to 0.5 m)")
    assert np.all(level[:20] < 0.5)
