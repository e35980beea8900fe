"""What a delay ring holds: given at the start, read at the end."""

import numpy as np
import pytest
from refusals import refused

from clepsydra.base.signal import Signal
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.stepping import SteppedKernel
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.reader import program_of
from clepsydra.program.step_law import Equations, step_law

LENGTH = 5


@pytest.fixture(scope="module")
def program():
    """What comes in goes out five samples later."""
    return program_of(
        step_law(
            "pipe",
            inputs=[Signal("entering")],
            parameters=[],
            state=[DelayRing(Signal("held"), LENGTH)],
            outputs=[Signal("leaving")],
            equations=lambda s: Equations({"held": s["entering"]}, {"leaving": s["held"]}),
        )
    )


@pytest.mark.parametrize("samples", [3, 5, 12])
def test_a_ring_gives_back_the_last_that_entered_the_oldest_first(program, samples):
    entered = np.arange(1.0, samples + 1.0)
    result = Kernel(program).run(samples, inputs={"entering": entered}, state={"held": 0.0})
    expected = np.concatenate([np.zeros(LENGTH), entered])[-LENGTH:]
    assert result.rings()["held"].tolist() == [expected.tolist()]


def test_a_ring_that_is_given_comes_out_the_oldest_first(program):
    held = [7.0, 6.0, 5.0, 4.0, 3.0]
    result = Kernel(program).run(LENGTH, inputs={"entering": 0.0}, rings={"held": held})
    assert result.output("leaving")[0].tolist() == held
    stepped = SteppedKernel(Kernel(program), inputs={"entering": 1.0}, rings={"held": held})
    assert [stepped.step({})["leaving"] for _ in range(2)] == held[:2]
    assert stepped.rings["held"].tolist() == [*held[2:], 1.0, 1.0]


def test_every_lane_begins_with_the_ring_that_is_given(program):
    entered = np.arange(20.0)[:, None] * np.ones(3)
    kernel = Kernel(program, individual=["entering"], lanes=8)
    result = kernel.run(3, inputs={"entering": entered}, rings={"held": [1.0, 2.0, 3.0, 4.0, 5.0]})
    assert result.output("leaving").tolist() == 20 * [[1.0, 2.0, 3.0]]
    assert result.rings()["held"].tolist() == [[4.0, 5.0, *3 * [float(n)]] for n in range(20)]


@pytest.mark.parametrize(
    ("rings", "value"), [({"hold": [0.0]}, "hold"), ({"held": [1.0, 2.0]}, [2])]
)
def test_a_ring_that_there_is_not_or_of_another_length_is_refused(program, rings, value):
    with refused(value=value):
        Kernel(program).run(1, rings=rings)
