"""What a controller refuses to be built with, and its linear model."""

import dataclasses
import math

import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError, Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_quadratic_integral import lqi_law
from clepsydra.controllers.linear_step_law import StepLawDerivatives
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, step_law

PERIOD = 2.0


PI_VALUES = {
    "level_1.proportional_gain": 3.0, "level_1.integral_time": 30.0, "level_1.setpoint_weight": 0.5,
    "pump_1.low_limit": 0.0, "pump_1.high_limit": 10.0, "level_1.tracking_time": 30.0,
    "level_2.proportional_gain": -2.0, "level_2.integral_time": 8.0, "level_2.setpoint_weight": 1.0,
    "pump_2.low_limit": 0.0, "pump_2.high_limit": 10.0, "level_2.tracking_time": 8.0,
}  # fmt: skip
PI_LAW = multiloop_pid_law(["level_1", "level_2"], ["pump_1", "pump_2"])
PI_STATE = {
    "level_1.integral": 3.0,
    "pump_1.last_output": 3.0,
    "level_2.integral": 3.0,
    "pump_2.last_output": 3.0,
}


def cross_paired_pi(**changed):
    return Controller(
        "PI", "multiloop PI", "by hand", PI_LAW, PI_VALUES | changed, PI_STATE,
        ("level_1", "level_2"), ("level_1", "level_2"), ("pump_2", "pump_1"),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"level_1.integral_time": 0.0},
            "PI, level_1.integral_time: got 0.0, expected a number from 1e-06",
        ),
        ({"level_2.integral_time": -3.0}, "PI, level_2.integral_time: got -3.0"),
        (
            {"level_1.tracking_time": math.nan},
            "PI, level_1.tracking_time: got nan, expected a finite number",
        ),
        ({"level_1.proportional_gain": math.inf}, "PI, level_1.proportional_gain: got inf"),
        (
            {"level_1.setpoint_weight": 1.5},
            "PI, level_1.setpoint_weight: got 1.5, expected a number from 0 to 1",
        ),
        (
            {"pump_2.low_limit": 10.0},
            "PI, pump_2.low_limit: got 10.0, expected a value below pump_2.high_limit",
        ),
        ({"level_1.derivative_time": 1.0}, "remove level_1.derivative_time"),
        (
            {"level_1.integral_time": "30 s"},
            "PI, level_1.integral_time: got '30 s', expected a finite number",
        ),
        ({"level_1.proportional_gain": None}, "PI, level_1.proportional_gain: got None"),
        ({"level_1.proportional_gain": True}, "PI, level_1.proportional_gain: got True"),
    ],
)
def test_a_controller_with_unusable_values_is_refused(changed, message):
    with pytest.raises(InputError) as refusal:
        cross_paired_pi(**changed)
    assert message in str(refusal.value)


def test_a_controller_without_a_value_is_refused():
    fewer = {name: value for name, value in PI_VALUES.items() if name != "pump_1.high_limit"}
    with refused(remedy="add pump_1.high_limit"):
        Controller(
            "PI", "", "", PI_LAW, fewer, PI_STATE,
            ("level_1", "level_2"), ("level_1", "level_2"), ("pump_1", "pump_2"),
        )  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"measurements": ("level_1",)},
            "PI, measurements: got ['level_1'], expected 2 names, one for each measurement",
        ),
        ({"setpoints": ()}, "PI, setpoints: got [], expected 2 names, one for each setpoint"),
        ({"manipulated": ("pump_1", "pump_2", "pump_3")}, "PI, manipulated: got ['pump_1', 'pum"),
        ({"manipulated": ("pump_1", "pump_1")}, "expected each name once"),
        ({"measurements": "y1"}, "PI, measurements: got 'y1', expected 2 names"),
        ({"measurements": ("level_1", 2)}, "PI, measurements: got ('level_1', 2), expected 2"),
        ({"manipulated": None}, "PI, manipulated: got None, expected 2 names"),
        ({"initial_state": PI_STATE | {"level_1.integral": "3"}}, "PI, level_1.integral: got '3'"),
    ],
)
def test_names_that_do_not_fit_the_law_are_refused(changed, message):
    with pytest.raises(InputError) as refusal:
        dataclasses.replace(cross_paired_pi(), **changed)
    assert message in str(refusal.value)


def test_a_law_with_a_signal_that_nothing_is_wired_to_is_refused():
    law = step_law(
        "with_weather",
        inputs=[Signal("level_1.pv"), Signal("weather")],
        parameters=[],
        state=[],
        outputs=[Signal("pump_1.out")],
        equations=lambda s: Equations({}, {"pump_1.out": s["level_1.pv"] + s["weather"]}),
    )
    with refused(place="law with_weather", value="weather"):
        Controller("W", "", "", law, {}, {}, ("level_1",), (), ("pump_1",))


def test_the_program_starts_with_the_numbers_of_the_controller():
    program = cross_paired_pi().program()
    assert {p.name: p.initial for p in program.parameters} == PI_VALUES
    # And it remembers the gains and weights, so that a change of one is noticed.
    remembered = {
        name.replace(".", ".last_"): value
        for name, value in PI_VALUES.items()
        if name.endswith(("proportional_gain", "setpoint_weight"))
    }
    assert {x.name: x.initial for x in program.state} == PI_STATE | remembered


