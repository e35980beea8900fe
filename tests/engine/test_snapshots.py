"""A run that is taken out and put back at any sample is the run that was never touched."""

from dataclasses import replace

import numpy as np
import pytest
from random_laws import random_law

from clepsydra import InputError, Kernel, Signal, program_of
from clepsydra.engine.host import host
from clepsydra.engine.stepping import SteppedKernel
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.program.program import Program
from clepsydra.program.step_law import Equations, step_law

SAMPLES = 30


def delayed_law(seed: int):
    """Return a law whose output goes through delays of random lengths."""
    first, second = np.random.default_rng(seed).integers(1, 9, 2).tolist()
    return step_law(
        f"delayed{seed}",
        inputs=[Signal("u0")],
        parameters=[],
        state=[
            Signal("x"),
            DelayRing(Signal("early"), first),
            DelayRing(Signal("late"), second),
        ],
        outputs=[Signal("y")],
        equations=lambda s: Equations(
            {name: 0.7 * value + s["u0"] for name, value in s.items() if name != "u0"},
            {"y": sum(s.values())},
        ),
    )


def fusable(program: Program) -> Program:
    """Return it as that of a process is, whose products may be fused into sums."""

    def statement(each):
        return replace(each, fused=True) if isinstance(each, Operation) else each

    return replace(program, block=program.block.with_statements(statement))


@pytest.mark.parametrize("fuse", [True, False], ids=["fused", "unfused"])
@pytest.mark.parametrize("make", [random_law, delayed_law])
@pytest.mark.parametrize("seed", range(50))
def test_a_run_goes_on_as_if_it_had_never_been_left(make, seed, fuse):
    random = np.random.default_rng([9, seed])
    program = fusable(program_of(make(seed)))
    kernel, names = Kernel(program, fuse=fuse), [signal.name for signal in program.inputs]
    rows = [dict(zip(names, row, strict=True)) for row in random.normal(size=(SAMPLES, len(names)))]
    whole = SteppedKernel(kernel)
    expected = [whole.step(row) for row in rows]
    broken, left = SteppedKernel(kernel), set(random.choice(SAMPLES, 6, replace=False).tolist())
    found = []
    for sample, row in enumerate(rows):
        if sample in left:
            kept = broken.snapshot()
            for other in rows[: 1 + sample % 5]:
                broken.step(other)
            if sample % 2:  # another instance goes on
                broken = SteppedKernel(kernel)
            broken.restore(kept)
        found.append(broken.step(row))
    assert np.array_equal(
        [list(each.values()) for each in found], [list(each.values()) for each in expected],
        equal_nan=True,
    )  # fmt: skip


def test_a_fused_run_is_another_one():
    program = fusable(program_of(delayed_law(1)))
    fused, unfused = (
        Kernel(program, fuse=fuse).run(SAMPLES, inputs={"u0": 0.1}).output("y")
        for fuse in (True, False)
    )
    assert np.any(fused != unfused) == host().fuses


def test_a_snapshot_stays_what_it_was():
    stepped = SteppedKernel(Kernel(program_of(random_law(1))))
    kept = stepped.snapshot()
    before = [part.copy() for part in kept]
    stepped.step({"u0": 1.0})
    stepped.restore(kept)
    stepped.step({"u0": 2.0})
    assert all(np.array_equal(one, other) for one, other in zip(kept, before, strict=True))


def test_a_snapshot_of_another_kernel_is_refused():
    one, other = (SteppedKernel(Kernel(program_of(random_law(1, states=n)))) for n in (2, 3))
    with pytest.raises(InputError, match="got '3 numbers', expected 2, as a run of the same"):
        one.restore(other.snapshot())
