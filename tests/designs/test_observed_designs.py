"""Designs with observers and precompensators on the processes of the catalogue."""

import dataclasses
import functools
from pathlib import Path

import numpy as np
import pytest
from refusals import refused
from scipy.optimize import linear_sum_assignment

import clepsydra as cl
from clepsydra import InputError, NotApplicable
from clepsydra.base.signal import effect
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.lqi_by_weights import design_lqi_by_weights
from clepsydra.designs.lqi_kalman import design_lqi_kalman
from clepsydra.designs.lqr import design_lqr
from clepsydra.designs.pole_placement import design_pole_placement
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.sampled.sampled_process import sampled_process, sampled_states
from clepsydra.designs.states.estimation import Estimation, input_noise
from clepsydra.designs.states.measured_states import with_outputs, without_idle_states
from clepsydra.designs.states.observed_process import observed_process
from clepsydra.designs.states.quadratic_weights import QuadraticWeights, diagonal_weights
from clepsydra.linear.linearise import linearise
from clepsydra.process.reader import load_process

DEAD_TIME = Path(__file__).parents[1] / "dead-time.toml"
OBSERVED = {
    "LQI": design_lqi_kalman,
    "placement": design_pole_placement,
    "LQR": design_lqr,
}


@functools.cache
def model_of(name):
    return cl.load(name).linear


@functools.cache
def observed(name, measurements, design):
    return OBSERVED[design](model_of(name), measurements=list(measurements))


def matrix(controller, name, rows, columns):
    """Return a matrix from the names of its rows and columns, zero where there is no number."""
    numbers = [controller.values.get(effect(i, name, j), 0.0) for i in rows for j in columns]
    return np.reshape(numbers, (len(rows), len(columns)))


def observer_of(controller):
    """Return Φ, Γ, C, M and F of a controller with an observer, from its parameters."""
    x = [s.owner for s in controller.law.state if s.part == "estimate"]
    u, y = controller.manipulated, controller.measurements
    return (
        matrix(controller, "transition", x, x),
        matrix(controller, "input_effect", x, u),
        matrix(controller, "observation", y, x),
        matrix(controller, "correction", x, y),
        matrix(controller, "feedback", u, x),
    )


def distance(found, wanted):
    assert len(found) == len(wanted)
    distances = np.abs(np.asarray(found)[:, None] - np.asarray(wanted))
    rows, columns = linear_sum_assignment(distances)
    return distances[rows, columns].max()


def loop_of(controller, model):
    return sampled_loop(controller, with_outputs(model, controller.measurements))


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "measurements"),
    [
        ("quadruple-tank", ["level_1", "level_2"]),
        ("quadruple-tank-nonminimum-phase", ["level_1", "level_2"]),
        ("three-tanks", ["level_3"]),
        ("three-tanks", ["level_1", "level_3"]),
        ("wet-well", ["level"]),
        (DEAD_TIME, ["level_2"]),
    ],
)
@pytest.mark.parametrize("design", list(OBSERVED))
def test_the_loop_has_the_poles_of_regulator_and_observer(name, measurements, design):
    """Separation principle, of the law that runs: its derivatives, joined with the process."""
    model = model_of(name)
    if design == "placement" and name == DEAD_TIME:
        pytest.skip("placement refuses dead time")
    controller = observed(name, tuple(measurements), design)
    held, moved, shown, correction, feedback = observer_of(controller)
    one = np.eye(len(held))
    errors = np.linalg.eigvals((one - correction @ shown) @ held)
    process = load_process(name)
    if design == "LQI":
        rows = [controller.measurements.index(name) for name in controller.setpoints]
        m = moved.shape[1]
        integral = matrix(controller, "integral_gain", controller.manipulated, controller.setpoints)
        # The integral behind its gain: I⁺ = I − Δt G C x.
        regulated = np.block(
            [
                [held - moved @ feedback, moved],
                [-process.sampling_period * integral @ shown[rows], np.eye(m)],
            ]
        )
        wanted = [*errors, *np.linalg.eigvals(regulated)]
    else:
        n = len(held) - moved.shape[1]
        regulated = held[:n, :n] - moved[:n] @ feedback[:, :n]
        fading = [
            1.0 - process.sampling_period / controller.values[f"{u}.fading_time"]
            for u in controller.manipulated
        ]
        wanted = [*errors, *np.linalg.eigvals(regulated), *fading]
    # States that act on no output have poles of their own.
    whole = sampled_process(
        with_outputs(model, controller.measurements), process.sampling_period
    ).held
    idle = len(whole) - len(sampled_states(without_idle_states(model), process.sampling_period))
    found = np.linalg.eigvals(loop_of(controller, model).A)
    if idle:
        own = np.linalg.eigvals(whole)
        # The standby pump of the wet well follows by itself.
        wanted += [pole for pole in own if np.abs(pole - np.exp(-0.5 * 2.0)) < 1e-9][:idle]
    wanted = np.array(wanted)
    # Poles that coincide are ill-conditioned; the coefficients of their polynomial are not.
    assert np.poly(found) == pytest.approx(np.poly(wanted), abs=1e-11)
    gaps = np.abs(wanted[:, None] - wanted) + np.eye(len(wanted))
    if gaps.min() > 1e-4:
        assert distance(found, wanted) < 1e-8


