"""Scores that are added up in the kernel, against those of the stored trajectories."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError, Kernel
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop, controller_name
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.running_scores import RunningScores, running_scores
from clepsydra.loop.scenario import Segment
from clepsydra.process.reader import load_process

PROCESSES = [
    "quadruple-tank",
    pytest.param("averaging-tank", marks=pytest.mark.thorough),
    "equalisation-tank",
]


def all_scores(process, *, steps: bool = True) -> RunningScores:
    known = running_scores().values()
    asked = [score for score in known if steps or score.wants in ("", "own step")]
    names = (f"{score.key}[{signal}]" for score in asked for signal in score.of.signals(process))
    return RunningScores(process, tuple(names))


@pytest.fixture(scope="module", params=PROCESSES)
def loop(request) -> Loop:
    plant = cl.load(request.param)
    return Loop(cl.design.simc(plant), plant.measured)


def scored(loop: Loop, scenario, scores: RunningScores, substeps: int, **state):
    """Return the scores of every lane by name, as they are added up while the loop runs."""
    program = closed_loop(
        loop.process, loop.controller, substeps=substeps, scores=scores, statuses=True
    )
    given = loop.at_rest() | loop.inputs_of(scenario) | scores.inputs_of(scenario)
    result = Kernel(program, record=False).run(
        scenario.samples,
        inputs=given,
        state={**loop.initial_state(), **state},
        parameters=loop.law_parameters(),
    )
    return scores.read(result)


def test_they_are_the_scores_of_the_stored_trajectories_of_the_same_run(loop):
    process = loop.process
    # Two setpoint steps of every measurement, load steps, and noise.
    run = cl.simulate(loop.controller.plant, loop.controller)
    found = scored(loop, run.scenario, all_scores(process), run.substeps)
    expected = dict(run.scores)
    averaged = {f"{s}[{y}]" for s in ("outflow_rate", "variance_ratio") for y in process.averaging}
    assert all(expected[name] > 1e-3 for name in averaged)
    assert {part.kind for part in run.scenario.segments} == {"setpoint", "load", "noise"}
    for x in process.levels:
        expected[f"highest[{x}]"] = run.values[x].max()
        expected[f"lowest[{x}]"] = run.values[x].min()
    for y in process.controlled:
        held, now = run.values[f"{y}.setpoint"][:-1], run.true_measurement(y)
        first, last = held - now[:-1], held - now[1:]
        expected[f"highest_error[{y}]"] = max(0.0, last.max())  # it begins at its setpoint
        expected[f"lowest_error[{y}]"] = min(0.0, last.min())
        ends = run.time[1:]
        steps = [part for part in run.scenario.segments if part.kind != "noise"]
        of_step = np.any([(part.start < ends) & (ends <= part.stop) for part in steps], axis=0)
        both = np.sum((first + last)[of_step]) / 2.0 * process.sampling_period
        expected[f"error_integral[{y}]"] = both
    assert any(expected[f"overshoot[{y}]"] > 0.01 for y in process.controlled)
    for name, value in found.items():
        # Within a segment the integral of the error is a small difference of large ones.
        signed = {"ie": "iae", "error_integral": "iae"}
        key, signal = name.removesuffix("]").split("[")
        size = abs(expected[f"{signed[key]}[{signal}]"]) if key in signed else 0.0
        assert value[0] == pytest.approx(expected[name], rel=1e-10, abs=1e-11 * size), name


def test_a_straight_error_that_changes_its_sign_is_integrated_exactly():
    """A level that rises on a line past its setpoint, as in the closed forms of e = 3 - t.

    The tank of 1 m² gets 0.3 m³/s and gives 0.2 m³/s, so that V rises by 0.1 m³/s from 2 m³;
    the setpoint is 2.03 m³: with t = 10 τ s and e = 0.01 m³ × (3 - 10 τ)…
    """
    process = load_process("averaging-tank")
    analysis = analyse(process)
    loop = Loop(design_simc(analysis.model, analysis.pairing), linearise(analysis.operating_point))
    scores = all_scores(process, steps=False)  # the others would ask for steps
    samples, period = 5, process.sampling_period
    scenario = replace(
        default_scenario(loop.model),
        setpoints=np.tile([5000.0, 2.035], (samples, 1)),
        disturbances=np.tile([0.2], (samples, 1)),
        noise=np.zeros((samples, 2)),
        segments=(),
    )
    program = closed_loop(process, loop.controller, substeps=1, scores=scores)
    by_hand = {f"{u}.mode": 0.0 for u in ("inflow", "inflow.impurity")} | {"inflow.manual": 0.3}
    inputs = loop.at_rest() | loop.inputs_of(scenario) | scores.inputs_of(scenario) | by_hand
    found = scores.read(
        Kernel(program, record=False).run(
            samples, inputs=inputs, state=loop.initial_state(), parameters=loop.law_parameters()
        )
    )
    # e = 0.035 - 0.1 t from 0 to 0.4 s; it is zero at 0.35 s, in the middle of a sample.
    end, zero, slope = (samples - 1) * period, 0.35, 0.1
    closed_forms = {
        "ie": slope * (zero * end - end**2 / 2),
        "iae": slope * (zero**2 + (end - zero) ** 2) / 2,
        "ise": slope**2 * (zero**3 + (end - zero) ** 3) / 3,
        "itae": slope * (zero**3 / 3 + end**3 / 3 - zero * end**2 / 2),
        "itse": slope**2 * (end**4 / 4 - 2 * zero * end**3 / 3 + zero**2 * end**2 / 2),
        "iseg": slope**2 * (zero**3 + (end - zero) ** 3) / 3 + 0.5 * slope**2 * end,
    }
    for name, value in closed_forms.items():
        assert found[f"{name}[volume]"][0] == pytest.approx(value, rel=1e-9), name
    assert found["highest[tank.level]"][0] == pytest.approx(2.04, rel=1e-12)
    assert found["lowest[tank.level]"][0] == pytest.approx(2.0, rel=1e-12)


def test_scores_of_averaging_are_those_of_flows_given_by_hand():
    """The pump is moved by hand while two loads act; what stands before and after counts not."""
    process = load_process("equalisation-tank")
    analysis = analyse(process)
    loop = Loop(design_simc(analysis.model, analysis.pairing), analysis.model)
    speed = np.array([0.6, 0.6, 0.6, 0.7, 0.72, 0.66, 0.66, 0.5, 0.9, 0.9])
    inflow = np.array([0.30, 0.30, 0.40, 0.40, 0.40, 0.35, 0.35, 0.35, 0.35, 0.20])
    period, samples = process.sampling_period, len(speed)
    loads = tuple(
        Segment("load", "inflow", start * period, stop * period, 0.1)
        for start, stop in ((2, 5), (5, 8))
    )
    scenario = replace(
        default_scenario(loop.model),
        setpoints=np.full((samples, 1), 0.5),
        disturbances=np.stack([inflow, np.full(samples, 0.193)], axis=1),
        noise=np.zeros((samples, len(process.measurements))),
        segments=loads,
    )
    scores = RunningScores(process, ("outflow_rate[level]", "variance_ratio[level]"))
    program = closed_loop(process, loop.controller, substeps=1, scores=scores)
    by_hand = {"outflow.mode": 0.0, "outflow.manual": speed}
    inputs = loop.at_rest() | loop.inputs_of(scenario) | scores.inputs_of(scenario) | by_hand
    found = scores.read(
        Kernel(program, record=False).run(
            samples, inputs=inputs, state=loop.initial_state(), parameters=loop.law_parameters()
        )
    )
    # 0.005 m³/(s %); the last move within the loads, by 16 %, is the largest. Each load is judged
    # by what was just before it: 60 % and 0.30 m³/s, 72 % and 0.40 m³/s.
    assert found["outflow_rate[level]"][0] == pytest.approx(0.16 * 0.5 / 60.0 * 3600.0**2)
    left = 0.5**2 * (0.0 + 0.1**2 + 0.12**2 + 0.06**2 + 0.06**2 + 0.22**2)
    arrived = 3 * 0.1**2 + 3 * 0.05**2
    assert found["variance_ratio[level]"][0] == pytest.approx(left / arrived)


def test_scores_of_averaging_want_a_load_and_a_tank_that_averages():
    process = load_process("equalisation-tank")
    scores = RunningScores(process, ("variance_ratio[level]",))
    scenario = default_scenario(analyse(process).model)
    assert "scores.load" in scores.inputs_of(scenario)
    quiet = replace(scenario, segments=[s for s in scenario.segments if s.kind != "load"])
    with refused(value="no load step", expected="one, for variance_ratio"):
        scores.inputs_of(quiet)
    with pytest.raises(InputError, match="got 'outflow_rate"):
        RunningScores(load_process("quadruple-tank"), ("outflow_rate[level_1]",))


def test_a_run_that_breaks_off_has_infinite_scores(loop):
    scenario = default_scenario(loop.model)
    level = loop.process.motion.contents[0].name
    start = np.array([loop.initial_state()[level], np.nan])
    found = scored(loop, scenario, all_scores(loop.process), loop.substeps, **{level: start})
    for name, values in found.items():
        assert np.isfinite(values[0]) and values[1] == np.inf, name


def test_every_lane_has_the_scores_of_its_own_run(loop):
    scenario = default_scenario(loop.model)
    scores = all_scores(loop.process)
    program = closed_loop(loop.process, loop.controller, substeps=loop.substeps, scores=scores)
    kernel = Kernel(program, record=False)
    given = loop.at_rest() | loop.inputs_of(scenario) | scores.inputs_of(scenario)
    name = controller_name(f"{loop.controller.measurements[0]}.proportional_gain")
    gains = loop.law_parameters()[name] * np.linspace(0.5, 1.5, 11)
    common = {"inputs": given, "state": loop.initial_state()}
    parameters = loop.law_parameters()
    samples = scenario.samples
    batch = scores.read(kernel.run(samples, **common, parameters=parameters | {name: gains}))
    for lane in (0, 10):
        own = parameters | {name: float(gains[lane])}
        one = scores.read(kernel.run(samples, **common, parameters=own))
        assert {score: values[lane] for score, values in batch.items()} == {
            score: values[0] for score, values in one.items()
        }


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("iae", "running scores: got 'iae', expected iae of one of level_1, level_2"),
        ("iea[level_1]", r"got 'iea\[level_1\]', expected one of ie, iae"),
        ("iae[level_3]", "iae of one of level_1, level_2"),
        ("total_variation[level_1]", "total_variation of one of pump_1, pump_2"),
        ("highest[level_1]", "highest of one of tank_1.level"),
    ],
)
def test_a_score_that_is_none_is_refused(name, message):
    with pytest.raises(InputError, match=message):
        RunningScores(load_process("quadruple-tank"), (name,))


BAND = """
name = "tank"
sampling_period = "2 s"
controlled = ["level"]
averaging = ["level"]
manipulated = ["outflow"]
tanks.tank = { area = "10 m^2", height = "2 m" }
flows.feed = { destination = "tank", range = ["0 m^3/h", "100 m^3/h"], nominal = "50 m^3/h", \
step = ["10 m^3/h", "-10 m^3/h"] }
flows.outflow = { source = "tank", range = ["0 m^3/h", "100 m^3/h"], nominal = "50 m^3/h" }
sensors.level = { tank = "tank", range = ["0 m", "2 m"], band = ["0.9 m", "1.2 m"] }
operating_point.level = "1 m"
"""


def test_a_batch_adds_up_what_a_run_is_scored_by_beyond_a_band(tmp_path):
    (tmp_path / "tank.toml").write_text(BAND, encoding="utf-8")
    plant = cl.load(tmp_path / "tank.toml")
    run = cl.simulate(plant, cl.design.arrest_time(plant, arrest_time=3000.0))
    names = [f"{key}[level]" for key in ("time_outside_band", "above_band", "below_band")]
    loop = Loop(run.controller, plant.measured)
    found = scored(loop, run.scenario, RunningScores(loop.process, tuple(names)), run.substeps)
    for name in names:
        assert run.scores[name] > 0.09
        assert found[name][0] == pytest.approx(run.scores[name], rel=1e-10), name
