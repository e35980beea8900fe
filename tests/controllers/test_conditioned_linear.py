"""The conditioned linear law: PI control as a case of it, changes of mode, faults, windup."""

import math
from dataclasses import replace

import numpy as np
import pytest
from law_function import function_of
from refusals import refused

import clepsydra as cl
from clepsydra import PidForm, Signal
from clepsydra.controllers.blocks.status import read_status
from clepsydra.controllers.conditioned_linear import ConditionedMatrices, conditioned_linear_law
from clepsydra.controllers.multiloop_pid import multiloop_pid_law

LEVEL, PUMP = Signal("level", "m", low=0.0, high=10.0), Signal("pump", "V", low=0.0, high=10.0)
AT_REST = {"fading_time_1": 20.0, "low_limit_1": 0.0, "high_limit_1": 10.0, "bias_1": 3.0}


class Rig:
    """One instance of a law, called scan by scan."""

    def __init__(self, law, values, state=None):
        self.law, self.values = law, values
        given = dict(state or {})
        self.state = np.array([given.get(s.name, s.initial) for s in law.state])

    def scan(self, **given):
        inputs = {s.name: s.initial for s in self.law.inputs} | {"time_step": 1.0} | given
        following, outputs, _ = function_of(self.law)(
            self.state,
            [inputs[s.name] for s in self.law.inputs],
            [self.values[s.name] for s in self.law.parameters],
        )
        self.state = np.array(following)
        return dict(zip((s.name for s in self.law.outputs), outputs, strict=True))

    def kept(self, name):
        return self.state[[s.name for s in self.law.state].index(name)]


def pi_matrices(gain, integral_time, step=1.0):
    """PI control: u = z + K e with K e = −K (y − r), and z follows u − u° in Ti."""
    share = step / integral_time
    one = np.eye(1)
    return ConditionedMatrices((1 - share) * one, 0 * one, share * one, one, -gain * one)


@pytest.fixture(scope="module")
def controller():
    return cl.design.glover_mcfarlane(cl.load("quadruple-tank"))


def rig_of(controller):
    return Rig(controller.law, controller.values, controller.initial_state)


def test_pi_control_in_this_form_is_pi_control():
    """In limits and out of them, with back-calculation in Ti: I⁺ = I + share (K e + (u − v))."""
    values = pi_matrices(2.0, 8.0).values() | AT_REST
    law = conditioned_linear_law(pi_matrices(2.0, 8.0), measured=[LEVEL], manipulated=[PUMP])
    pid = multiloop_pid_law(1, PidForm("PI"), measured=[LEVEL], manipulated=[PUMP])
    settings = {
        "proportional_gain_1": 2.0,
        "integral_time_1": 8.0,
        "setpoint_weight_1": 1.0,
        "tracking_time_1": 8.0,
        "low_limit_1": 0.0,
        "high_limit_1": 10.0,
    }
    ours = Rig(law, values)
    theirs = Rig(
        pid,
        settings,
        {
            "integral_1": 3.0,
            "last_output_1": 3.0,
            "last_proportional_gain_1": 2.0,
            "last_setpoint_weight_1": 1.0,
        },
    )
    random = np.random.default_rng(1)
    reached = set()
    for level in 6.0 + 3.0 * np.sin(np.cumsum(random.normal(scale=0.2, size=400))):
        given = {"setpoint_1": 6.0, "measurement_1": level}
        one, other = ours.scan(**given), theirs.scan(**given)
        assert one["manipulated_1"] == pytest.approx(other["manipulated_1"], abs=1e-12)
        assert one["status_1"] == other["status_1"]
        reached |= set(read_status(int(one["status_1"])))
    assert {"at_low_limit", "at_high_limit"} <= reached


def test_a_zero_is_no_parameter():
    matrices = ConditionedMatrices(
        np.diag([0.5, 0.25]), np.zeros((2, 1)), np.ones((2, 1)), np.array([[1.0, 0.0]]), [[2.0]]
    )
    names = {p.name for p in conditioned_linear_law(matrices).parameters}
    assert {"transition_1_1", "transition_2_2", "memory_gain_1_1", "error_gain_1_1"} <= names
    assert not {"transition_1_2", "memory_gain_1_2", "error_effect_1_1"} & names


def test_unconditioned_is_the_same_inside_the_limits():
    random = np.random.default_rng(3)
    n, p, m = 5, 2, 2
    matrices = ConditionedMatrices(
        0.2 * random.normal(size=(n, n)),
        random.normal(size=(n, p)),
        random.normal(size=(n, m)),
        0.1 * random.normal(size=(m, n)),
        random.normal(size=(m, p)),
    )
    other = matrices.unconditioned()
    assert not other.told.any()
    common = {
        f"{name}_{i}": value
        for i in (1, 2)
        for name, value in {
            "bias": 0.0,
            "fading_time": 9.0,
            "low_limit": -1e9,
            "high_limit": 1e9,
        }.items()
    }
    rigs = [Rig(conditioned_linear_law(each), each.values() | common) for each in (matrices, other)]
    for _ in range(60):
        given = {f"measurement_{j}": random.normal() for j in (1, 2)}
        one, two = (rig.scan(**given) for rig in rigs)
        for i in (1, 2):
            assert one[f"manipulated_{i}"] == pytest.approx(two[f"manipulated_{i}"], abs=1e-10)


