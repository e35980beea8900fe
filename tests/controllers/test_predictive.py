"""Linear model predictive control: its plan, its fallback, and what it does to a plant."""

import casadi as ca
import numpy as np
import pytest

from clepsydra.base.signal import Signal
from clepsydra.controllers.predictive.law import predictive_law
from clepsydra.controllers.predictive.prediction import Prediction, TabledObserver

ONE = np.ones((1, 1))
LEVEL, PUMP = Signal("level", "m", low=0.0, high=10.0), Signal("pump", "V", low=0.0, high=5.0)
STATE = Signal("tank.level", "m", low=0.0, high=10.0)


#: A tank that loses a tenth in a sample and gains the input, seen exactly.
OBSERVER = TabledObserver((STATE,), 0.9 * ONE, ONE, ONE, ONE)


def prediction(blocks, bounded):
    """The tank over some blocks, from its level, its setpoint and its last input."""
    n, level, by_moves = len(blocks), np.array([1.0, 0.0, 0.0]), np.zeros(len(blocks))
    curves, slopes, ends = np.zeros((n, n)), np.zeros((n, 3)), []
    for block, length in enumerate(blocks):
        for _ in range(length):
            level, by_moves = 0.9 * level + [0.0, 0.0, 1.0], 0.9 * by_moves + np.eye(n)[block]
            curves += np.outer(by_moves, by_moves)
            slopes += np.outer(by_moves, level - [0.0, 1.0, 0.0])
        ends.append((level, by_moves))
    reached, moved = (np.array(each)[None][: len(bounded)] for each in zip(*ends, strict=True))
    return Prediction(blocks, curves[None], slopes[None], bounded, reached, moved)


def sample(law, given, **values):
    """Return outputs and next state of one sample by name."""
    usual = {"good": 1.0, "mode": 1.0, "time_step": 1.0}
    inputs = [given.get(each.name, usual.get(each.part, 0.0)) for each in law.inputs]
    state = [given.get(each.name, 0.0) for each in law.state]
    own = {"largest_error": 1.0, "largest_move": 1.0, "move_weight": 1e-6, "high_limit": 5.0}
    own |= {"high_bound": 9.0, "rate_limit": 0.5}
    named = [values.get(p.name, own.get(p.part, own.get(p.name, 0.0))) for p in law.parameters]
    following, outputs, _ = law.function(state, inputs, named)
    names = [each.name for each in (*law.state, *law.outputs)]
    values = ca.vertcat(following, outputs).full().ravel().tolist()
    return dict(zip(names, values, strict=True))


def law_of(blocks, *, rate_limited=False, bounded=()):
    ahead = prediction(blocks, bounded)
    return predictive_law([LEVEL], [PUMP], ["level"], OBSERVER, ahead, rate_limited=rate_limited)


def test_it_reaches_the_setpoint_in_a_sample_where_the_input_can():
    found = sample(law_of((1,)), {"level.sp": 2.0, "level.pv": 1.0})
    assert found["pump.out"] == pytest.approx(2.0 - 0.9, rel=1e-5)
    assert found["tank.level.estimate"] == pytest.approx(2.0, rel=1e-5)
    assert found["unsolved"] == 0.0


def test_it_stays_within_the_limits_of_the_input():
    found = sample(law_of((1, 1, 2)), {"level.sp": 8.0, "level.pv": 0.0})
    assert found["pump.out"] == pytest.approx(5.0, abs=1e-9)
    assert found["unsolved"] == 0.0


def test_a_rate_that_is_limited_limits_each_move():
    law = law_of((1, 1, 2), rate_limited=True)
    found = sample(law, {"level.sp": 8.0, "level.pv": 0.0, "pump.last_output": 1.0})
    assert found["pump.out"] == pytest.approx(1.5, abs=1e-9)


def test_a_level_stays_below_its_soft_bound_though_its_setpoint_is_above():
    law = law_of((1, 1, 2), bounded=(0,))
    free = sample(law, {"level.sp": 9.5, "level.pv": 8.0})
    held = sample(law, {"level.sp": 9.5, "level.pv": 8.0}, **{"tank.level.high_bound": 8.5})
    # To a percent of the range of 10 m.
    assert free["tank.level.estimate"] == pytest.approx(9.0, abs=0.1)
    assert held["tank.level.estimate"] == pytest.approx(8.5, abs=0.1)


def test_a_level_above_its_bound_has_a_plan_all_the_same():
    law = law_of((1, 1, 2), bounded=(0,))
    found = sample(law, {"level.sp": 9.5, "level.pv": 9.9}, **{"tank.level.high_bound": 2.0})
    assert found["pump.out"] == pytest.approx(0.0, abs=1e-6)
    assert found["unsolved"] == 0.0


@pytest.mark.parametrize("mode", [0.0, 2.0])
def test_an_input_that_an_operator_has_stays_in_the_plan(mode):
    law = law_of((1, 1, 2))
    given = {"level.sp": 8.0, "level.pv": 0.0, "pump.mode": mode, "pump.last_output": 3.0}
    given |= {"pump.manual": 2.5, "pump.tracking": 2.5}
    found = sample(law, given)
    assert found["pump.out"] == 2.5
    assert found["unsolved"] == 0.0


@pytest.mark.parametrize(
    "broken",
    [{"level.largest_error": 1e200}, {"move_weight": 1e300}, {"pump.largest_move": 1e-200}],
)
def test_numbers_that_run_over_leave_a_finite_output(broken):
    found = sample(law_of((1, 1, 2)), {"level.sp": 8.0, "pump.last_output": 1.0}, **broken)
    assert 0.0 <= found["pump.out"] <= 5.0
    assert np.isfinite([*found.values()]).all()


def test_limits_that_exclude_each_other_are_counted_and_the_output_is_one_of_them():
    law = law_of((1, 1, 2))
    given = {"level.sp": 8.0, "level.pv": 0.0, "pump.last_output": 3.0, "unsolved": 4.0}
    found = sample(law, given, **{"pump.low_limit": 4.0, "pump.high_limit": 2.0})
    assert found["pump.out"] in (2.0, 4.0)
    assert found["unsolved"] == 5.0


def test_a_bad_sensor_holds_the_output_and_the_observer_goes_on():
    given = {
        "level.sp": 8.0,
        "level.good": 0.0,
        "pump.last_output": 1.0,
        "tank.level.estimate": 3.0,
    }
    found = sample(law_of((1, 1, 2)), given)
    assert found["pump.out"] == 1.0
    assert found["tank.level.estimate"] == pytest.approx(0.9 * 3.0 + 1.0)
