"""Tuning against closed forms: an integrator under sampled proportional control.

The volume of the averaging tank obeys V(k+1) = V(k) + T (f_in - f_out). Under proportional
control the error after a step is multiplied by q = 1 - K T in each sample, on straight lines
between, so that for a step s

- ISE = s² T (1 + q + q²) / (3 (1 - q²)), least at q = √3 - 2,
- overshoot = -100 q %, for q below zero,
- total variation = 2 K s, for q from 0 to 1,
- max|S| = |(z - 1)/(z - q)| at z = -1 = 2 / (1 + q).
"""

import dataclasses
import json
import math

import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError, LinearModel, NotApplicable, PidForm
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario, Segment
from clepsydra.process.reader import load_process
from clepsydra.studies.trial import scores_of
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, Limits, Objective, minimax, weighted_sum
from clepsydra.studies.tuning.parameters import TunedParameter, around, settings_of
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import Progress, Search, tune

PERIOD, STEP = 0.1, 0.01
TANK = load_process("averaging-tank")
SIGNALS = [TANK.signal("volume")], [TANK.signal("inflow")]
#: What the integral of the controllers below still does to a score.
INTEGRAL = 1e-7
GAIN = TunedParameter("volume.proportional_gain", 1.0, 19.0, logarithmic=False)


@pytest.fixture(scope="module")
def model() -> LinearModel:
    return linearise(find_equilibrium(TANK))


def controller(gain: float = 3.0, weight: float = 1.0) -> Controller:
    """Proportional control: an integral that takes four months for what the gain does at once."""
    law = multiloop_pid_law(*SIGNALS, PidForm(anti_windup="none"))
    values = {
        "volume.proportional_gain": gain,
        "volume.setpoint_weight": weight,
        "volume.integral_time": 1e7,
    }
    values |= {"inflow.low_limit": 0.0, "inflow.high_limit": 1.0}
    state = {signal.name: 0.2 for signal in law.state}
    state |= {"volume.last_proportional_gain": gain, "volume.last_setpoint_weight": weight}
    return Controller(
        "PI", "multiloop PI", "By hand.", law, values, state, ("volume",), ("volume",), ("inflow",)
    )


def step_of_volume(size: float = STEP, samples: int = 100) -> Scenario:
    setpoints = np.tile([5000.0, 2.0], (samples, 1))
    setpoints[5:, 1] += size
    step = Segment("setpoint", "volume", 5 * PERIOD, samples * PERIOD, size)
    shape = (samples, 2)
    return Scenario(PERIOD, setpoints, np.full((samples, 1), 0.2), np.zeros(shape), (step,), 1)


def ise(gain: float, size: float = STEP) -> float:
    q = 1.0 - gain * PERIOD
    return size**2 * PERIOD * (1 + q + q * q) / (3 * (1 - q * q))


def tuned(model: LinearModel, objective: Objective, **options) -> TuningResult:
    return searched(controller(), model, step_of_volume(), [GAIN], objective, **options)


def searched(
    start: Controller, model, scenario, parameters, objective, *, limits=None, **options
) -> TuningResult:
    goal = Goal(model, scenario, objective, Limits() if limits is None else limits)
    return tune(LawSpace(start, parameters), goal, Search(**options))


@pytest.mark.parametrize("generations", [0, 20])
def test_the_gain_of_least_ise_is_that_of_the_closed_form(model, generations):
    found = tuned(model, weighted_sum({"ise[volume]": 1.0}), generations=generations)
    best = (3.0 - math.sqrt(3.0)) / PERIOD
    # At a minimum the gain is known to the square root of what the score is known to.
    assert found.controller.values["volume.proportional_gain"] == pytest.approx(best, rel=1e-4)
    assert found.scores["ise[volume]"] == pytest.approx(
        STEP**2 * PERIOD * math.sqrt(3.0) / 6.0, rel=INTEGRAL
    )
    assert found.start_scores["ise[volume]"] == pytest.approx(ise(3.0), rel=INTEGRAL)
    assert found.objective == pytest.approx(ise(best) / ise(3.0), rel=INTEGRAL)
    assert found.maximum_sensitivity == pytest.approx(2.0 / (2.0 - best * PERIOD), rel=1e-4)
    assert found.binding == () and "No limit binds." in found.controller.notes


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("limits", "gain", "said"),
    [
        (Limits(maximum_sensitivity=1.5), 2.0 / 3.0 / PERIOD, "max|S| at most 1.5"),
        (Limits(overshoot=10.0), 1.1 / PERIOD, "overshoot of volume at most 10 %"),
        (
            Limits(total_variation={"inflow": 2 * 5.0 * STEP}),
            5.0,
            "total variation of inflow at most 0.1 m^3/s",
        ),
        (Limits(overshoot=10.0, maximum_sensitivity=1.25), 0.4 / PERIOD, "max|S| at most 1.25"),
    ],
)
def test_a_limit_binds_exactly(model, limits, gain, said):
    for generations in (0, 10):
        found = tuned(model, minimax("ise[volume]"), limits=limits, generations=generations)
        assert found.controller.values["volume.proportional_gain"] == pytest.approx(
            gain, rel=3e-6
        ), generations
        assert found.binding == (said,), generations
        assert found.scores["ise[volume]"] == pytest.approx(ise(gain), rel=1e-5), generations


