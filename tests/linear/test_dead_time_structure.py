"""Where dead times stand, and what that makes of poles and zeros."""

import dataclasses

import numpy as np
import pytest

from clepsydra import LinearModel
from clepsydra.linear.dead_time import at_rest, dead_times, has_delay_in_loop, lags_of
from clepsydra.linear.linear_model import InternalDelays
from clepsydra.linear.response import frequency_response
from clepsydra.linear.roots import roots_of


def row_of_tanks(first=5.0, second=3.0, back=0.0):
    """Return two tanks with a pipe behind the pump and one between them, sensors on both."""
    delays = InternalDelays(
        times=np.array([first, second]),
        to_states=np.array([[0.04, back], [0.0, 0.05]]),
        from_states=np.array([[0.0, 0.0], [1.0, 0.0]]),
        from_inputs=np.array([[1.0, 0.0], [0.0, 0.0]]),
        from_disturbances=np.zeros((2, 0)),
        through=np.zeros((2, 2)),
        to_outputs=np.zeros((2, 2)),
    )
    A, B = np.diag([-0.02, -0.05]), np.array([[0.0, 0.0], [0.0, 0.3]])
    names = ("tank_1.level", "tank_2.level"), ("u", "v"), (), ("y", "z")
    return LinearModel(A, B, np.zeros((2, 0)), np.eye(2), np.zeros((2, 2)), *names, delays=delays)


def test_dead_times_add_up_along_the_way():
    assert dead_times(row_of_tanks()).tolist() == [[5.0, 0.0], [8.0, 0.0]]


def test_lags_turn_the_response_into_that_without_dead_time():
    model, omegas = row_of_tanks(), np.array([0.003, 0.05, 0.4, 3.0])
    lags, s = lags_of(model), 1j * omegas[:, None, None]
    shifted = frequency_response(at_rest(model), omegas)
    shifted = np.exp(-s * lags.outputs[:, None]) * shifted * np.exp(s * lags.inputs)
    assert frequency_response(model, omegas) == pytest.approx(shifted, abs=1e-12)


def test_two_ways_of_different_dead_time_have_none():
    model = row_of_tanks()
    fed = dataclasses.replace(model, B=np.array([[0.0, 0.0], [0.1, 0.3]]))
    assert np.isnan(dead_times(fed)[1, 0])
    assert lags_of(fed) is None
    assert lags_of(fed.select(["y"], ["u"])) is not None
    assert not has_delay_in_loop(fed)


def test_poles_without_a_loop_are_those_of_the_tanks():
    roots = roots_of(row_of_tanks())
    assert roots.poles.real == pytest.approx([-0.02, -0.05], rel=1e-12)
    assert "exact" in roots.note
    assert not roots.minimum_phase


def test_a_loop_with_dead_time_is_seen_and_its_poles_are_roots():
    model = row_of_tanks(back=0.01)
    assert has_delay_in_loop(model)
    roots = roots_of(model)
    # s + 0.02 = 0.01 e^(-3s): what leaves tank 1 comes back 3 s later.
    slow = roots.poles[0].real
    assert slow + 0.02 - 0.01 * np.exp(-3.0 * slow) == pytest.approx(0.0, abs=1e-12)
    assert "Padé" in roots.note


def test_zeros_of_one_channel_with_two_ways_are_those_of_the_exact_response():
    # y = (1 - 0.5 e^(-2s)) / (s + 1): zeros at s = -ln 2 / 2 ± jkπ.
    delays = InternalDelays(
        times=np.array([2.0]),
        to_states=np.array([[-0.5]]),
        from_states=np.zeros((1, 1)),
        from_inputs=np.ones((1, 1)),
        from_disturbances=np.zeros((1, 0)),
        through=np.zeros((1, 1)),
        to_outputs=np.zeros((1, 1)),
    )
    one = np.eye(1)
    model = LinearModel(-one, one, one[:, :0], one, 0 * one, ("x",), ("u",), (), ("y",),
                        delays=delays)  # fmt: skip
    zeros = roots_of(model).zeros
    nearest = zeros[np.argmin(np.abs(zeros))]
    assert nearest == pytest.approx(-np.log(2.0) / 2.0, abs=1e-6)
