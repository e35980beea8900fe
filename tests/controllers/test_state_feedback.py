"""State feedback and the current observer against matrices, in every mode and at every fault."""

import math
from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

from clepsydra import Signal
from clepsydra.controllers.linear_quadratic_integral import lqi_law
from clepsydra.controllers.observers.linear_state import CurrentObserver, ObserverStructure
from clepsydra.controllers.state_feedback import state_feedback_law

rng = np.random.default_rng(11)
HELD = np.array([[0.8, 0.1, 0.0], [0.0, 0.9, 0.05], [0.0, 0.0, 0.7]])
MOVED = np.array([[0.2, 0.0], [0.1, 0.3], [0.0, 0.4]])
SHOWN = np.array([[2.0, 0.0, 0.0], [0.0, 0.0, 3.0]])
CORRECTION = rng.normal(size=(3, 2)) * 0.1
FEEDBACK, AHEAD = rng.normal(size=(2, 3)), rng.normal(size=(2, 1))
LEVELS, PUMPS = ["level_1", "level_2"], ["pump_1", "pump_2"]
REFERENCE, BIAS = np.array([5.0, 6.0]), np.array([4.0, 5.0])
STEP, FADING = 0.5, 20.0
STRUCTURE = ObserverStructure(
    tuple(Signal(f"tank_{j}.level", "m") for j in (1, 2, 3)),
    HELD != 0.0,
    MOVED != 0.0,
    SHOWN != 0.0,
    CORRECTION != 0.0,
)
REST = {
    "pump_1.integral": 0.0, "pump_2.integral": 0.0,
    "pump_1.last_output": 4.0, "pump_2.last_output": 5.0,
    "tank_1.level.estimate": 0.0, "tank_2.level.estimate": 0.0, "tank_3.level.estimate": 0.0,
}  # fmt: skip


def signals(names):
    return [Signal(name) for name in names]


def values():
    observer = CurrentObserver(STRUCTURE, signals(LEVELS), signals(PUMPS))
    numbers = {}
    for matrix, array in zip(observer.matrices, (HELD, MOVED, SHOWN, CORRECTION), strict=True):
        numbers |= matrix.named(array)
    numbers |= {f"level_{j + 1}.reference": REFERENCE[j] for j in range(2)}
    for i in range(2):
        numbers |= {f"pump_{i + 1}.feedback.tank_{j + 1}.level": FEEDBACK[i, j] for j in range(3)}
        numbers |= {
            f"pump_{i + 1}.precompensator.level_2": AHEAD[i, 0],
            f"pump_{i + 1}.bias": BIAS[i],
            f"pump_{i + 1}.fading_time": FADING,
            f"pump_{i + 1}.low_limit": 0.0,
            f"pump_{i + 1}.high_limit": 10.0,
        }
    return numbers


def inputs(measurements, setpoint, **changed):
    numbers = {"time_step": STEP, "level_2.sp": setpoint}
    for j in range(2):
        numbers |= {f"level_{j + 1}.pv": measurements[j], f"level_{j + 1}.good": 1.0}
    for i in (1, 2):
        numbers |= {f"pump_{i}.mode": 1, f"pump_{i}.manual": 0.0, f"pump_{i}.tracking": 0.0}
    return numbers | changed


@pytest.fixture
def law(driven):
    return driven(
        state_feedback_law(LEVELS, PUMPS, ["level_2"], observer=STRUCTURE), values(), REST
    )


def estimate(law):
    return np.array([law.state[f"tank_{j}.level.estimate"] for j in (1, 2, 3)])


def outputs(found):
    return np.array([found["pump_1.out"], found["pump_2.out"]])


def test_zeros_of_the_matrices_are_no_parameters():
    law = state_feedback_law(LEVELS, PUMPS, ["level_2"], observer=STRUCTURE)
    names = [signal.name for signal in law.parameters]
    assert [signal.name for signal in law.parameters if signal.matrix == "transition"] == [
        f"tank_{j}.level.transition.tank_{k}.level"
        for j, k in ((1, 1), (1, 2), (2, 2), (2, 3), (3, 3))
    ]
    assert "level_1.observation.tank_2.level" not in names
    assert "tank_3.level.input_effect.pump_1" not in names


