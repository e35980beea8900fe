"""The closed loop: kernel against CasADi, lanes against runs, against CVODES, and its order."""

from dataclasses import replace
from functools import cache
from importlib.resources import files

import casadi as ca
import numpy as np
import pytest
from refusals import refused
from written_plants import plant_of

from clepsydra import InputError, Kernel
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop, controller_name
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.running_scores import RunningScores
from clepsydra.loop.scenario import Scenario
from clepsydra.process.reader import load_process

NAMES = ["quadruple-tank", "quadruple-tank-nonminimum-phase"]


@cache
def make_loop(name: str) -> Loop:
    analysis = analyse(load_process(name))
    return Loop(design_simc(analysis.model, analysis.pairing), analysis.model)


def sampled_at(loop: Loop, period: float) -> Loop:
    """The same controller and process at another sampling period."""
    process = replace(loop.process, sampling_period=period)
    return replace(loop, model=replace(loop.model, point=replace(loop.point, process=process)))


def step_scenario(loop: Loop, samples: int, size: float = 1.0, noise: float = 0.0) -> Scenario:
    """A setpoint step in the first controlled variable, in sensor units."""
    process = loop.process
    at = loop.point.as_dict()
    setpoints = np.tile([at[name] for name in process.controlled], (samples, 1))
    setpoints[5:, 0] += size
    shape = (samples, len(process.measurements))
    return Scenario(
        sampling_period=process.sampling_period,
        setpoints=setpoints,
        disturbances=np.zeros((samples, len(process.disturbances))),
        noise=noise * np.random.default_rng(1).normal(size=shape),
        segments=(),
        seed=1,
    )


@pytest.mark.sampled
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("substeps", [1, 4])
def test_a_loop_without_fused_operations_is_casadi_bit_for_bit(name, substeps):
    """The kernel against CasADi's own evaluation of the same step law, sensors and RK4."""
    loop = make_loop(name)
    process, controller = loop.process, loop.controller
    scenario = step_scenario(loop, 120, size=3.0, noise=0.05)
    program = closed_loop(process, controller, substeps=substeps)
    at_rest = loop.at_rest()
    given = {
        **at_rest,
        **{f"{n}.setpoint": scenario.setpoints[:, i] for i, n in enumerate(process.controlled)},
        **{f"{y.name}.noise": scenario.noise[:, i] for i, y in enumerate(process.measurements)},
    }
    run = Kernel(program, fuse=False).run(
        scenario.samples,
        inputs=given,
        state=loop.initial_state(),
        parameters={controller_name(k): v for k, v in controller.values.items()},
    )

    values = [controller.values[p.name] for p in controller.law.parameters]
    law_state = [controller.initial_state[x.name] for x in controller.law.state]
    parameters = process.parameter_values
    state = ca.DM(loop.point.state)
    order = [controller.manipulated.index(u.name) for u in process.inputs]
    for k in range(scenario.samples):
        true = np.array(process.measure(state, parameters)).ravel()
        measured = true + scenario.noise[k]
        now = dict(zip([y.name for y in process.measurements], measured, strict=True))
        now |= {
            f"{name}.setpoint": value
            for name, value in zip(process.controlled, scenario.setpoints[k], strict=True)
        }
        inputs = loop.law_inputs(at_rest | now)
        law_state, outputs, _ = controller.law.function(law_state, inputs, values)
        moved = np.array(outputs).ravel()[[2 * i for i in order]]
        for x, value in zip(process.state, np.array(state).ravel(), strict=True):
            assert run.output(x.name)[0, k] == value, (k, x.name)
        for u, value in zip(process.inputs, moved, strict=True):
            assert run.output(u.name)[0, k] == value, (k, u.name)
        disturbances = np.zeros(len(process.disturbances))
        held = moved, disturbances, parameters
        h = process.sampling_period / substeps
        for _ in range(substeps):
            k1 = process.dynamics(state, *held)
            k2 = process.dynamics(state + h / 2 * k1, *held)
            k3 = process.dynamics(state + h / 2 * k2, *held)
            k4 = process.dynamics(state + h * k3, *held)
            state = state + h / 6 * (k1 + 2 * (k2 + k3) + k4)


def test_folding_constant_inputs_changes_no_bit():
    loop = make_loop(NAMES[0])
    scenario = step_scenario(loop, 300, size=4.0, noise=0.1)
    folded = loop.run(scenario)
    program = closed_loop(loop.process, loop.controller, substeps=loop.substeps)
    run = Kernel(program).run(
        300,
        inputs={
            **loop.at_rest(),
            **loop.inputs_of(scenario),
        },
        state=loop.initial_state(),
        parameters={controller_name(k): v for k, v in loop.controller.values.items()},
    )
    for signal in program.outputs:
        assert np.array_equal(run.output(signal.name)[0], folded.values[signal.name])


