"""No bump in a scheme: local and remote in a cascade, the selection of an override, and legs of a
split range by hand. Bounds to 1e-9 of the output's range, as for one loop."""

import math
from itertools import pairwise

import numpy as np
import pytest
from pid_rig import AUTOMATIC, BUMP, MANUAL, Scans
from scheme_rig import cascade, override, split_range

STEP = 0.5


def loop_settings(number, gain, integral_time):
    return {
        f"proportional_gain_{number}": gain,
        f"integral_time_{number}": integral_time,
        f"tracking_time_{number}": integral_time,
    }


def level(sample):
    return 5.0 + 0.3 * math.sin(0.1 * sample)


def flow(sample):
    return 8.0 + 0.5 * math.sin(0.17 * sample + 1.0)


def moving_cascade(samples=60):
    """A cascade in the midst of a transient, its last output and the number of the next sample."""
    scheme = Scans(
        cascade(), loop_settings(1, 4.0, 40.0) | loop_settings(2, 3.0, 5.0),
        setpoint_1=5.1, measurement_1=5.0, measurement_2=8.0, local_setpoint_2=11.0,
        tracking_1=50.0, time_step=STEP,
    )  # fmt: skip
    for sample in range(samples):
        output = scheme.moved(measurement_1=level(sample), measurement_2=flow(sample))
    assert 20.0 < output < 80.0
    return scheme, output, samples


def test_an_inner_loop_goes_to_local_and_back_to_remote_without_a_bump():
    scheme, last, sample = moving_cascade()
    for source in (0, 1, 0):
        found = scheme.moved(
            measurement_1=level(sample), measurement_2=flow(sample), setpoint_source_2=source
        )
        # The integral goes on from what was applied, whatever the new setpoint is.
        assert found == pytest.approx(last, abs=BUMP)
        # In force from then on: K/Ti · e with the new setpoint, and K on what the flow did.
        setpoint = scheme.state["working_setpoint_2"]
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
            last = scheme.moved(measurement_1=level(sample), measurement_2=flow(sample))
        sample += 1


def test_in_local_the_outer_loop_follows_the_setpoint_that_the_operator_gives():
    scheme, _, sample = moving_cascade()
    for local in (11.0, 9.0):
        for _ in range(3):
            scheme.moved(setpoint_source_2=0, local_setpoint_2=local)
        scheme.moved(measurement_1=level(sample))
        sample += 1
        # So in remote it asks for just that: no move of the setpoint at all.
        remote = scheme.twin()
        remote.moved(setpoint_source_2=1)
        assert remote.state["working_setpoint_2"] == pytest.approx(local, abs=1e-9 * 20.0)


def test_an_outer_measurement_that_fails_leaves_the_inner_loop_in_control():
    scheme, _, sample = moving_cascade()
    setpoint = scheme.state["working_setpoint_2"]
    outputs = []
    for _ in range(5):
        outputs.append(scheme.moved(measurement_1=math.nan, measurement_2=flow(sample)))
        assert scheme.state["working_setpoint_2"] == setpoint
    steps = np.diff(outputs)
    assert steps == pytest.approx(STEP * 3.0 / 5.0 * (setpoint - flow(sample)), abs=1e-9)
    # Repaired where it was, the setpoint goes on from the integral that stood still.
    integral = scheme.state["integral_1"]
    scheme.moved(measurement_1=level(sample - 1))
    expected = integral + 4.0 * (5.1 - level(sample - 1))
    assert scheme.state["working_setpoint_2"] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    "name", ["proportional_gain_1", "proportional_gain_2", "integral_time_1", "integral_time_2"]
)
def test_a_gain_of_either_loop_of_a_cascade_changes_without_a_bump(name):
    scheme, _, sample = moving_cascade()
    given = {"measurement_1": level(sample), "measurement_2": flow(sample)}
    unchanged = scheme.twin().moved(**given)
    scheme.set(**{name: 5.0 * scheme.values[name]})
    assert scheme.moved(**given) == pytest.approx(unchanged, abs=BUMP)


@pytest.mark.parametrize("selection", ["low", "high"])
def test_a_change_of_the_selection_moves_the_output_no_more_than_the_loops_move(selection):
    """The lowest of two values moves no more than the one of them that moves most."""
    scheme = Scans(
        override(selection), loop_settings(1, 10.0, 20.0) | loop_settings(2, 2.0, 8.0),
        setpoint_1=5.0, measurement_1=5.0, setpoint_2=8.0, measurement_2=8.0, tracking_1=50.0,
        time_step=STEP,
    )  # fmt: skip
    names = [signal.name for signal in scheme.law.intermediates]
    places = [names.index(f"unlimited_{number}") for number in (1, 2)]
    pick = min if selection == "low" else max
    asked, outputs, selected = [], [], []
    for sample in range(600):
        scheme.give({"measurement_1": level(sample), "measurement_2": flow(sample)})
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
        loop_settings(1, 30.0, 15.0), setpoint_1=5.2, measurement_1=5.2, tracking_1=50.0,
        tracking_2=0.0, time_step=STEP,
    )  # fmt: skip
    for sample in range(samples):
        found = scheme.scan(measurement_1=5.0 - 0.02 * sample)
    return scheme, found


def test_a_leg_goes_to_hand_and_back_where_it_stands_without_a_bump():
    scheme, found = moving_split()
    pump, valve = found["manipulated_1"], found["manipulated_2"]
    assert 0.0 < valve < 100.0
    twin = scheme.twin()
    by_hand = scheme.scan(mode_2=MANUAL, manual_2=valve)
    assert by_hand["manipulated_2"] == valve
    assert by_hand["manipulated_1"] == pytest.approx(twin.scan()["manipulated_1"], abs=BUMP)
    assert by_hand["manipulated_1"] == pump
    # Moved by hand it moves nothing else, and the loop goes on as it would with both legs.
    for value in (10.0, 90.0, 30.0):
        assert scheme.scan(manual_2=value)["manipulated_1"] == twin.scan()["manipulated_1"]
    # Brought to where the loop asks for it, it goes back without a bump.
    asked = twin.scan()["manipulated_2"]
    scheme.scan(manual_2=asked)
    gained = twin.scan()["manipulated_2"] - asked
    back = scheme.scan(mode_2=AUTOMATIC)
    assert back["manipulated_2"] - asked == pytest.approx(gained, abs=BUMP)


@pytest.mark.parametrize("place", [0.0, 12.5, 40.0, 60.0, 71.0, 100.0])
def test_both_legs_by_hand_and_back(place):
    """From any place of the range, the gap between the parts included, both go on from there."""
    scheme, _ = moving_split()
    pump = 100.0 * (1.0 - min(place / 40.0, 1.0))
    valve = 100.0 * min(max((place - 60.0) / 40.0, 0.0), 1.0)
    for _ in range(3):
        scheme.scan(mode_1=MANUAL, manual_1=pump, mode_2=MANUAL, manual_2=valve)
    for modes in ({"mode_1": AUTOMATIC, "mode_2": AUTOMATIC}, {"mode_1": AUTOMATIC}):
        found = scheme.twin().scan(**modes)
        assert found["manipulated_1"] == pytest.approx(pump, abs=BUMP)
        assert found["manipulated_2"] == pytest.approx(valve, abs=BUMP)