def test_equals_the_matrix_equations(law):
    expected, fading, saturated = np.zeros(3), np.array([0.7, -0.4]), 0
    law.state |= {"pump_1.integral": 0.7, "pump_2.integral": -0.4}
    for _ in range(300):
        y, r = REFERENCE + rng.normal(size=2) * 9.0, 6.0 + 4.0 * rng.normal()
        corrected = expected + CORRECTION @ (y - REFERENCE - SHOWN @ expected)
        unlimited = BIAS - FEEDBACK @ corrected + AHEAD[:, 0] * (r - REFERENCE[1]) + fading
        u = np.clip(unlimited, 0.0, 10.0)
        expected = HELD @ corrected + MOVED @ (u - BIAS)
        further = (unlimited - u) * -fading > 0
        fading = np.where(further, fading, fading * (1 - STEP / FADING))
        found = law.scan(**inputs(y, r))
        assert outputs(found) == pytest.approx(u, abs=1e-12)
        assert estimate(law) == pytest.approx(expected, abs=1e-12)
        saturated += int(np.any(u != unlimited))
    assert 20 < saturated < 280


def test_without_an_observer_the_measurements_are_the_state(driven):
    numbers = {name: value for name, value in values().items() if "tank" not in name}
    numbers |= {
        f"pump_{i}.feedback.level_{j}": FEEDBACK[i - 1, j - 1] for i in (1, 2) for j in (1, 2, 3)
    }
    numbers |= {"level_3.reference": 7.0}
    rest = {name: value for name, value in REST.items() if not name.endswith(".estimate")}
    law = driven(state_feedback_law([*LEVELS, "level_3"], PUMPS, ["level_2"]), numbers, rest)
    y = np.array([5.1, 6.2, 6.7])
    given = inputs(y[:2], 6.5) | {"level_3.pv": y[2], "level_3.good": 1.0}
    expected = BIAS - FEEDBACK @ (y - [5.0, 6.0, 7.0]) + AHEAD[:, 0] * 0.5
    assert outputs(law.scan(**given)) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("name", ["state feedback", "LQI"])
def test_hand_and_saturation_do_not_mislead_the_observer(driven, name):
    """The error of the estimate follows (I − M C) Φ whatever is done to the inputs."""
    numbers = values() | {f"pump_{i}.integral_gain.level_2": 0.5 for i in (1, 2)}
    kind = state_feedback_law if name == "state feedback" else lqi_law
    options = () if name == "state feedback" else ("conditional_integration",)
    law = driven(kind(LEVELS, PUMPS, ["level_2"], *options, observer=STRUCTURE), numbers, REST)
    x = np.array([3.0, -2.0, 1.0])
    error = x.copy()
    modes = []
    for k in range(120):
        given = inputs(REFERENCE + SHOWN @ x, 6.0 + 5.0 * np.sin(0.2 * k))
        if 20 <= k < 40:
            given |= {"pump_1.mode": 0, "pump_1.manual": 20.0 * np.sin(k)}
        if 40 <= k < 60:
            given |= {
                "pump_1.mode": 2,
                "pump_1.tracking": 7.0,
                "pump_2.mode": 0,
                "pump_2.manual": 1.0,
            }
        if 60 <= k < 80:
            given |= {"pump_2.mode": 5}  # held
        u = outputs(law.scan(**given))
        modes.append(np.any((u == 0.0) | (u == 10.0)))
        x = HELD @ x + MOVED @ (u - BIAS)
        error = HELD @ (error - CORRECTION @ SHOWN @ error)
        assert x - estimate(law) == pytest.approx(error, abs=1e-11)
    assert any(modes)
    assert not all(modes)