def static_loop(law, controller, model, loads):
    """Return what setpoints and loads make of the controlled outputs at rest.

    The law's derivatives in automatic, joined with x(k+1) = Φ x + Γ u + (loads held).
    """
    process = model.point.process
    period = process.sampling_period
    whole = without_idle_states(with_outputs(model, controller.measurements))
    both = dataclasses.replace(
        whole,
        B=np.hstack([whole.B, whole.E[:, loads]]),
        D=np.zeros((len(whole.C), whole.B.shape[1] + len(loads))),
        inputs=(*whole.inputs, *(f"load {k}" for k in loads)),
    )
    held, moved, _ = sampled_process(both, period)
    m = len(whole.inputs)
    q = len(controller.setpoints)
    law_A, law_B, law_C, law_D = law(controller, model.point)
    C = whole.C
    A = np.block(
        [
            [held + moved[:, :m] @ law_D[:, q:] @ C, moved[:, :m] @ law_C],
            [law_B[:, q:] @ C, law_A],
        ]
    )
    by_setpoint = np.vstack([moved[:, :m] @ law_D[:, :q], law_B[:, :q]])
    by_load = np.vstack([moved[:, m:], np.zeros((len(law_A), len(loads)))])
    rows = [controller.measurements.index(name) for name in controller.setpoints]
    shown = np.hstack([C[rows], np.zeros((q, len(law_A)))])
    rest = np.linalg.solve(np.eye(len(A)) - A, np.hstack([by_setpoint, by_load]))
    return (shown @ rest)[:, :q], (shown @ rest)[:, q:]


@pytest.mark.sampled
@pytest.mark.parametrize("design", list(OBSERVED))
@pytest.mark.parametrize("name", ["eight-tanks", "wet-well", "quadruple-tank", "three-tanks"])
def test_setpoints_are_reached_and_an_observer_leaves_no_offset_under_load(
    name, design, linear_law
):
    model = model_of(name)
    controller = observed(name, model.outputs, design)
    loads = [k for k, load in enumerate(model.disturbances) if "inflow" in load]
    follows, offset = static_loop(linear_law, controller, model, loads)
    assert follows == pytest.approx(np.eye(len(follows)), abs=1e-8)
    open_loop = np.abs(model.C @ np.linalg.solve(model.A, model.E[:, loads]))
    assert np.abs(offset).max() < 1e-6 * open_loop.max()


@pytest.mark.parametrize(
    "design", [pytest.param(design_pole_placement, marks=pytest.mark.thorough), design_lqr]
)
def test_without_an_observer_the_precompensator_is_exact_and_a_load_leaves_an_offset(
    design, linear_law
):
    model = model_of("quadruple-tank")
    controller = design(model)
    assert len(controller.measurements) == 4
    follows, offset = static_loop(linear_law, controller, model, [0, 1])
    assert follows == pytest.approx(np.eye(2), abs=1e-9)
    assert np.abs(offset).max() > 1e3  # [V/(m³/s)]
    assert any("offset that stays" in note for note in controller.notes)


