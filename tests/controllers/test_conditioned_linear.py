"""The conditioned linear law: PI control as a case of it, changes of mode, faults, windup."""

import math
from dataclasses import replace

import numpy as np
import pytest
from law_function import by_path, function_of

import clepsydra as cl
from clepsydra import PidForm, Signal
from clepsydra.controllers.blocks.status import read_status
from clepsydra.controllers.conditioned_linear import ConditionedMatrices, conditioned_linear_law
from clepsydra.controllers.pid import multiloop_pid_law

LEVEL, PUMP = Signal("level", "m", low=0.0, high=10.0), Signal("pump", "V", low=0.0, high=10.0)
AT_REST = {
    "pump.fading_time": 20.0, "pump.low_limit": 0.0, "pump.high_limit": 10.0, "pump.bias": 3.0
}  # fmt: skip


class Rig:
    """One instance of a law, called scan by scan."""

    def __init__(self, law, values, state=None):
        self.law, self.values = law, values
        given = dict(state or {})
        self.state = np.array([given.get(s.name, s.initial) for s in law.state])

    def scan(self, **given):
        inputs = {s.name: s.initial for s in self.law.inputs} | {"time_step": 1.0}
        inputs |= by_path(self.law.inputs, given)
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
    values = pi_matrices(2.0, 8.0).values([LEVEL], [PUMP]) | AT_REST
    law = conditioned_linear_law([LEVEL], [PUMP], pi_matrices(2.0, 8.0))
    pid = multiloop_pid_law([LEVEL], [PUMP], PidForm("PI"))
    settings = {
        "level.proportional_gain": 2.0,
        "level.integral_time": 8.0,
        "level.setpoint_weight": 1.0,
        "level.tracking_time": 8.0,
        "pump.low_limit": 0.0,
        "pump.high_limit": 10.0,
    }
    ours = Rig(law, values)
    theirs = Rig(
        pid,
        settings,
        {
            "level.integral": 3.0,
            "pump.last_output": 3.0,
            "level.last_proportional_gain": 2.0,
            "level.last_setpoint_weight": 1.0,
        },
    )
    random = np.random.default_rng(1)
    reached = set()
    for level in 6.0 + 3.0 * np.sin(np.cumsum(random.normal(scale=0.2, size=400))):
        given = {"level.sp": 6.0, "level.pv": level}
        one, other = ours.scan(**given), theirs.scan(**given)
        assert one["pump.out"] == pytest.approx(other["pump.out"], abs=1e-12)
        assert one["pump.status"] == other["pump.status"]
        reached |= set(read_status(int(one["pump.status"])))
    assert {"at_low_limit", "at_high_limit"} <= reached


def test_a_zero_is_no_parameter():
    matrices = ConditionedMatrices(
        np.diag([0.5, 0.25]), np.zeros((2, 1)), np.ones((2, 1)), np.array([[1.0, 0.0]]), [[2.0]]
    )
    names = {p.name for p in conditioned_linear_law([LEVEL], [PUMP], matrices).parameters}
    transitions = {f"memory.{j}.transition.memory.{j}" for j in (1, 2)}
    assert transitions | {"pump.memory_gain.memory.1", "pump.error_gain.level"} <= names
    assert "memory.1.transition.memory.2" not in names
    assert not {"pump.memory_gain.memory.2", "memory.1.error_effect.level"} & names


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
        f"pump_{i}.{name}": value
        for i in (1, 2)
        for name, value in {
            "bias": 0.0,
            "fading_time": 9.0,
            "low_limit": -1e9,
            "high_limit": 1e9,
        }.items()
    }
    wires = ["level_1", "level_2"], ["pump_1", "pump_2"]
    rigs = [
        Rig(conditioned_linear_law(*wires, each), each.values(*wires) | common)
        for each in (matrices, other)
    ]
    for _ in range(60):
        given = {f"level_{j}.pv": random.normal() for j in (1, 2)}
        one, two = (rig.scan(**given) for rig in rigs)
        for i in (1, 2):
            assert one[f"pump_{i}.out"] == pytest.approx(two[f"pump_{i}.out"], abs=1e-10)