@pytest.mark.parametrize("away", [0, 2])
def test_bumpless_from_manual_and_tracking(controller, away):
    """At rest by hand at any output and any error: automatic begins where the hand left off."""
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {
        "setpoint_1": at["level_1"],
        "setpoint_2": at["level_2"],
        "measurement_1": at["level_1"] + 0.4,
        "measurement_2": at["level_2"] - 0.3,
    }
    hand = {"manual_1": 4.2, "manual_2": 1.7, "tracking_1": 4.2, "tracking_2": 1.7}
    for _ in range(3000):
        rig.scan(**given, **hand, mode_1=away, mode_2=away)
    first = rig.scan(**given, **hand)
    assert first["manipulated_1"] == pytest.approx(4.2, abs=1e-9 * 10)
    assert first["manipulated_2"] == pytest.approx(1.7, abs=1e-9 * 10)
    # Then it works: the first level is too high and the second too low.
    later = [rig.scan(**given, **hand) for _ in range(300)][-1]
    assert later["manipulated_1"] < 4.2 - 0.1 and later["manipulated_2"] > 1.7 + 0.1


def test_the_offset_of_a_bumpless_start_fades(controller):
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {
        f"{what}_{j}": at[f"level_{j}"] for what in ("setpoint", "measurement") for j in (1, 2)
    }
    for _ in range(50):
        rig.scan(**given, mode_1=0.0, mode_2=0.0, manual_1=5.0, manual_2=2.0)
    start = rig.kept("integral_1")
    assert abs(start) > 0.1
    time = controller.values["fading_time_1"]
    rig.scan(**given)
    for _ in range(round(time) - 1):
        rig.scan(**given)
    share = (1.0 - 1.0 / time) ** round(time)
    assert rig.kept("integral_1") == pytest.approx(share * start, rel=1e-9)


def test_one_output_by_hand_leaves_the_other_in_automatic(controller):
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {
        f"{what}_{j}": at[f"level_{j}"] for what in ("setpoint", "measurement") for j in (1, 2)
    }
    for _ in range(100):
        found = rig.scan(**given, mode_1=0.0, manual_1=3.5)
    assert found["manipulated_1"] == 3.5 and "automatic" in read_status(int(found["status_2"]))


@pytest.mark.parametrize(
    "fault",
    [
        {"sensor_1": 0.0},
        {"measurement_2": math.nan},
        {"setpoint_1": math.inf},
        {"time_step": 0.0},
        {"time_step": math.nan},
        {"mode_1": 3.0, "mode_2": 7.0},
    ],
)
def test_faults_hold_outputs_and_memory(controller, fault):
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {f"setpoint_{j}": at[f"level_{j}"] for j in (1, 2)}
    given |= {"measurement_1": at["level_1"] + 0.1, "measurement_2": at["level_2"]}
    for _ in range(20):
        before = rig.scan(**given)
    kept = rig.state.copy()
    for _ in range(10):
        held = rig.scan(**{**given, **fault})
        for i in (1, 2):
            assert held[f"manipulated_{i}"] == before[f"manipulated_{i}"]
    assert np.isfinite(rig.state).all()
    if not any(name.startswith("mode") for name in fault):  # nobody moves it: memory stays
        assert np.array_equal(rig.state, kept)


def test_parameters_that_run_over_leave_the_memory(controller):
    name = next(n for n in controller.values if n.startswith("transition_1_"))
    rig = Rig(
        controller.law,
        controller.values | {name: 1e308},
        {**controller.initial_state, "memory_1": 1e10, f"memory_{name[-1]}": 1e10},
    )
    rig.scan(measurement_1=5.0, measurement_2=5.0)
    assert np.isfinite(rig.state).all()


def test_shapes_are_checked():
    one = np.eye(1)
    with refused(place="entered"):
        ConditionedMatrices(one, np.ones((2, 1)), one, one, one)
    with refused(expected="1 to 60"):
        ConditionedMatrices(np.eye(61), np.ones((61, 1)), np.ones((61, 1)), np.ones((1, 61)), one)
    with refused(place="measured"):
        conditioned_linear_law(pi_matrices(1.0, 5.0), measured=[LEVEL, LEVEL])
    assert replace(pi_matrices(1.0, 5.0), direct=one).values()["error_gain_1_1"] == 1.0
