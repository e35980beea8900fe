"""The default scenario of processes whose steady states and time constants are known."""

import math
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import pytest
from plain_process import plain_process
from scipy import stats
from scipy.integrate import solve_ivp

from clepsydra import InputError, LinearModel, Signal
from clepsydra.linear.analysis import analyse
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

GRAVITY = 9.81
AREAS = np.array([28e-4, 32e-4, 28e-4, 32e-4])
OUTLETS = np.array([0.071e-4, 0.057e-4, 0.071e-4, 0.057e-4])
RIM = 0.2
#: Johansson 2000, doi 10.1109/87.845876: splits, pump gains [m³/(s V)], pump voltages [V].
MINIMUM_PHASE = ((0.70, 0.60), (3.33e-6, 3.35e-6), (3.00, 3.00))
NONMINIMUM_PHASE = ((0.43, 0.34), (3.14e-6, 3.29e-6), (3.15, 3.15))


@dataclass(frozen=True)
class Inflow:
    """An element by what the scenario asks of it."""

    name: str
    step: float

    def load_steps(self) -> dict[str, tuple[float, ...]]:
        return {self.name: (self.step,)}


def make_process(
    states: tuple[str, ...],
    inputs: tuple[Signal, ...],
    inflows: tuple[Inflow, ...],
    measurements: tuple[Signal, ...],
    controlled: tuple[str, ...],
    sampling_period: float,
) -> Process:
    """Return a process by its signals; the scenario does not evaluate its equations."""
    x, u = ca.SX.sym("x", len(states)), ca.SX.sym("u", len(inputs))
    d, p = ca.SX.sym("d", len(inflows)), ca.SX.sym("p", 0)
    return plain_process(
        name="rig",
        title="A rig",
        source="this test",
        state=tuple(Signal(name, "m", low=0.0, high=RIM) for name in states),
        inputs=inputs,
        disturbances=tuple(
            Signal(inflow.name, "m^3/s", low=-1e-5, high=1e-5) for inflow in inflows
        ),
        measurements=measurements,
        controlled=controlled,
        parameters=(),
        dynamics=ca.Function("dynamics", [x, u, d, p], [ca.SX.zeros(len(states))]),
        measure=ca.Function("measure", [x, p], [ca.SX.zeros(len(measurements))]),
        measured_state={},
        elements=inflows,
        nominal_outputs={},
        sampling_period=sampling_period,
    )


def quadruple_tank(parameters: tuple, voltages: tuple[float, float] | None = None) -> LinearModel:
    """Return Johansson's process, its equilibrium and its linear model in closed form."""
    (gamma_1, gamma_2), (gain_1, gain_2), nominal = parameters
    pumps = np.array(voltages or nominal)
    feed = np.array(
        [
            [gamma_1 * gain_1, 0.0],
            [0.0, gamma_2 * gain_2],
            [0.0, (1.0 - gamma_2) * gain_2],
            [(1.0 - gamma_1) * gain_1, 0.0],
        ]
    )
    through = feed @ pumps + np.append((feed @ pumps)[2:], [0.0, 0.0])
    levels = (through / OUTLETS) ** 2 / (2.0 * GRAVITY)
    constants = AREAS / OUTLETS * np.sqrt(2.0 * levels / GRAVITY)
    A = np.diag(-1.0 / constants)
    A[0, 2] = AREAS[2] / (AREAS[0] * constants[2])
    A[1, 3] = AREAS[3] / (AREAS[1] * constants[3])
    states = tuple(f"tank_{i}.level" for i in range(1, 5))
    process = make_process(
        states,
        tuple(Signal(f"pump_{i}", "V", low=0.0, high=10.0) for i in (1, 2)),
        (Inflow("inflow_tank_1", 1e-6), Inflow("inflow_tank_2", -2e-6)),
        tuple(Signal(f"level_{i}", "V", low=0.0, high=10.0) for i in range(1, 5)),
        ("level_1", "level_2"),
        sampling_period=1.0,
    )
    model = LinearModel(
        A=A,
        B=feed / AREAS[:, None],
        E=np.vstack([np.diag(1.0 / AREAS[:2]), np.zeros((2, 2))]),
        C=50.0 * np.eye(4),
        D=np.zeros((4, 2)),
        states=states,
        inputs=("pump_1", "pump_2"),
        disturbances=("inflow_tank_1", "inflow_tank_2"),
        outputs=("level_1", "level_2", "level_3", "level_4"),
    )
    point = OperatingPoint(process, levels, pumps, np.zeros(2), 50.0 * levels, residual=0.0)
    return replace(model, point=point)