def test_what_is_reported_is_that_of_the_rounded_controller_that_runs(model):
    found = tuned(model, minimax("ise[volume]"), limits=Limits(1.3), generations=0)
    assert found.controller.values["volume.proportional_gain"] == pytest.approx(
        (2.0 - 2.0 / 1.3) / PERIOD, rel=1e-4
    )
    run = Loop(found.controller, model).run(step_of_volume())
    own = scores_of(run)["ise[volume]"]
    assert found.scores == {"ise[volume]": pytest.approx(own, rel=1e-12, abs=0.0)}
    peak = sampled_loop(found.controller, model).maximum_sensitivity
    assert found.maximum_sensitivity == pytest.approx(peak, rel=1e-12)
    assert found.tuned == {GAIN.name: found.controller.values[GAIN.name]}
    assert found.history[-1, 1] == found.objective


def test_a_bound_that_binds_is_named(model):
    narrow = dataclasses.replace(GAIN, high=9.0)
    found = searched(
        controller(), model, step_of_volume(), [narrow], minimax("ise[volume]"), generations=5
    )
    assert found.controller.values["volume.proportional_gain"] == pytest.approx(9.0, rel=1e-12)
    # In shares of 4 m³ and 1 m³/s, the ranges of volume and inflow.
    assert found.binding == ("volume.gain at most 36 %/%",)
    assert "volume.gain = 36 %/%" in found.controller.design


def test_each_loop_is_named_by_its_own_measurement():
    tanks = analyse(load_process("quadruple-tank"))
    start = design_simc(tanks.model, tanks.pairing)
    space = LawSpace(start, settings_of(start))
    names = [space.name_of(f"level_{loop}.proportional_gain") for loop in (1, 2)]
    assert names == ["level_1.gain", "level_2.gain"]


def test_a_negative_gain_is_named_without_its_sign():
    """The bound nearest to zero is the least gain, though it is the high one of the law."""
    basin = analyse(load_process("equalisation-tank"))
    start = design_simc(basin.model)
    gain = start.values["level.proportional_gain"]
    assert gain < 0.0
    narrow = TunedParameter("level.proportional_gain", 1.2 * gain, 0.8 * gain)
    # Level and outflow are shares of their ranges: K is the gain in %/%.
    assert LawSpace(start, [narrow]).shown("level.proportional_gain", -0.5) == "0.5 %/%"
    found = searched(
        start,
        basin.model,
        default_scenario(basin.model),
        [narrow],
        minimax("total_variation[outflow]"),
        generations=0,
    )
    assert found.controller.values["level.proportional_gain"] == pytest.approx(0.8 * gain)
    assert found.binding == (f"level.gain at least {0.8 * abs(gain):.4g} %/%",)


@pytest.mark.thorough
def test_the_minimax_of_opposing_scores_stands_where_they_are_equal(model):
    """A higher gain lowers ISE and raises the total variation; they are made to meet at 4."""
    meeting = 4.0
    weights = {"ise[volume]": 1.0 / ise(meeting), "total_variation[inflow]": 0.5 / meeting / STEP}
    for generations in (0, 10):
        found = tuned(model, Objective("minimax", weights, relative=False), generations=generations)
        assert found.controller.values["volume.proportional_gain"] == pytest.approx(
            meeting, rel=1e-7
        ), generations
        parts = [weight * found.scores[name] for name, weight in weights.items()]
        assert parts == pytest.approx([1.0, 1.0], rel=1e-7), generations


def test_a_weighted_sum_is_least_where_its_slope_is_zero(model):
    weights = {"ise[volume]": 1e4, "total_variation[inflow]": 1.0}
    found = tuned(model, weighted_sum(weights, relative=False), generations=5)
    gain = found.controller.values["volume.proportional_gain"]
    gains = np.linspace(gain - 0.5, gain + 0.5, 5)
    costs = [1e4 * ise(k) + 2 * k * STEP for k in gains]
    assert found.objective == pytest.approx(costs[2], rel=INTEGRAL)
    # The parabola through neighbours has its lowest point in the middle.
    a, b, _ = np.polyfit(gains - gain, costs, 4)[-3:]
    assert abs(b / (2 * a)) < 1e-3 and a > 0


