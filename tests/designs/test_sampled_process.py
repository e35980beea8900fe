"""The sampled model with dead time, against the exact step response and the transfer function."""

import numpy as np
import pytest

from clepsydra import LinearModel
from clepsydra.designs.sampled.sampled_process import NotSampled, sampled_process
from clepsydra.linear.internal_delays import InternalDelays
from clepsydra.linear.step_response import step_response


def three_tanks(first, second, third):
    """Return three tanks in a row with two inputs, a pipe behind each input and tank."""
    A = np.diag([-0.02, -0.05, -0.01])
    A[2, 0] = 0.003
    B = np.array([[0.0, 0.0], [0.0, 0.3], [0.0, 0.0]])
    C = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 2.0]])
    delays = InternalDelays(
        times=np.array([first, second, third]),
        to_states=np.array([[0.04, 0.0, 0.0], [0.0, 0.05, 0.0], [0.0, 0.0, 0.07]]),
        from_states=np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        from_inputs=np.array([[1.0, 0.0], [0.0, 0.2], [0.0, 0.0]]),
        from_disturbances=np.zeros((3, 0)),
        # What entered the second pipe from the first goes on into it at once, in part.
        through=np.array([[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.0, 0.0, 0.0]]),
        to_outputs=np.zeros((2, 3)),
    )
    names = ("a", "b", "c"), ("u", "v"), (), ("y", "z")
    return LinearModel(A, B, np.zeros((3, 0)), C, np.zeros((2, 2)), *names, delays=delays)


@pytest.mark.parametrize(
    "times", [(4.0, 6.0, 2.0), (5.0, 3.0, 7.0), (0.5, 11.25, 1.75), (2.0, 2.0, 2.0)]
)
def test_samples_equal_the_exact_step_response(times):
    model, period, samples = three_tanks(*times), 2.0, 120
    sampled = sampled_process(model, period)
    shown = np.hstack([model.C, np.zeros((2, len(sampled.held) - 3))])
    state = np.zeros((len(sampled.held), 2))
    steps = []
    for _ in range(samples):
        steps.append(shown @ state)
        state = sampled.held @ state + sampled.moved
    exact = step_response(model, period * np.arange(samples))
    assert np.abs(exact[-1]).min() > 0.1
    # What adding up rounds: in each of the samples a sum over the states, of up to the largest.
    rounding = samples * len(state) * np.finfo(float).eps * np.abs(exact).max()
    np.testing.assert_allclose(steps, exact, rtol=0.0, atol=rounding)


def test_first_states_are_those_of_the_process_at_the_sampling_instants():
    model = three_tanks(3.0, 5.0, 4.0)
    sampled = sampled_process(model, 2.0)
    slow = np.sort(np.abs(np.linalg.eigvals(sampled.held)))[-3:]
    assert slow == pytest.approx(np.exp(2.0 * np.array([-0.05, -0.02, -0.01])), rel=1e-9)


def test_dead_time_in_a_loop_is_refused():
    model = three_tanks(3.0, 5.0, 4.0)
    late = model.delays
    back = InternalDelays(
        late.times,
        late.to_states + np.array([[0.0, 0.0, 0.01], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]),
        late.from_states,
        late.from_inputs,
        late.from_disturbances,
        late.through,
        late.to_outputs,
    )
    looped = LinearModel(
        model.A, model.B, model.E, model.C, model.D, model.states, model.inputs, (),
        model.outputs, delays=back,
    )  # fmt: skip
    with pytest.raises(NotSampled, match="outside of loops"):
        sampled_process(looped, 2.0)


def test_dead_time_of_very_many_periods_is_refused():
    with pytest.raises(NotSampled, match="sample more slowly"):
        sampled_process(three_tanks(3.0, 5.0, 4.0), 0.01)