def linear(controller):
    """The law near rest at measurements and setpoints of 5."""
    inputs = {s.name: 5.0 for s in controller.law.inputs if s.part in ("pv", "sp")}
    derivatives = StepLawDerivatives(controller.law)
    return derivatives.at(
        controller.values, controller.initial_state, inputs | {"time_step": PERIOD}
    )


def test_linear_model_of_two_pi_has_the_textbook_matrices():
    model = linear(cross_paired_pi())
    assert np.array_equal(model.A, np.eye(2))
    rates = PERIOD * np.diag([3.0 / 30.0, -2.0 / 8.0])
    assert model.B_setpoint == pytest.approx(rates, abs=1e-15)
    assert model.B_measurement == pytest.approx(-rates, abs=1e-15)
    assert np.array_equal(model.C, np.eye(2))
    assert np.array_equal(model.D_setpoint, np.diag([3.0 * 0.5, -2.0]))
    assert np.array_equal(model.D_measurement, np.diag([-3.0, 2.0]))


def test_derivatives_are_built_once_and_evaluated_for_any_values():
    controller = cross_paired_pi()
    derivatives = StepLawDerivatives(controller.law)
    for gain in (1.0, -7.0):
        values = controller.values | {"level_2.proportional_gain": gain}
        model = derivatives.at(values, {}, {"time_step": PERIOD})
        assert model.D_measurement[1, 1] == -gain
        assert model.B_setpoint[1, 1] == PERIOD * gain / 8.0


def test_linear_model_of_lqi_has_the_textbook_matrices():
    rng = np.random.default_rng(0)
    F, G = rng.normal(size=(2, 3)), rng.normal(size=(2, 2))
    values, state = {}, {}
    for i in (1, 2):
        values |= {f"pump_{i}.feedback.level_{j}": F[i - 1, j - 1] for j in (1, 2, 3)}
        values |= {f"pump_{i}.integral_gain.level_{j}": G[i - 1, j - 1] for j in (1, 2)}
        values |= {f"pump_{i}.bias": 0.0, f"pump_{i}.low_limit": -1.0, f"pump_{i}.high_limit": 1.0}
        state |= {f"pump_{i}.integral": 0.0, f"pump_{i}.last_output": 0.0}
    values |= {f"level_{j}.reference": 50.0 for j in (1, 2, 3)}  # far beyond the limits
    levels, pumps = ("level_1", "level_2", "level_3"), ("pump_1", "pump_2")
    law = lqi_law(levels, pumps, levels[:2], "conditional_integration")
    controller = Controller("LQI", "LQI", "by hand", law, values, state, levels, levels[:2], pumps)
    model = linear(controller)
    assert np.array_equal(model.A, np.eye(2))
    rates = PERIOD * G
    assert model.B_setpoint == pytest.approx(rates, rel=1e-14)
    assert model.B_measurement == pytest.approx(np.hstack([-rates, np.zeros((2, 1))]), rel=1e-14)
    assert np.array_equal(model.C, np.eye(2))
    assert np.array_equal(model.D_setpoint, np.zeros((2, 2)))
    assert model.D_measurement == pytest.approx(-F, rel=1e-14)


def test_a_delay_ring_counts_as_a_state_for_every_sample_of_delay():
    """u(k) = y(k−3) + y(k−1): its response to an impulse tells when each part arrives."""
    law = step_law(
        "delayed",
        inputs=[Signal("level_1.pv")],
        parameters=[],
        state=[DelayRing(Signal("past"), 3), Signal("recent")],
        outputs=[Signal("pump_1.out")],
        equations=lambda s: Equations(
            {"past": s["level_1.pv"], "recent": s["level_1.pv"]},
            {"pump_1.out": s["past"] + s["recent"]},
        ),
    )
    model = StepLawDerivatives(law).at({}, {}, {})
    assert model.A.shape == (4, 4)
    state, seen = model.B_measurement[:, 0], [float(model.D_measurement[0, 0])]
    for _ in range(5):
        seen.append(float(model.C[0] @ state))
        state = model.A @ state
    assert seen == [0.0, 1.0, 0.0, 1.0, 0.0, 0.0]


def test_many_linear_models_at_once_are_those_of_each_and_stacks_of_one_size():
    """u(k) = a y(k−3) + b y(k−1): where b is zero nothing reads the last measurement."""
    law = step_law(
        "weighed",
        inputs=[Signal("level_1.pv")],
        parameters=[Signal("a"), Signal("b")],
        state=[DelayRing(Signal("past"), 3), Signal("recent")],
        outputs=[Signal("pump_1.out")],
        equations=lambda s: Equations(
            {"past": s["level_1.pv"], "recent": s["level_1.pv"]},
            {"pump_1.out": s["a"] * s["past"] + s["b"] * s["recent"]},
        ),
    )
    derivatives, weights = StepLawDerivatives(law), [0.5, 0.0, -2.0]
    stacks = derivatives.each({"a": 3.0, "b": np.array(weights)}, {}, {})
    assert [(places.tolist(), stack.A.shape) for places, stack in stacks] == [
        ([0, 2], (2, 4, 4)),
        ([1], (1, 3, 3)),
    ]
    for places, stack in stacks:
        for row, place in enumerate(places):
            one = derivatives.at({"a": 3.0, "b": weights[place]}, {}, {})
            for name, matrix in vars(one).items():
                assert np.array_equal(getattr(stack, name)[row], matrix)
    assert derivatives.each({"a": 3.0, "b": np.array([])}, {}, {}) == []