def single_tank(
    pole: float = -0.01,
    gain: float = 0.004,
    level: float = 0.1,
    pump: float = 5.0,
    sensor: tuple[float, float] = (0.0, 20.0),
) -> LinearModel:
    """Return one tank dh/dt = pole Δh + gain/20 Δu, 100 V/m, a pump of 10 V."""
    process = make_process(
        ("tank.level",),
        (Signal("pump", "V", low=0.0, high=10.0),),
        (),
        (Signal("level", "V", low=sensor[0], high=sensor[1]),),
        ("level",),
        sampling_period=0.5,
    )
    model = LinearModel(
        A=np.array([[pole]]),
        B=np.array([[gain / 20.0]]),
        E=np.zeros((1, 0)),
        C=np.array([[100.0]]),
        D=np.zeros((1, 1)),
        states=("tank.level",),
        inputs=("pump",),
        disturbances=(),
        outputs=("level",),
    )
    point = OperatingPoint(
        process, np.array([level]), np.array([pump]), np.zeros(0), np.array([100 * level]), 0.0
    )
    return replace(model, point=point)


def sizes(scenario: Scenario) -> list[float]:
    return [segment.size for segment in scenario.segments]


@pytest.mark.parametrize(("parameters", "first"), [(MINIMUM_PHASE, 1.0), (NONMINIMUM_PHASE, 0.9)])
def test_one_thing_happens_in_each_segment(parameters: tuple, first: float) -> None:
    model = quadruple_tank(parameters)
    scenario = default_scenario(model)
    assert [(segment.kind, segment.signal) for segment in scenario.segments] == [
        ("setpoint", "level_1"),
        ("setpoint", "level_1"),
        ("setpoint", "level_2"),
        ("setpoint", "level_2"),
        ("load", "inflow_tank_1"),
        ("load", "inflow_tank_2"),
        ("noise", ""),
    ]
    # 10 % of 0 … 10 V, and the process's own load steps, sign included. In the non-minimum phase
    # 1 V of level 1 needs 0.67 V of pump 2, and the step back four times that less: from 3.15 V
    # down to 0.5 V there is room for 0.98 V.
    assert sizes(scenario) == [first, -first, 1.0, -1.0, 1e-6, -2e-6, 0.0]

    columns = {"level_1": scenario.setpoints[:, 0], "level_2": scenario.setpoints[:, 1]}
    columns |= {"inflow_tank_1": scenario.disturbances[:, 0]}
    columns |= {"inflow_tank_2": scenario.disturbances[:, 1]}
    changes = sorted(
        (int(k), name, column[k] - column[k - 1])
        for name, column in columns.items()
        for k in np.flatnonzero(np.diff(column)) + 1
    )
    steps = [segment for segment in scenario.segments if segment.size]
    assert [(k, name) for k, name, _ in changes] == [
        (round(segment.start / scenario.sampling_period), segment.signal) for segment in steps
    ]
    assert [size for _, _, size in changes] == pytest.approx(
        [segment.size for segment in steps], rel=1e-12
    )


@pytest.mark.parametrize("parameters", [MINIMUM_PHASE, NONMINIMUM_PHASE])
def test_it_begins_at_rest_and_fills_its_time_without_a_gap(parameters: tuple) -> None:
    model = quadruple_tank(parameters)
    scenario = default_scenario(model)
    rest = round(scenario.segments[0].start / scenario.sampling_period)
    assert rest >= 1
    point = model.point
    assert np.all(scenario.setpoints[:rest] == point.measurements[:2])
    assert np.all(scenario.disturbances[:rest] == point.disturbances)
    for before, after in zip(scenario.segments, scenario.segments[1:], strict=False):
        assert before.stop == after.start
    assert scenario.segments[-1].stop == scenario.samples * scenario.sampling_period
    assert scenario.setpoints[-1] == pytest.approx(point.measurements[:2], rel=1e-15)


def test_segments_last_six_times_the_slowest_time_constant() -> None:
    scenario = default_scenario(quadruple_tank(MINIMUM_PHASE))
    # T_2 = 90.63 s in closed form, so 543.8 s; the next pretty number.
    assert {segment.stop - segment.start for segment in scenario.segments} == {600.0}
    assert scenario.samples == 60 + 7 * 600