def test_the_sensitivity_is_that_of_a_sweep():
    """|S| of a law with an observer, from transfer functions of its parts."""
    model = model_of("three-tanks")
    controller = design_lqi_kalman(model, measurements=["level_3"])
    held, moved, shown, correction, feedback = observer_of(controller)
    process = sampled_process(model, 1.0)
    one, C = np.eye(3), model.C
    gain = controller.values["feed.integral_gain.level_3"]
    z = np.exp(1j * np.geomspace(1e-5, np.pi, 20001))[:, None, None]
    plant = (C @ np.linalg.solve(z * one - process.held, process.moved))[:, 0, 0]
    # x̂c = (1 − M C) x̂ + M y, z x̂ = Φ x̂c + Γ u, u = −F x̂c − Δt G y/(z − 1).
    kept = one - correction @ shown
    loop = z * one - (held - moved @ feedback) @ kept
    by_y = (held - moved @ feedback) @ correction - moved * gain / (z - 1.0)
    estimate = np.linalg.solve(loop, by_y)
    law = (-feedback @ (kept @ estimate + correction) - gain / (z - 1.0))[:, 0, 0]
    peak = np.max(1.0 / np.abs(1.0 - plant * law))
    assert loop_of(controller, model).maximum_sensitivity == pytest.approx(peak, rel=1e-5)


REFUSED = {
    ("averaging-tank:all-inputs", "LQI"): "3 inputs move 2 controlled outputs",
    ("averaging-tank:all-inputs", "Kalman"): "3 inputs move 2 controlled outputs",
    ("eight-tanks", "LQI"): r"tank_1\.level is not measured",
    ("eight-tanks:corrected", "LQI"): r"tank_1\.level is not measured",
    ("wet-well", "LQI"): r"duty\.actual is not measured",
    (DEAD_TIME, "LQI"): "dead time",
    (DEAD_TIME, "placement"): "dead time",
}
DESIGNS = {
    "LQI": design_lqi,
    "Kalman": design_lqi_kalman,
    "placement": design_pole_placement,
    "LQR": design_lqr,
}


@pytest.mark.sampled
@pytest.mark.parametrize("design", list(DESIGNS))
@pytest.mark.parametrize(
    "name",
    [
        "averaging-tank",
        "averaging-tank:inflow-constant",
        "averaging-tank:all-inputs",
        "eight-tanks",
        "eight-tanks:corrected",
        "three-tanks",
        "three-tanks:corrected",
        "quadruple-tank",
        "quadruple-tank-nonminimum-phase",
        "laboratory-four-tanks",
        "laboratory-four-tanks:fitted",
        "laboratory-four-tanks-nonminimum-phase",
        "equalisation-tank",
        "wet-well",
        DEAD_TIME,
    ],
)
def test_every_process_gets_a_robust_controller_or_a_reason(name, design):
    model = model_of(name)
    if (name, design) in REFUSED:
        with pytest.raises(NotApplicable, match=REFUSED[name, design]):
            DESIGNS[design](model)
        return
    controller = DESIGNS[design](model)
    peak = loop_of(controller, model).maximum_sensitivity
    assert peak <= 2.0 * (1 + 1e-9)
    assert f"sensitivity peak {peak:.2f}." in controller.design


def test_what_acts_on_no_output_is_left_out():
    model = model_of("equalisation-tank")
    assert without_idle_states(model).states == ("basin.level",)
    assert design_lqi(model).measurements == ("level",)


def test_a_demanding_design_is_slowed_down_and_says_so(nonminimum_phase):
    model = nonminimum_phase.model
    usual = design_lqi(model)
    controller = design_lqi(model, maximum_errors={"level_1": 0.02, "level_2": 0.02})
    peak = loop_of(controller, model).maximum_sensitivity
    assert 1.99 < peak <= 2.0
    assert any("slowed down" in note for note in controller.notes)
    assert not any("slowed down" in note for note in usual.notes)


