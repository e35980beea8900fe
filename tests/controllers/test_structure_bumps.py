"""No bump in a scheme: local and remote in a cascade, the selection of an override, and legs of a
split range by hand. Bounds to 1e-9 of the output's range, as for one loop."""

import math
from itertools import pairwise

import numpy as np
import pytest
from pid_rig import AUTOMATIC, BUMP, MANUAL, Scans
from scheme_rig import cascade, override, split_range

STEP = 0.5


def loop_settings(loop, gain, integral_time):
    return {
        f"{loop}.proportional_gain": gain,
        f"{loop}.integral_time": integral_time,
        f"{loop}.tracking_time": integral_time,
    }


def level(sample):
    return 5.0 + 0.3 * math.sin(0.1 * sample)


def flow(sample):
    return 8.0 + 0.5 * math.sin(0.17 * sample + 1.0)


def moving_cascade(samples=60):
    """A cascade in the midst of a transient, its last output and the number of the next sample."""
    scheme = Scans(
        cascade(), loop_settings("level", 4.0, 40.0) | loop_settings("flow", 3.0, 5.0),
        level_sp=5.1, level_pv=5.0, flow_pv=8.0, flow_local_setpoint=11.0,
        pump_tracking=50.0, time_step=STEP,
    )  # fmt: skip
    for sample in range(samples):
        output = scheme.moved(level_pv=level(sample), flow_pv=flow(sample))
    assert 20.0 < output < 80.0
    return scheme, output, samples


def test_an_inner_loop_goes_to_local_and_back_to_remote_without_a_bump():
    scheme, last, sample = moving_cascade()
    for source in (0, 1, 0):
        found = scheme.moved(
            level_pv=level(sample), flow_pv=flow(sample), flow_setpoint_source=source
        )
        # The integral goes on from what was applied, whatever the new setpoint is.
        assert found == pytest.approx(last, abs=BUMP)
        # In force from then on: K/Ti · e with the new setpoint, and K on what the flow did.
        setpoint = scheme.state["flow.working_setpoint"]
        assert (setpoint == 11.0) == (source == 0)
        following = scheme.twin().moved()
        inner = STEP * 3.0 / 5.0 * (setpoint - flow(sample))
        outer = 0.0
        if source == 1:
            outer = STEP * 4.0 / 40.0 * (5.1 - level(sample)) * 3.0
        assert following - found == pytest.approx(inner + outer, abs=BUMP)
        last = found
        for _ in range(5):
            sample += 1
            last = scheme.moved(level_pv=level(sample), flow_pv=flow(sample))
        sample += 1


def test_in_local_the_outer_loop_follows_the_setpoint_that_the_operator_gives():
    scheme, _, sample = moving_cascade()
    for local in (11.0, 9.0):
        for _ in range(3):
            scheme.moved(flow_setpoint_source=0, flow_local_setpoint=local)
        scheme.moved(level_pv=level(sample))
        sample += 1
        # So in remote it asks for just that: no move of the setpoint at all.
        remote = scheme.twin()
        remote.moved(flow_setpoint_source=1)
        assert remote.state["flow.working_setpoint"] == pytest.approx(local, abs=1e-9 * 20.0)


def test_an_outer_measurement_that_fails_leaves_the_inner_loop_in_control():
    scheme, _, sample = moving_cascade()
    setpoint = scheme.state["flow.working_setpoint"]
    outputs = []
    for _ in range(5):
        outputs.append(scheme.moved(level_pv=math.nan, flow_pv=flow(sample)))
        assert scheme.state["flow.working_setpoint"] == setpoint
    steps = np.diff(outputs)
    assert steps == pytest.approx(STEP * 3.0 / 5.0 * (setpoint - flow(sample)), abs=1e-9)
    # Repaired where it was, the setpoint goes on from the integral that stood still.
    integral = scheme.state["level.integral"]
    scheme.moved(level_pv=level(sample - 1))
    expected = integral + 4.0 * (5.1 - level(sample - 1))
    assert scheme.state["flow.working_setpoint"] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    "name",
    [
        "level.proportional_gain",
        "flow.proportional_gain",
        "level.integral_time",
        "flow.integral_time",
    ],
)
def test_a_gain_of_either_loop_of_a_cascade_changes_without_a_bump(name):
    scheme, _, sample = moving_cascade()
    given = {"level.pv": level(sample), "flow.pv": flow(sample)}
    unchanged = scheme.twin().moved(**given)
    scheme.set(**{name: 5.0 * scheme.values[name]})
    assert scheme.moved(**given) == pytest.approx(unchanged, abs=BUMP)