def test_a_zero_in_the_right_half_plane_makes_them_longer() -> None:
    model = quadruple_tank(NONMINIMUM_PHASE)
    (gamma_1, gamma_2), _, _ = NONMINIMUM_PHASE
    T_3, T_4 = -1.0 / model.A[2, 2], -1.0 / model.A[3, 3]
    # Johansson: (1 + s T_3)(1 + s T_4) = (1 - γ_1)(1 - γ_2)/(γ_1 γ_2).
    ratio = (1 - gamma_1) * (1 - gamma_2) / (gamma_1 * gamma_2)
    zero = max(np.roots([T_3 * T_4, T_3 + T_4, 1.0 - ratio]))
    assert -6.0 / max(np.linalg.eigvals(model.A).real) < 600.0 < 6.0 * 2.0 / zero < 1000.0
    scenario = default_scenario(model)
    assert {segment.stop - segment.start for segment in scenario.segments} == {1000.0}


@pytest.mark.parametrize("parameters", [MINIMUM_PHASE, NONMINIMUM_PHASE])
@pytest.mark.parametrize("voltages", [None, (1.6, 1.5), (2.0, 3.9), (3.4, 3.5)])
def test_the_nonlinear_process_can_rest_at_every_setpoint(
    parameters: tuple, voltages: tuple[float, float] | None
) -> None:
    model = quadruple_tank(parameters, voltages)
    scenario = default_scenario(model)
    feed = model.B * AREAS[:, None]
    for setpoint in np.unique(scenario.setpoints, axis=0):
        # Torricelli backwards: the outflow that the level needs, then the pumps that feed it.
        outflow = OUTLETS[:2] * np.sqrt(2.0 * GRAVITY * setpoint / 50.0)
        pumps = np.linalg.solve(feed[:2] + feed[2:], outflow)
        upper = (feed[2:] @ pumps / OUTLETS[2:]) ** 2 / (2.0 * GRAVITY)
        assert np.all((pumps > 0.0) & (pumps < 10.0))
        assert np.all(feed[2:] @ pumps > 0.0) and np.all(upper < RIM)
        assert np.all((setpoint > 0.0) & (setpoint < 10.0))


def test_pumps_near_their_limit_make_the_step_smaller_or_turn_it_round() -> None:
    # Static gain 100 · (0.004/20)/0.01 = 2 V/V: 1 V needs 0.5 V of the pump, and 2.5 V at the
    # step, so that 4.5 V up to 9.5 V are room for 1.8 V.
    assert sizes(default_scenario(single_tank(pump=5.0)))[:2] == [1.0, -1.0]
    # 8.95 V leaves 0.55 V: room for 0.22 V up, and for 0.275 V down and, by 2 V/V, back.
    assert sizes(default_scenario(single_tank(pump=8.95)))[:2] == [-0.2, 0.2]
    # At 0.5 V/V 1 V needs 2 V, 10 V at the step and 8 V at the step back. From 3 V there is
    # room for 0.65 V up and 0.31 V back, or for 0.25 V down; from 7 V the other way round.
    assert sizes(default_scenario(single_tank(gain=0.001, pump=3.0)))[:2] == [0.3, -0.3]
    assert sizes(default_scenario(single_tank(gain=0.001, pump=7.0)))[:2] == [-0.3, 0.3]
    # A pump that empties the tank has its room the other way round.
    assert sizes(default_scenario(single_tank(gain=-0.001, pump=3.0)))[:2] == [-0.3, 0.3]
    # At 0.1 V/V there is room for 0.11 V at the step, but at rest for 0.55 V: 1 % of 20 V.
    assert sizes(default_scenario(single_tank(gain=0.0002, pump=4.0)))[:2] == [0.2, -0.2]


STABLE = ("three-tanks", "quadruple-tank", "laboratory-four-tanks")


@pytest.mark.thorough
@pytest.mark.parametrize("name", STABLE)
def test_a_proportional_controller_stays_inside_every_range(name: str) -> None:
    """Steps there and back by u = u₀ + 5 M (r - y), M what a unit of y needs at rest.

    At 7 cm instead of 1 cm it asked the three tanks' feed for 222 of 100 cm³/s.
    """
    analysis = analyse(load_process(name))
    process, point = analysis.operating_point.process, analysis.operating_point
    model = analysis.model.select(outputs=process.controlled)
    gain = 5.0 * np.linalg.inv(model.D - model.C @ np.linalg.solve(model.A, model.B))
    values = process.parameter_values
    controlled = [[y.name for y in process.measurements].index(n) for n in process.controlled]

    def inputs(x: np.ndarray, setpoints: np.ndarray) -> np.ndarray:
        y = np.array(process.measure(x, values)).ravel()[controlled]
        return point.inputs + gain @ (setpoints - y)

    scenario = default_scenario(analysis.model)
    rest = point.measurements[controlled]
    for column, name_ in enumerate(process.controlled):
        segment = next(part for part in scenario.segments if part.signal == name_)
        away = rest + segment.size * (np.arange(len(rest)) == column)
        x = point.state
        for setpoints in (away, rest):
            run = solve_ivp(
                lambda t, x, r=setpoints: np.array(
                    process.dynamics(x, inputs(x, r), point.disturbances, values)
                ).ravel(),
                (0.0, segment.stop - segment.start),
                x,
                max_step=5.0,
            )
            for state in run.y.T:
                for signal, value in zip(process.inputs, inputs(state, setpoints), strict=True):
                    assert signal.low < value < signal.high
                for signal, value in zip(process.state, state, strict=True):
                    assert signal.low < value < signal.high
            x = run.y[:, -1]