def test_from_hand_to_automatic_there_is_no_bump_and_the_bias_fades(law):
    y, r = REFERENCE + [0.3, -0.2], 6.4
    # At rest under the operator's hand, so that the estimate does not move any more.
    for _ in range(400):
        law.scan(
            **inputs(y, r, pump_1_mode=0, pump_1_manual=4.5, pump_2_mode=2, pump_2_tracking=4.0)
        )
    first = outputs(law.scan(**inputs(y, r)))
    assert first == pytest.approx([4.5, 4.0], abs=1e-9)
    before = law.state["pump_1.integral"]
    law.scan(**inputs(y, r))
    assert law.state["pump_1.integral"] == pytest.approx(before * (1 - STEP / FADING), rel=1e-12)
    for _ in range(3000):
        law.scan(**inputs(y, r))
    assert abs(law.state["pump_1.integral"]) < 1e-12


def test_a_bias_does_not_fade_into_saturation(law):
    law.values |= {"pump_1.bias": 12.0}
    law.state |= {"pump_1.integral": -1.0}
    law.scan(**inputs(REFERENCE, REFERENCE[1]))
    assert law.state["pump_1.integral"] == -1.0


@pytest.mark.parametrize("fault", [{"level_2.good": 0.0}, {"level_1.pv": math.nan}])
def test_a_fault_holds_the_outputs_while_the_observer_goes_on(law, fault):
    law.state |= {"tank_1.level.estimate": 1.0, "tank_3.level.estimate": -0.5}
    found = law.scan(**inputs(REFERENCE + 1.0, 6.0, **fault))
    assert outputs(found) == pytest.approx([4.0, 5.0], abs=0)
    assert estimate(law) == pytest.approx(HELD @ [1.0, 0.0, -0.5], abs=1e-14)
    # An operator can still move an output, and the observer hears of it.
    found = law.scan(**inputs(REFERENCE + 1.0, 6.0, **fault, pump_1_mode=0, pump_1_manual=9.0))
    assert outputs(found) == pytest.approx([9.0, 5.0], abs=0)
    expected = HELD @ HELD @ [1.0, 0.0, -0.5] + MOVED @ [5.0, 0.0]
    assert estimate(law) == pytest.approx(expected, abs=1e-14)


def test_a_setpoint_that_is_no_number_leaves_the_correction(law):
    found = law.scan(**inputs(REFERENCE + [1.0, 0.0], math.nan))
    assert outputs(found) == pytest.approx([4.0, 5.0], abs=0)
    assert estimate(law) == pytest.approx(HELD @ CORRECTION @ [1.0, 0.0], abs=1e-14)


@pytest.mark.parametrize("time_step", [0.0, -1.0, math.nan])
def test_the_estimate_stays_where_the_time_step_is_unusable(law, time_step):
    law.state |= {"tank_1.level.estimate": 1.0}
    found = law.scan(**inputs(REFERENCE, 6.0, time_step=time_step))
    assert estimate(law) == pytest.approx([1.0, 0.0, 0.0], abs=0)
    assert int(found["pump_1.status"]) & 64


def test_numbers_that_run_over_do_not_get_into_the_estimate(law):
    law.values |= {name: 1e9 for name in law.values if ".correction." in name}
    law.scan(**inputs([1e300, -1e300], 6.0))
    assert np.all(np.isfinite(estimate(law)))


def test_an_observer_that_nobody_can_check_is_refused():
    yes, states = np.ones((65, 65), bool), tuple(Signal(f"x_{j}") for j in range(65))
    with refused(expected="1 to 64"):
        ObserverStructure(states, yes, yes[:, :1], yes[:1], yes[:, :1])


def test_structures_with_numbers_in_the_same_places_are_one():
    again = replace(STRUCTURE, transition=STRUCTURE.transition.copy())
    assert again == STRUCTURE and hash(again) == hash(STRUCTURE)
    assert replace(STRUCTURE, moved=~STRUCTURE.moved) != STRUCTURE
    assert replace(STRUCTURE, estimated=STRUCTURE.estimated[::-1]) != STRUCTURE