@pytest.mark.parametrize("name", NAMES)
def test_every_lane_of_a_loop_equals_its_own_run_bit_for_bit(name):
    loop = make_loop(name)
    scenarios, samples = 37, 300
    scenario = step_scenario(loop, samples, size=3.0)
    random = np.random.default_rng(2)
    scores = RunningScores(loop.process, ("iae[level_1]", "ise[level_2]"))
    program = closed_loop(loop.process, loop.controller, substeps=2, scores=scores)
    kernel = Kernel(program)
    nominal = {
        **{p.name: p.initial for p in loop.process.parameters},
        **{controller_name(k): v for k, v in loop.controller.values.items()},
    }
    varied = {k: v * (1 + 0.05 * random.uniform(-1, 1, scenarios)) for k, v in nominal.items()}
    state = loop.initial_state()
    inputs = loop.inputs_of(scenario) | scores.inputs_of(scenario)
    batch = kernel.run(samples, inputs=inputs, parameters=varied, state=state, threads=2)
    for lane in range(scenarios):
        own = {k: v[lane] for k, v in varied.items()}
        one = kernel.run(samples, inputs=inputs, parameters=own, state=state)
        assert np.array_equal(batch.record_of(lane), one.record_of(0))
        assert np.array_equal(batch.final_state[:, lane], one.final_state[:, 0])
    assert np.ptp(batch.state("iae[level_1]")) > 0


@pytest.mark.parametrize("name", NAMES)
def test_kernel_agrees_with_cvodes_to_a_millionth_of_tank_height(name):
    loop = make_loop(name)
    scenario = step_scenario(loop, 300, size=1.0)
    kernel, reference = loop.run(scenario), loop.run(scenario, solver="reference")
    for x in loop.process.state:
        difference = np.max(np.abs(kernel.values[x.name] - reference.values[x.name]))
        assert 0 < difference < 1e-6 * (x.high - x.low)
    for name_ in reference.values:
        assert name_ in kernel.values


def test_the_integrator_has_order_four_on_a_smooth_run():
    """Halving the step divides the error by 16: the slope tends to 4."""
    loop = make_loop(NAMES[0])
    slow = sampled_at(loop, 8.0)
    scenario = step_scenario(slow, 60, size=0.5)
    counts = np.array([4, 8, 16, 32])
    exact = slow.run(scenario, substeps=512).values["tank_1.level"]
    errors = [
        np.max(np.abs(slow.run(scenario, substeps=int(n)).values["tank_1.level"] - exact))
        for n in counts
    ]
    slopes = -np.diff(np.log2(errors))
    assert np.all(np.abs(slopes - 4) < 0.06), slopes


def test_a_scenario_of_another_process_is_refused():
    loop = make_loop(NAMES[0])
    scenario = step_scenario(loop, 50)
    with refused(place="sampling period"):
        loop.run(replace(scenario, sampling_period=2.0))
    with refused(place="setpoints"):
        loop.run(replace(scenario, setpoints=scenario.setpoints[:, :1]))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"solver": "radau"}, "solver: got 'radau', expected one of kernel, reference"),
    ],
)
def test_a_run_that_cannot_be_made_is_refused(options, message):
    loop = make_loop(NAMES[0])
    with pytest.raises(InputError, match=message):
        loop.run(step_scenario(loop, 5), **options)


@pytest.mark.parametrize("what", ["measurements", "setpoints", "manipulated"])
def test_a_controller_of_another_process_is_refused(what):
    loop = make_loop(NAMES[0])
    other = replace(loop.controller, **{what: ("level_1", "nowhere")})
    with pytest.raises(InputError, match=f"PI, SIMC, {what}: got "):
        Loop(other, loop.model)
    # A level that is measured but not controlled has no setpoint.
    other = replace(loop.controller, setpoints=("level_1", "level_3"))
    with refused(place="PI, SIMC, setpoints", value="level_3"):
        Loop(other, loop.model)


def test_arguments_of_another_type_are_refused():
    loop = make_loop(NAMES[0])
    for use, message in (
        (lambda: linearise(loop.process), "point: got 'a Process', expected an OperatingPoint"),
        (lambda: default_scenario(loop.point), "model: got 'an OperatingPoint'"),
        (lambda: loop.run(100), "scenario: got 100, expected a Scenario"),
    ):
        with pytest.raises(InputError, match=message):
            use()


def test_a_model_without_an_operating_point_is_refused_by_all_alike():
    loop = make_loop(NAMES[0])
    bare = replace(loop.model, point=None)
    for use in (
        lambda: Loop(loop.controller, bare),
        lambda: default_scenario(bare),
        lambda: sampled_loop(loop.controller, bare),
    ):
        with refused(place="linear model, point", value=None, expected="a model of"):
            use()


def test_an_input_that_no_loop_moves_stays_at_its_operating_point(tmp_path):
    """Two pumps, one controlled level: the second pump stands at its own nominal voltage."""
    text = files("clepsydra.process.catalogue").joinpath("quadruple-tank.toml").read_text()
    edit = 'controlled = ["level_1", "level_2"]', 'controlled = ["level_1"]'
    analysis = plant_of(tmp_path, text, edit).analysis
    loop = Loop(design_simc(analysis.model, [("level_1", "pump_1")]), analysis.model)
    scenario = step_scenario(loop, 100)
    for solver in ("kernel", "reference"):
        run = loop.run(scenario, solver=solver)
        assert np.all(run.values["pump_2"] == loop.point.as_dict()["pump_2"])
        assert np.ptp(run.values["pump_1"]) > 0.1