def test_dead_time_is_estimated_by_what_is_on_its_way():
    model = model_of(DEAD_TIME)
    seen = observed_process(model, None)
    names = [signal.name for signal in seen.estimated]
    # 5 s in samples of 2 s: tank 1 was one second ago what leaves the channel in part.
    assert names[:2] == ["tank_1.level", "tank_2.level"]
    assert {name for name in names if name.startswith("tank_1.level.")} == {
        f"tank_1.level.{age}_s_before" for age in (1, 3, 5)
    }
    assert seen.estimated[2].unit == "m"


def test_each_number_on_its_way_is_what_it_is_called():
    """The register of the sampled model against the history of its own run."""
    model = without_idle_states(model_of(DEAD_TIME))
    period = 2.0
    held, moved, _ = sampled_process(model, period)
    ages = sampled_states(model, period)
    # A second model, sampled each second, runs beside with the same inputs.
    fine = sampled_process(model, 1.0)
    rng = np.random.default_rng(4)
    state, fast = np.zeros(len(held)), np.zeros(len(fine.held))
    tank, pump = [0.0] * 20, [0.0] * 20
    for _ in range(30):
        u = rng.normal(size=1)
        state = held @ state + moved @ u
        for _ in range(2):
            fast = fine.held @ fast + fine.moved @ u
            tank.append(fast[0])
            pump.append(u[0])
        for place, (name, age) in enumerate(ages):
            if name == "tank_1.level":
                assert state[place] == pytest.approx(tank[-1 - round(age)], rel=1e-9)
            elif name == "feed":
                assert state[place] == pytest.approx(pump[-round(age)], abs=1e-12)


def test_the_noise_of_the_inputs_is_that_of_a_simulated_loop():
    """Of an observer so fast that a variance is a difference of far larger numbers."""
    model = model_of("laboratory-four-tanks")
    measurements = ["level_1", "level_2"]
    poles = {"poles": [0.98, 0.97, 0.96, 0.95], "observer_poles": np.linspace(0.2, 0.3, 6)}
    controller = design_pole_placement(model, measurements=measurements, **poles)
    held, moved, shown, correction, feedback = observer_of(controller)
    sensor = 0.005 * 30e-2 * 4.0
    made = np.random.default_rng(1).normal(0.0, sensor, (20_000, 2))
    state, estimate, inputs = np.zeros(6), np.zeros(6), []
    for noise in made:
        corrected = estimate + correction @ (shown @ (state - estimate) + noise)
        inputs.append(-feedback @ corrected)
        state = held @ state + moved @ inputs[-1]
        estimate = held @ corrected + moved @ inputs[-1]
    estimation = Estimation((), held, moved, shown, correction)
    found = input_noise(estimation, feedback, sensor**2 * np.eye(2))
    assert found == pytest.approx(np.std(inputs, axis=0), rel=0.05)


def test_given_poles_are_taken_as_they_are():
    model = model_of("three-tanks")
    poles = [0.9, 0.85 + 0.05j, 0.85 - 0.05j]
    controller = design_pole_placement(
        model, poles=poles, observer_poles=[0.6, 0.55, 0.5, 0.45], measurements=["level_3"]
    )
    found = np.linalg.eigvals(loop_of(controller, model).A)
    for pole in [*poles, 0.6, 0.55, 0.5, 0.45]:
        assert np.abs(found - pole).min() < 1e-7
    fast = design_pole_placement(model, bandwidth=0.01, measurements=["level_3"])
    assert "bandwidth of 0.01 rad/s" in fast.design


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"poles": [0.9]}, "3 numbers"),
        ({"poles": [0.9, 0.8, 0.7], "bandwidth": 0.1}, "poles or a bandwidth"),
        ({"bandwidth": -1.0}, "above 0 rad/s"),
        ({"observer_poles": [0.5, 0.4, 0.3, 0.2]}, "sensors show every state"),
        ({"observer_poles": [0.5], "measurements": ["level_3"]}, "4 numbers"),
        ({"measurements": ["level_1"]}, "add level_3"),
        ({"measurements": ["level_3", "level_3"]}, "each name once"),
        ({"measurements": ["level_9"]}, "some of level_1, level_2, level_3"),
        ({"measurements": "level_3"}, "some of level_1, level_2, level_3"),
    ],
)
def test_a_request_that_makes_no_sense_is_refused(options, words):
    with pytest.raises(InputError, match=words):
        design_pole_placement(model_of("three-tanks"), **options)