def test_levels_go_at_most_half_way_to_floor_and_rim() -> None:
    # 0.5 cm above the floor, 19.5 cm below the rim: upward. The same below the rim: downward.
    assert sizes(default_scenario(single_tank(level=0.005)))[:2] == [1.0, -1.0]
    assert sizes(default_scenario(single_tank(level=0.195)))[:2] == [-1.0, 1.0]
    # With a wide sensor and a pump that is full on, and strong: half of 5 cm at 100 V/m is 2.5 V.
    wide = single_tank(level=0.05, gain=0.04, pump=9.6, sensor=(-20.0, 20.0))
    assert sizes(default_scenario(wide))[:2] == [-2.0, 2.0]
    # With a pump that is shut: half of the 5 cm to the rim.
    wide = single_tank(level=0.15, gain=0.04, pump=0.4, sensor=(-40.0, 60.0))
    assert sizes(default_scenario(wide))[:2] == [2.0, -2.0]


def test_an_integrating_tank_needs_no_static_gain() -> None:
    # dh/dt = 1e-4 m/(s V): 10 V fill the 20 cm in 200 s, times six.
    scenario = default_scenario(single_tank(pole=0.0, gain=0.002))
    assert sizes(scenario)[:2] == [2.0, -2.0]
    assert scenario.segments[0].stop - scenario.segments[0].start == 1500.0


def test_a_tank_that_all_but_integrates_gets_the_time_of_one_that_does() -> None:
    """Its time constant of 1e5 s is that of a level that no range holds: 1000 V/V."""
    near = single_tank(pole=-1e-5, gain=0.002)
    scenario = default_scenario(near)
    # 1e-4 m/(s V) as in the test before: held by 1 % for 1 % it has 1/(1e-5 + 1/200) s.
    assert scenario.segments[0].stop - scenario.segments[0].start == 1500.0
    # A pump that empties it is as strong.
    scenario = default_scenario(single_tank(pole=-1e-5, gain=-0.002))
    assert scenario.segments[0].stop - scenario.segments[0].start == 1500.0
    # By 4.95 times its range it waits for the process, by 5.05 times for the held loop: 6 T with
    # T = 500 s, and 6 T / 6.05.
    for gain, expected in ((0.00396, 3000.0), (0.00404, 500.0)):
        scenario = default_scenario(single_tank(pole=-0.002, gain=gain))
        assert scenario.segments[0].stop - scenario.segments[0].start == expected


def test_each_input_holds_one_output_that_all_but_integrates() -> None:
    """Both tanks fill by the second pump, the first tank by the first one as well."""
    states = ("one.level", "two.level")
    process = make_process(
        states,
        tuple(Signal(f"pump_{i}", "V", low=0.0, high=10.0) for i in (1, 2)),
        (),
        tuple(Signal(f"level_{i}", "V", low=0.0, high=20.0) for i in (1, 2)),
        ("level_1", "level_2"),
        sampling_period=0.5,
    )
    model = LinearModel(
        A=-1e-6 * np.eye(2),
        B=np.array([[1e-4, 2e-4], [0.0, 1e-4]]),
        E=np.zeros((2, 0)),
        C=100.0 * np.eye(2),
        D=np.zeros((2, 2)),
        states=states,
        inputs=("pump_1", "pump_2"),
        disturbances=(),
        outputs=("level_1", "level_2"),
    )
    levels, pumps = np.array([0.1, 0.1]), np.array([5.0, 5.0])
    model = replace(
        model, point=OperatingPoint(process, levels, pumps, np.zeros(0), 100 * levels, 0.0)
    )
    scenario = default_scenario(model)
    # The second pump is the stronger one for the first level, but the only one for the second.
    assert scenario.segments[0].stop - scenario.segments[0].start == 1500.0
    # Without it nothing holds the second level, which is left to itself: 6 T.
    alone = replace(model, B=np.array([[2e-4, 2e-4], [0.0, 1e-10]]))
    with pytest.raises(InputError, match=r"at least .* for segments of 6e\+06 s"):
        default_scenario(alone)


