"""The sampled model of tanks whose output is told late: it is exact in every sample."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.designs.sampled.sampled_process import sampled_process, sampled_states

DELAYS = cl.load(Path(__file__).parents[1] / "dead-time.toml").linear.delays
RATES, PERIOD = np.array([0.02, 0.05]), 5.0


def tanks(age: float) -> cl.LinearModel:
    """Two tanks side by side, each with an inflow of its own; the level of the second is late."""
    late = replace(
        DELAYS, times=np.array([age]), to_states=np.zeros((2, 1)),
        from_states=np.array([[0.0, 2.0]]), from_inputs=np.zeros((1, 2)),
        from_disturbances=np.zeros((1, 0)), through=np.zeros((1, 1)),
        to_outputs=np.array([[0.0], [1.0], [0.0]]),
    )  # fmt: skip
    C = np.array([[1.0, 0.0], [0.0, 0.0], [1.0, 1.0]])
    return cl.LinearModel(
        -np.diag(RATES), np.eye(2), np.zeros((2, 0)), C, np.zeros((3, 2)),
        ("one.level", "two.level"), ("first", "second"), (), ("one", "two", "both"),
        delays=late,
    )  # fmt: skip


def lag(time, rate):
    """Return the step response of 1/(s + a)."""
    return np.where(time > 0.0, (1.0 - np.exp(-rate * time)) / rate, 0.0)


@pytest.mark.parametrize("age", [5.0, 40.0, 2.5, 41.25])
def test_samples_equal_the_exact_step_response(age):
    sampled = sampled_process(tanks(age), PERIOD)
    state, steps = np.zeros((len(sampled.held), 2)), []
    for _ in range(80):
        steps.append(sampled.shown @ state)
        state = sampled.held @ state + sampled.moved
    time = PERIOD * np.arange(80)
    first, late, none = lag(time, RATES[0]), lag(time - age, RATES[1]), 0.0 * time
    expected = np.array([[first, none], [none, 2.0 * late], [first, lag(time, RATES[1])]])
    # What 80 sums round, of numbers of up to 50.
    assert np.abs(np.array(steps) - expected.transpose(2, 0, 1)).max() < 80 * 50 * 1e-15


def test_what_is_on_its_way_is_named_by_what_it_was():
    on_the_way = sampled_states(tanks(15.0), PERIOD)[2:]
    assert on_the_way == [("two", 5.0), ("two", 10.0), ("two", 15.0)]