@pytest.mark.parametrize("design", [design_pole_placement, design_lqr, design_lqi_kalman])
def test_an_output_that_the_inputs_cannot_hold_is_refused(minimum_phase, design):
    with pytest.raises(NotApplicable, match="1 inputs cannot hold 2 outputs"):
        design(minimum_phase.model.select(inputs=["pump_1"]))


@pytest.mark.parametrize("design", [design_pole_placement, design_lqr])
def test_outputs_that_move_together_are_refused(minimum_phase, design):
    first = minimum_phase.model.B[:, 0]
    twin = dataclasses.replace(minimum_phase.model, B=np.column_stack([first, 2 * first]))
    with pytest.raises(NotApplicable, match="independently"):
        design(twin)


def test_an_uncontrollable_pair_is_refused(single_tank):
    # The second tank hears nothing of the pump, and the first is fed by it.
    A = np.array([[-0.02, 0.01], [0.0, -0.001]])
    model = single_tank(A, [3e-4, 0.0], [50.0, 0.0])
    with pytest.raises(NotApplicable, match="a mode of 1e\\+03 s is out of reach"):
        design_pole_placement(model, poles=[0.9, 0.8], measurements=["level"])


def test_lqi_by_weights_of_bryson_is_lqi_by_bryson(minimum_phase):
    model = minimum_phase.model
    horizon = minimum_phase.T.max() / 3.0
    weights = QuadraticWeights(
        model.C.T @ model.C, np.diag([1 / 9.0, 1 / 9.0]), np.eye(2) / horizon**2
    )
    by_weights, by_bryson = design_lqi_by_weights(model, weights), design_lqi(model)
    names = [name for name in by_bryson.values if "feedback" in name or "integral_gain" in name]
    for name in names:
        assert by_weights.values[name] == pytest.approx(by_bryson.values[name], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("weights", [[4.0, 0.2], {"states": {}}, np.eye(4)])
@pytest.mark.parametrize("design", [design_lqr, design_lqi_by_weights])
def test_weights_that_are_none_are_refused(minimum_phase, design, weights):
    with refused(expected="QuadraticWeights", remedy="make them by diagonal"):
        design(minimum_phase.model, weights=weights)


def test_matrices_may_be_lists(minimum_phase):
    """Weights given as lists are the same matrices."""
    model = minimum_phase.model
    Q, R = np.diag([4.0, 4.0, 0.0, 0.0]), 0.2 * np.eye(2)
    by_lists = design_lqr(model, weights=QuadraticWeights(Q.tolist(), R.tolist()))
    assert by_lists.values == design_lqr(model, weights=QuadraticWeights(Q, R)).values


def test_lqi_by_weights_needs_those_of_the_integrals(minimum_phase):
    model = minimum_phase.model
    pumps = {"pump_1": 1.0, "pump_2": 1.0}
    with refused(expected="weights for the integrals of level_1, level_2"):
        design_lqi_by_weights(model, diagonal_weights(model, {"tank_1.level": 1.0}, pumps))
    with refused(place="weights, states"):
        design_lqr(model, weights=QuadraticWeights(np.eye(3), np.eye(2)))


def test_extra_inputs_share_by_their_room(linear_law):
    """Three inputs for two outputs: the smallest N, each input in its largest move."""
    model = model_of("averaging-tank:all-inputs")
    controller = design_lqr(model)
    follows, _ = static_loop(linear_law, controller, model, [])
    assert follows == pytest.approx(np.eye(2), abs=1e-9)


def test_the_model_may_show_more_than_is_controlled():
    model = model_of("quadruple-tank")
    everything = linearise(model.point)
    controller = design_lqi_kalman(model)
    assert sampled_loop(controller, everything).is_stable
