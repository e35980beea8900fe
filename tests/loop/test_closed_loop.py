"""The closed loop: kernel against CasADi, lanes against runs, against CVODES, and its order."""

from dataclasses import replace
from importlib.resources import files

import casadi as ca
import numpy as np
import pytest

from clepsydra.design.simc import design_simc
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.reference import LawEvaluation
from clepsydra.engine.runge_kutta import runge_kutta
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop, controller_name
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.process.reader import load_process

NAMES = ["quadruple-tank", "quadruple-tank-nonminimum-phase"]


def make_loop(name: str) -> Loop:
    process = load_process(name)
    analysis = analyse(process)
    controller = design_simc(process, analysis.model, analysis.pairing)
    point = analysis.operating_point
    return Loop(process, controller, point, linearise(process, point))


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


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("substeps", [1, 4])
def test_a_loop_without_fused_operations_is_casadi_bit_for_bit(name, substeps):
    """The kernel against CasADi's own evaluation of the same step law, sensors and RK4."""
    loop = make_loop(name)
    process, controller = loop.process, loop.controller
    scenario = step_scenario(loop, 200, size=3.0, noise=0.05)
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

    law = LawEvaluation(
        controller.law,
        np.array([controller.values[p.name] for p in controller.law.parameters]),
        np.array([controller.initial_state[x.name] for x in controller.law.state]),
    )
    move = runge_kutta(process.dynamics, substeps)
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
        outputs = law.step(inputs)
        moved = outputs[[2 * i for i in order]]
        for x, value in zip(process.state, np.array(state).ravel(), strict=True):
            assert run.output(x.name)[0, k] == value, (k, x.name)
        for u, value in zip(process.inputs, moved, strict=True):
            assert run.output(u.name)[0, k] == value, (k, u.name)
        disturbances = np.zeros(len(process.disturbances))
        state = move(process.sampling_period, state, moved, disturbances, parameters)


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
    program = closed_loop(loop.process, loop.controller, substeps=2, running_scores=True)
    kernel = Kernel(program)
    nominal = {
        **{p.name: p.initial for p in loop.process.parameters},
        **{controller_name(k): v for k, v in loop.controller.values.items()},
    }
    varied = {k: v * (1 + 0.05 * random.uniform(-1, 1, scenarios)) for k, v in nominal.items()}
    state = loop.initial_state()
    inputs = loop.inputs_of(scenario)
    batch = kernel.run(samples, inputs=inputs, parameters=varied, state=state, threads=2)
    for lane in range(scenarios):
        own = {k: v[lane] for k, v in varied.items()}
        one = kernel.run(samples, inputs=inputs, parameters=own, state=state)
        assert np.array_equal(batch.record_of(lane), one.record_of(0))
        assert np.array_equal(batch.final_state[:, lane], one.final_state[:, 0])
    assert np.ptp(batch.state("iae[level_1]")) > 0


def test_running_scores_are_the_sums_of_the_trajectory():
    loop = make_loop(NAMES[0])
    scenario = step_scenario(loop, 400, size=2.0, noise=0.05)
    program = closed_loop(loop.process, loop.controller, substeps=2, running_scores=True)
    final = Kernel(program).run(
        400,
        inputs=loop.inputs_of(scenario),
        parameters={controller_name(k): v for k, v in loop.controller.values.items()},
        state=loop.initial_state(),
    )
    run = loop.run(scenario, substeps=2)
    error = scenario.setpoints[:, 0] - run.true_measurement("level_1")
    period = scenario.sampling_period
    assert final.state("iae[level_1]")[0] == pytest.approx(
        period * np.sum(np.abs(error)), rel=1e-12
    )
    assert final.state("ise[level_1]")[0] == pytest.approx(period * np.sum(error**2), rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_kernel_agrees_with_cvodes_to_a_millionth_of_tank_height(name):
    loop = make_loop(name)
    scenario = step_scenario(loop, 600, size=1.0)
    kernel, reference = loop.run(scenario), loop.run(scenario, solver="reference")
    for x in loop.process.state:
        difference = np.max(np.abs(kernel.values[x.name] - reference.values[x.name]))
        assert 0 < difference < 1e-6 * (x.high - x.low)
    for name_ in reference.values:
        assert name_ in kernel.values


def test_the_integrator_has_order_four_on_a_smooth_run():
    """Halving the step divides the error by 16: the slope tends to 4."""
    loop = make_loop(NAMES[0])
    slow = replace(loop, process=replace(loop.process, sampling_period=8.0))
    scenario = step_scenario(slow, 60, size=0.5)
    counts = np.array([4, 8, 16, 32])
    exact = slow.run(scenario, substeps=512).values["tank_1.level"]
    errors = [
        np.max(np.abs(slow.run(scenario, substeps=int(n)).values["tank_1.level"] - exact))
        for n in counts
    ]
    slopes = -np.diff(np.log2(errors))
    assert np.all(np.abs(slopes - 4) < 0.06), slopes


def test_the_error_estimate_covers_the_true_error():
    loop = make_loop(NAMES[0])
    scenario = step_scenario(loop, 400)
    checked = loop.run_checked(scenario)
    reference = loop.run(scenario, solver="reference")
    true = max(
        np.max(np.abs(checked.values[x.name] - reference.values[x.name])) / (x.high - x.low)
        for x in loop.process.state
    )
    assert checked.error_estimate is not None
    # CVODES itself is good to about 1e-9 of the height here.
    assert true < checked.error_estimate + 3e-9
    assert checked.error_estimate < 1e-6


def test_a_scenario_of_another_process_is_refused():
    loop = make_loop(NAMES[0])
    scenario = step_scenario(loop, 50)
    with pytest.raises(Exception, match="sampling period"):
        loop.run(replace(scenario, sampling_period=2.0))
    with pytest.raises(Exception, match="setpoints"):
        loop.run(replace(scenario, setpoints=scenario.setpoints[:, :1]))


def test_an_input_that_no_loop_moves_stays_at_its_operating_point(tmp_path):
    """Two pumps, one controlled level: the second pump stands at its own nominal voltage."""
    text = files("clepsydra.process.catalogue").joinpath("quadruple-tank.toml").read_text()
    path = tmp_path / "one-loop.toml"
    path.write_text(text.replace('controlled = ["level_1", "level_2"]', 'controlled = ["level_1"]'))
    process = load_process(path)
    analysis = analyse(process)
    point = analysis.operating_point
    controller = design_simc(process, analysis.model, [("level_1", "pump_1")])
    loop = Loop(process, controller, point, linearise(process, point))
    scenario = step_scenario(loop, 100)
    for solver in ("kernel", "reference"):
        run = loop.run(scenario, solver=solver)
        assert np.all(run.values["pump_2"] == point.as_dict()["pump_2"])
        assert np.ptp(run.values["pump_1"]) > 0.1
