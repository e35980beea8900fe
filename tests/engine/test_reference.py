"""The reference solver against closed forms, and laws evaluated sample by sample."""

import math

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine.reference import LawEvaluation, ReferenceIntegrator
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, step_law


@pytest.mark.parametrize(
    ("start", "rate", "scale"),
    [
        (0.1, 1.0, 1.0),
        (0.9, 0.3, 1.0),
        (1.7, 2.0, 1.0),
        (1e-6, 4.0, 1e-6),
    ],
)
def test_a_nonlinear_equation_against_its_closed_form(start, rate, scale):
    """Logistic growth: x(t) = 1/(1 + (1/x0 - 1) exp(-r t))."""
    x, r = ca.SX.sym("x"), ca.SX.sym("r")
    logistic = ca.Function("logistic", [x, r], [r * x * (1 - x)])
    solver = ReferenceIntegrator(logistic, 3.0, scale)
    exact = 1.0 / (1.0 + (1.0 / start - 1.0) * math.exp(-rate * 3.0))
    got = solver(np.array([start]), np.array([rate]))
    assert got.shape == (1,)
    assert abs(got[0] - exact) < 1e-8 * max(exact, start)


def test_a_stiff_linear_system_with_a_held_input():
    """ẋ = A x + B u with u held: x(T) = e^{AT} x + A⁻¹(e^{AT} - I) B u."""
    A = np.array([[-1000.0, 500.0], [0.3, -0.4]])
    B = np.array([[200.0], [0.1]])
    x, u = ca.SX.sym("x", 2), ca.SX.sym("u")
    solver = ReferenceIntegrator(ca.Function("stiff", [x, u], [ca.DM(A) @ x + ca.DM(B) @ u]), 2.0)
    state, held = np.array([1.0, -1.0]), np.array([0.7])
    for _ in range(3):
        transition = expm(A * 2.0)
        exact = transition @ state + np.linalg.solve(A, (transition - np.eye(2)) @ B @ held)
        got = solver(state, held)
        assert np.max(np.abs(got - exact)) < 2e-9
        state = got


def test_the_scale_sets_the_absolute_tolerance():
    """A state of 1e-9 decays with a relative error of 1e-8 when the scale says so."""
    x = ca.SX.sym("x")
    solver = ReferenceIntegrator(ca.Function("decay", [x], [-5 * x]), 1.0, scale=1e-9)
    assert abs(solver(np.array([1e-9]))[0] - 1e-9 * math.exp(-5)) < 1e-9 * 1e-9


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