@pytest.mark.parametrize("away", [0, 2])
def test_bumpless_from_manual_and_tracking(controller, away):
    """At rest by hand at any output and any error: automatic begins where the hand left off."""
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {
        "level_1.sp": at["level_1"],
        "level_2.sp": at["level_2"],
        "level_1.pv": at["level_1"] + 0.4,
        "level_2.pv": at["level_2"] - 0.3,
    }
    hand = {
        "pump_1.manual": 4.2,
        "pump_2.manual": 1.7,
        "pump_1.tracking": 4.2,
        "pump_2.tracking": 1.7,
    }
    for _ in range(3000):
        rig.scan(**given, **hand, pump_1_mode=away, pump_2_mode=away)
    first = rig.scan(**given, **hand)
    assert first["pump_1.out"] == pytest.approx(4.2, abs=1e-9 * 10)
    assert first["pump_2.out"] == pytest.approx(1.7, abs=1e-9 * 10)
    # Then it works: the first level is too high and the second too low.
    later = [rig.scan(**given, **hand) for _ in range(300)][-1]
    assert later["pump_1.out"] < 4.2 - 0.1 and later["pump_2.out"] > 1.7 + 0.1


def test_the_offset_of_a_bumpless_start_fades(controller):
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {f"level_{j}.{what}": at[f"level_{j}"] for what in ("sp", "pv") for j in (1, 2)}
    for _ in range(50):
        rig.scan(**given, pump_1_mode=0.0, pump_2_mode=0.0, pump_1_manual=5.0, pump_2_manual=2.0)
    start = rig.kept("pump_1.integral")
    assert abs(start) > 0.1
    time = controller.values["pump_1.fading_time"]
    rig.scan(**given)
    for _ in range(round(time) - 1):
        rig.scan(**given)
    share = (1.0 - 1.0 / time) ** round(time)
    assert rig.kept("pump_1.integral") == pytest.approx(share * start, rel=1e-9)


def test_one_output_by_hand_leaves_the_other_in_automatic(controller):
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {f"level_{j}.{what}": at[f"level_{j}"] for what in ("sp", "pv") for j in (1, 2)}
    for _ in range(100):
        found = rig.scan(**given, pump_1_mode=0.0, pump_1_manual=3.5)
    assert found["pump_1.out"] == 3.5 and "automatic" in read_status(int(found["pump_2.status"]))


@pytest.mark.parametrize(
    "fault",
    [
        {"level_1.good": 0.0},
        {"level_2.pv": math.nan},
        {"level_1.sp": math.inf},
        {"time_step": 0.0},
        {"time_step": math.nan},
        {"pump_1.mode": 3.0, "pump_2.mode": 7.0},
    ],
)
def test_faults_hold_outputs_and_memory(controller, fault):
    rig = rig_of(controller)
    at = controller.plant.point.as_dict()
    given = {f"level_{j}.sp": at[f"level_{j}"] for j in (1, 2)}
    given |= {"level_1.pv": at["level_1"] + 0.1, "level_2.pv": at["level_2"]}
    for _ in range(20):
        before = rig.scan(**given)
    kept = rig.state.copy()
    for _ in range(10):
        held = rig.scan(**{**given, **fault})
        for i in (1, 2):
            assert held[f"pump_{i}.out"] == before[f"pump_{i}.out"]
    assert np.isfinite(rig.state).all()
    if not any(name.endswith(".mode") for name in fault):  # nobody moves it: memory stays
        assert np.array_equal(rig.state, kept)


def test_parameters_that_run_over_leave_the_memory(controller):
    first, part = "memory.1", "memory.1.transition."
    name = next(n for n in controller.values if n.startswith(part))
    rig = Rig(
        controller.law,
        controller.values | {name: 1e308},
        {**controller.initial_state, first: 1e10, name.removeprefix(part): 1e10},
    )
    rig.scan(level_1_pv=5.0, level_2_pv=5.0)
    assert np.isfinite(rig.state).all()


def test_numbers_are_named_after_what_they_join():
    found = replace(pi_matrices(1.0, 5.0), direct=np.eye(1)).values(["level"], ["pump"])
    assert found["pump.error_gain.level"] == 1.0