def test_the_front_is_the_closed_form_of_score_against_robustness(model):
    bounds = (1.2, 1.4, 1.6)
    found = tuned(model, minimax("ise[volume]"), front=bounds, generations=0).front
    assert np.all(np.diff(found.sensitivity) > 0) and np.all(np.diff(found.objective) < 0)
    gains = found.values["volume.proportional_gain"]
    assert found.sensitivity == pytest.approx(2.0 / (2.0 - gains * PERIOD), rel=1e-6)
    assert found.objective == pytest.approx([ise(k) / ise(3.0) for k in gains], rel=1e-6)
    for bound in bounds:
        assert np.min(np.abs(found.sensitivity - bound)) < 1e-5, bound


@pytest.mark.thorough
def test_a_tuned_controller_starts_at_rest_whatever_was_tuned(model):
    """With a setpoint weight below one the bias must hold what K (b - 1) r takes away."""
    parameters = [GAIN, TunedParameter("volume.setpoint_weight", 0.0, 0.9, logarithmic=False)]
    start = controller(weight=0.5)
    start = dataclasses.replace(
        start, initial_state={**start.initial_state, "volume.integral": 0.2 + 3.0 * 0.5 * 2.0}
    )
    found = searched(start, model, step_of_volume(), parameters, minimax("ise[volume]"))
    still = step_of_volume(0.0)
    still = dataclasses.replace(still, segments=())
    values = Loop(found.controller, model).run(still).values
    assert found.controller.values["volume.setpoint_weight"] != 0.5
    assert np.ptp(values["inflow"]) < 1e-12 and np.ptp(values["tank.level"]) < 1e-12


# Interruption ------------------------------------------------------------------------------


class Stop:
    """Presses control-C after some batches."""

    def __init__(self, after: int) -> None:
        self.left = after
        self.stages: list[str] = []

    def __call__(self, progress: Progress) -> None:
        self.stages.append(progress.stage)
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


def same(one: TuningResult, other: TuningResult) -> bool:
    return (
        one.controller.values == other.controller.values
        and one.controller.initial_state == other.controller.initial_state
        and one.controller.notes == other.controller.notes
        and (one.objective, one.scores) == (other.objective, other.scores)
        and one.evaluations == other.evaluations
        and np.array_equal(one.history, other.history)
        and np.array_equal(one.front.sensitivity, other.front.sensitivity)
        and np.array_equal(one.front.objective, other.front.objective)
    )


OPTIONS = {"limits": Limits(1.5), "generations": 10, "front": (1.2,), "seed": 4}


@pytest.fixture(scope="module")
def unbroken(model):
    """A tuning without a break, and how many batches it took."""
    count = Stop(10**9)
    return tuned(model, minimax("ise[volume]"), **OPTIONS, progress=count), len(count.stages)


@pytest.mark.thorough
@pytest.mark.parametrize("share", [0.15, 0.4, 0.6, 0.8])
def test_a_resumed_tuning_ends_as_one_without_a_break(model, unbroken, tmp_path, share):
    whole, batches = unbroken
    path = tmp_path / "state.json"
    stop = Stop(round(share * batches))
    broken = tuned(model, minimax("ise[volume]"), **OPTIONS, state_file=path, progress=stop)
    assert broken.interrupted and not whole.interrupted
    assert broken.evaluations < whole.evaluations
    # The best so far is kept, and it is the best of what was looked at.
    assert broken.objective == broken.history[-1, 1] == broken.history[:, 1].min()
    assert broken.objective >= whole.objective
    assert "stopped before the end" in broken.controller.notes[-1]
    kept = len(json.loads(path.read_text())["candidates"])
    assert 0 < kept < whole.evaluations
    resumed = tuned(model, minimax("ise[volume]"), **OPTIONS, state_file=path)
    assert same(resumed, whole) and not resumed.interrupted
    # Once it is done nothing is left to simulate.
    assert len(json.loads(path.read_text())["candidates"]) == whole.evaluations
    assert same(tuned(model, minimax("ise[volume]"), **OPTIONS, state_file=path), whole)


def test_an_interruption_before_the_start_is_known_is_passed_on(model):
    with pytest.raises(KeyboardInterrupt):
        tuned(model, minimax("ise[volume]"), progress=Stop(1))


def test_progress_names_its_stages_in_order(model):
    stop = Stop(10**9)
    tuned(model, minimax("ise[volume]"), progress=stop, front=(1.3,), generations=3)
    assert list(dict.fromkeys(stop.stages)) == [
        "start", "global search", "search around it", "local search", "Pareto front",
    ]  # fmt: skip


