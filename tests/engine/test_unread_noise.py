"""Noise of an input that nothing hangs on is not made."""

import numpy as np

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine.batch_noise import BatchNoise, InputNoise
from clepsydra.program.step_law import Equations, step_law


def summing(*, record):
    law = step_law(
        "summing",
        inputs=[Signal("heard"), Signal("shown"), Signal("unread")],
        parameters=[],
        state=[Signal("sum")],
        outputs=[Signal("seen")],
        equations=lambda s: Equations({"sum": s["sum"] + s["heard"]}, {"seen": 2 * s["shown"]}),
    )
    return Kernel(program_of(law), record=record)


def test_only_what_is_read_has_noise_and_its_bits_do_not_hang_on_the_others():
    noises = {
        name: InputNoise(k, 0.5, 0, 40) for k, name in enumerate(("heard", "shown", "unread"))
    }
    noise = BatchNoise(noises, seed=3, numbers=range(5))
    without, recorded = (summing(record=each) for each in (False, True))
    for kernel, names in ((without, {"heard"}), (recorded, {"heard", "shown"})):
        job = kernel.prepare(40, noise=noise)
        assert job.noise.names == names
    alone = BatchNoise({"heard": noises["heard"]}, seed=3, numbers=range(5))
    expected = without.run(40, noise=alone).state("sum")
    for kernel in (without, recorded):
        np.testing.assert_array_equal(kernel.run(40, noise=noise).state("sum"), expected)
    assert len(set(expected)) == 5


def test_noise_that_nobody_hears_is_none():
    noise = BatchNoise({"unread": InputNoise(1, 0.5, 0, 40)}, seed=3)
    assert summing(record=True).prepare(40, noise=noise).noise is None