@pytest.mark.parametrize("selection", ["low", "high"])
def test_a_change_of_the_selection_moves_the_output_no_more_than_the_loops_move(selection):
    """The lowest of two values moves no more than the one of them that moves most."""
    scheme = Scans(
        override(selection), loop_settings("level", 10.0, 20.0) | loop_settings("flow", 2.0, 8.0),
        level_sp=5.0, level_pv=5.0, flow_sp=8.0, flow_pv=8.0, pump_tracking=50.0,
        time_step=STEP,
    )  # fmt: skip
    names = [signal.name for signal in scheme.law.intermediates]
    places = [names.index(f"{loop}.unlimited") for loop in ("level", "flow")]
    pick = min if selection == "low" else max
    asked, outputs, selected = [], [], []
    for sample in range(600):
        scheme.give({"level.pv": level(sample), "flow.pv": flow(sample)})
        values = list(scheme.inputs.values()), list(scheme.values.values())
        intermediates = np.array(scheme.law.function(list(scheme.state.values()), *values)[2])
        asked.append(intermediates.ravel()[places])
        outputs.append(scheme.moved())
        assert outputs[-1] == pick(asked[-1])
        selected.append(int(asked[-1][1] == outputs[-1]))
    changes = sum(first != second for first, second in pairwise(selected))
    assert changes >= 6
    moves = np.abs(np.diff(outputs))
    assert np.all(moves <= np.max(np.abs(np.diff(asked, axis=0)), axis=1) + BUMP)
    # And in figures: K times what the measurements do in a sample, and the integrals.
    largest = max(10.0 * 0.03 + STEP * 0.5 * 0.3, 2.0 * 0.5 * 0.17 + STEP * 0.25 * 0.5) + 0.2
    assert np.max(moves) < largest


def moving_split(samples=40):
    scheme = Scans(
        split_range((0.0, 40.0, 100.0, 0.0), (60.0, 100.0, 0.0, 100.0)),
        loop_settings("level", 30.0, 15.0), level_sp=5.2, level_pv=5.2, pump_tracking=50.0,
        valve_tracking=0.0, time_step=STEP,
    )  # fmt: skip
    for sample in range(samples):
        found = scheme.scan(level_pv=5.0 - 0.02 * sample)
    return scheme, found


def test_a_leg_goes_to_hand_and_back_where_it_stands_without_a_bump():
    scheme, found = moving_split()
    pump, valve = found["pump.out"], found["valve.out"]
    assert 0.0 < valve < 100.0
    twin = scheme.twin()
    by_hand = scheme.scan(valve_mode=MANUAL, valve_manual=valve)
    assert by_hand["valve.out"] == valve
    assert by_hand["pump.out"] == pytest.approx(twin.scan()["pump.out"], abs=BUMP)
    assert by_hand["pump.out"] == pump
    # Moved by hand it moves nothing else, and the loop goes on as it would with both legs.
    for value in (10.0, 90.0, 30.0):
        assert scheme.scan(valve_manual=value)["pump.out"] == twin.scan()["pump.out"]
    # Brought to where the loop asks for it, it goes back without a bump.
    asked = twin.scan()["valve.out"]
    scheme.scan(valve_manual=asked)
    gained = twin.scan()["valve.out"] - asked
    back = scheme.scan(valve_mode=AUTOMATIC)
    assert back["valve.out"] - asked == pytest.approx(gained, abs=BUMP)


@pytest.mark.parametrize("place", [0.0, 12.5, 40.0, 60.0, 71.0, 100.0])
def test_both_legs_by_hand_and_back(place):
    """From any place of the range, the gap between the parts included, both go on from there."""
    scheme, _ = moving_split()
    pump = 100.0 * (1.0 - min(place / 40.0, 1.0))
    valve = 100.0 * min(max((place - 60.0) / 40.0, 0.0), 1.0)
    for _ in range(3):
        scheme.scan(pump_mode=MANUAL, pump_manual=pump, valve_mode=MANUAL, valve_manual=valve)
    for modes in ({"pump.mode": AUTOMATIC, "valve.mode": AUTOMATIC}, {"pump.mode": AUTOMATIC}):
        found = scheme.twin().scan(**modes)
        assert found["pump.out"] == pytest.approx(pump, abs=BUMP)
        assert found["valve.out"] == pytest.approx(valve, abs=BUMP)
