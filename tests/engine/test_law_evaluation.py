"""Laws evaluated sample by sample."""

import numpy as np
import pytest

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine.law_evaluation import LawEvaluation
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, step_law


def delayed_law():
    return step_law(
        "delayed",
        inputs=[Signal("u")],
        parameters=[Signal("gain")],
        state=[DelayRing(Signal("pipe"), 3), Signal("sum"), DelayRing(Signal("one"), 1)],
        outputs=[Signal("old"), Signal("total"), Signal("last")],
        equations=lambda s: Equations(
            {"pipe": s["gain"] * s["u"], "sum": s["sum"] + s["pipe"], "one": s["u"]},
            {"old": s["pipe"], "total": s["sum"], "last": s["one"]},
        ),
    )


def test_a_law_is_evaluated_with_its_rings():
    law = delayed_law()
    evaluation = LawEvaluation(law, np.array([10.0]), np.array([4.0, 100.0, -1.0]))
    u = [1.0, 2.0, 3.0, 4.0, 5.0]
    rows = [evaluation.step(np.array([value])).tolist() for value in u]
    old = [4.0, 4.0, 4.0, 10.0, 20.0]
    total = [100.0, 104.0, 108.0, 112.0, 122.0]
    last = [-1.0, 1.0, 2.0, 3.0, 4.0]
    assert rows == [list(row) for row in zip(old, total, last, strict=True)]


@pytest.mark.parametrize("samples", [40])
def test_evaluation_and_kernel_agree_bit_for_bit(samples):
    law = delayed_law()
    u = np.random.default_rng(1).normal(size=samples)
    evaluation = LawEvaluation(law, np.array([0.3]), np.array([0.25, 1.5, 2.0]))
    run = Kernel(program_of(law), fuse=False).run(
        samples,
        inputs={"u": u},
        parameters={"gain": 0.3},
        state={"pipe": 0.25, "sum": 1.5, "one": 2.0},
    )
    rows = np.array([evaluation.step(np.array([value])) for value in u])
    assert np.array_equal(rows, run.record_of(0))