def test_the_state_of_another_problem_is_refused(model, tmp_path):
    path = tmp_path / "state.json"
    tuned(model, minimax("ise[volume]"), generations=1, state_file=path)
    for other in (
        lambda: tuned(model, minimax("iae[volume]"), state_file=path),
        lambda: tuned(model, minimax("ise[volume]"), limits=Limits(1.6), state_file=path),
        lambda: searched(
            controller(3.1), model, step_of_volume(), [GAIN], minimax("ise[volume]"),
            state_file=path,
        ),
        lambda: searched(
            controller(), model, step_of_volume(2 * STEP), [GAIN], minimax("ise[volume]"),
            state_file=path,
        ),
    ):  # fmt: skip
        with refused(value="the state of another problem"):
            other()
    path.write_text("{}")
    with refused(expected="what an interrupted tuning wrote"):
        tuned(model, minimax("ise[volume]"), state_file=path)


@pytest.mark.thorough
def test_the_same_seed_gives_the_same_bits_and_another_seed_another_way(model):
    options = {"limits": Limits(1.5), "generations": 10}
    one, again = (tuned(model, minimax("ise[volume]"), **options, seed=7) for _ in range(2))
    other = tuned(model, minimax("ise[volume]"), **options, seed=8)
    assert same(one, again)
    assert not np.array_equal(one.history, other.history)
    assert other.objective == pytest.approx(one.objective, rel=1e-6)


# What is refused ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parameters", "options", "message"),
    [
        ([GAIN, GAIN], {}, "got 'volume.proportional_gain', expected each name once"),
        ([dataclasses.replace(GAIN, low=4.0)], {}, "got 'a start at 3', expected a start within"),
        ([GAIN], {"objective": minimax("iae[level]")}, r"got 'iae\[level\]', expected iae of one"),
        ([GAIN], {"limits": Limits(total_variation={"pump": 1.0})}, "total_variation of one of"),
        ([GAIN], {"seed": 1.5}, "seed: got 1.5, expected a whole number"),
        ([GAIN], {"seed": -1}, "seed: got -1, expected a whole number"),
        ([GAIN], {"state_file": 3}, "state_file: got 3, expected the path of a file"),
    ],
)
def test_a_problem_that_cannot_be_tuned_is_refused(model, parameters, options, message):
    arguments = {"scenario": step_of_volume(), "objective": minimax("ise[volume]")} | options
    with pytest.raises(InputError, match=message):
        searched(controller(), model, arguments.pop("scenario"), parameters,
             arguments.pop("objective"), **arguments)  # fmt: skip


def test_an_overshoot_limit_needs_a_step_and_a_relative_score_a_start(model):
    still = dataclasses.replace(step_of_volume(0.0), segments=())
    with refused(expected="a scenario with a setpoint step"):
        searched(
            controller(), model, still, [GAIN], minimax("ise[volume]"), limits=Limits(overshoot=5)
        )
    # In three samples at a gain of 3 nothing comes near its setpoint.
    short = step_of_volume(samples=8)
    with refused(expected="a finite score above 0 at the start"):
        searched(controller(), model, short, [GAIN], minimax("overshoot[volume]"))


def test_where_nothing_keeps_the_limits_the_tuning_does_not_apply(model):
    # The least gain has 2 / (2 - 0.1) = 1.053.
    with pytest.raises(NotApplicable, match=r"none of \d+ candidates keeps max.S. at most 1.04"):
        tuned(model, minimax("ise[volume]"), limits=Limits(1.04), generations=5)


# A study's own tuning ----------------------------------------------------------------------


def test_around_moves_by_a_factor_and_takes_the_tracking_time_along():
    law = multiloop_pid_law(["volume"], ["inflow"])
    values = {p.name: p.initial for p in law.parameters}
    values |= {
        "volume.proportional_gain": -2.0,
        "volume.integral_time": 30.0,
        "volume.tracking_time": 30.0,
    }
    state = {s.name: 0.0 for s in law.state}
    direct = Controller(
        "PI", "multiloop PI", "", law, values, state, ("volume",), ("volume",), ("inflow",)
    )
    gain, time = around(direct, ["volume.proportional_gain", "volume.integral_time"], 10.0)
    assert (gain.low, gain.high, gain.followers) == (-20.0, -0.2, ())
    assert (time.low, time.high, time.followers) == (3.0, 300.0, ("volume.tracking_time",))
    # Equal ratios are equal steps, also below zero.
    assert gain.value(np.array([0.0, 0.5, 1.0])) == pytest.approx([-20.0, -2.0, -0.2])
    assert gain.share(-2.0) == pytest.approx(0.5)


def test_a_law_without_gains_is_not_tuned_as_a_pid():
    law = multiloop_pid_law(["volume"], ["inflow"], PidForm("P"))
    values = {p.name: p.initial for p in law.parameters} | {"volume.proportional_gain": 0.0}
    state = {signal.name: 0.0 for signal in law.state}
    none = dataclasses.replace(controller(), law=law, values=values, initial_state=state)
    with pytest.raises(NotApplicable, match="PI has no gain and no integral time to tune"):
        settings_of(none)