def test_a_process_without_disturbances_has_no_load_step() -> None:
    scenario = default_scenario(single_tank())
    assert [segment.kind for segment in scenario.segments] == ["setpoint", "setpoint", "noise"]
    assert scenario.disturbances.shape == (scenario.samples, 0)
    assert scenario.segments[0].stop - scenario.segments[0].start == 600.0


def test_a_process_faster_than_its_controller_still_gets_whole_steps() -> None:
    scenario = default_scenario(single_tank(pole=-5.0, gain=2.0))
    assert scenario.segments[0].stop - scenario.segments[0].start == 6.0 * 10.0 * 0.5


def test_noise_is_white_normal_and_only_in_its_segment() -> None:
    model = quadruple_tank(MINIMUM_PHASE)
    scenario = default_scenario(model, seed=7)
    segment = scenario.segments[-1]
    within = (scenario.time >= segment.start) & (scenario.time < segment.stop)
    assert np.all(scenario.noise[~within] == 0.0)
    assert scenario.noise.shape == (scenario.samples, 4)
    for column in scenario.noise[within].T:
        # 0.5 % of 10 V; a sound generator fails each of these once in ten thousand seeds.
        assert stats.kstest(column / 0.05, "norm").pvalue > 1e-4
        lag = np.corrcoef(column[:-1], column[1:])[0, 1]
        assert abs(lag) < 3.9 / math.sqrt(len(column))


def test_the_seed_makes_the_noise_and_nothing_else() -> None:
    model = quadruple_tank(MINIMUM_PHASE)
    one, same, other = (default_scenario(model, seed=seed) for seed in (3, 3, 4))
    assert (one.seed, other.seed) == (3, 4)
    assert np.array_equal(one.noise, same.noise) and not np.array_equal(one.noise, other.noise)
    assert np.array_equal(one.setpoints, other.setpoints)
    assert np.array_equal(one.disturbances, other.disturbances)


def test_a_model_of_the_controlled_outputs_alone_serves_as_well() -> None:
    model = quadruple_tank(NONMINIMUM_PHASE)
    full = default_scenario(model)
    part = default_scenario(model.select(outputs=("level_1", "level_2")))
    assert part.segments == full.segments and np.array_equal(part.setpoints, full.setpoints)


def on(process: Process, model: LinearModel) -> LinearModel:
    """Return the model as one of another process."""
    return replace(model, point=replace(model.point, process=process))


def without_range(model: LinearModel) -> LinearModel:
    process = model.point.process
    endless = (replace(process.measurements[0], high=math.inf),)
    return on(replace(process, measurements=endless), model)


def scanned_too_fast(model: LinearModel) -> LinearModel:
    return on(replace(model.point.process, sampling_period=1e-4), model)


def with_two_sensors(model: LinearModel) -> LinearModel:
    """Return the model with a second sensor on the same tank, controlled as well."""
    point, process = model.point, model.point.process
    second = replace(process.measurements[0], name="second")
    process = replace(
        process, measurements=(*process.measurements, second), controlled=("level", "second")
    )
    point = replace(point, process=process, measurements=np.repeat(point.measurements, 2))
    return replace(
        model,
        C=np.vstack([model.C, 2.0 * model.C]),
        D=np.zeros((2, 1)),
        outputs=("level", "second"),
        point=point,
    )


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (without_range(single_tank()), "rig, level: got 'a range from 0 to inf V'"),
        (
            scanned_too_fast(single_tank()),
            "rig, sampling_period: got '0.0001 s', expected at least 0.0019 s for segments of",
        ),
        (
            with_two_sensors(single_tank()),
            "rig, setpoint step of level: got 'inputs pump', expected inputs that can hold",
        ),
        (
            single_tank(gain=0.00001, pump=5.0),
            "rig, setpoint step of level: got 'room for 0.11 % of its range', expected room for",
        ),
    ],
)
def test_what_allows_no_scenario_is_refused(model: LinearModel, message: str) -> None:
    with pytest.raises(InputError) as refusal:
        default_scenario(model)
    assert str(refusal.value).startswith(message)


@pytest.mark.parametrize("seed", [-1, 1.5, True, "1", None])
def test_a_seed_that_is_none_is_refused(seed: object) -> None:
    with pytest.raises(InputError, match=rf"seed: got {seed!r}, expected a whole number from 0"):
        default_scenario(single_tank(), seed=seed)
