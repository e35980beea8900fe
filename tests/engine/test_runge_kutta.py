"""The classical Runge-Kutta method: its stability function, its quadrature, and its order."""

import math

import casadi as ca
import numpy as np
import pytest

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine.runge_kutta import runge_kutta, runge_kutta_step
from clepsydra.program.program import ForLoop
from clepsydra.program.step_law import Equations, step_law


@pytest.mark.parametrize(
    ("rate_value", "h"), [(-1.0, 0.1), (-3.0, 0.5), (2.0, 0.25), (-2.785, 1.0)]
)
def test_a_step_of_a_linear_equation_is_the_stability_function(rate_value, h):
    """R(z) = 1 + z + z²/2 + z³/6 + z⁴/24, Hairer & Wanner II, IV.2."""
    x, rate = ca.SX.sym("x"), ca.SX.sym("rate")
    step = runge_kutta_step(ca.Function("linear", [x, rate], [rate * x]))
    z = rate_value * h
    exact = 3.0 * (1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)
    assert float(step(h, 3.0, rate_value)) == pytest.approx(exact, rel=4e-15)


def test_a_cubic_rate_is_integrated_exactly():
    """With dx/dt a cubic of time the method is Simpson's rule, which is exact there."""
    x, c = ca.SX.sym("x", 2), ca.SX.sym("c", 4)
    t = x[0]
    rate = c[0] + c[1] * t + c[2] * t**2 + c[3] * t**3
    step = runge_kutta_step(ca.Function("cubic", [x, c], [ca.vertcat(1, rate)]))
    random = np.random.default_rng(1)
    for _ in range(20):
        coefficients, (start, h) = random.normal(size=4), random.uniform(0.1, 3.0, size=2)
        primitive = np.polynomial.Polynomial(coefficients).integ()
        exact = 2.0 + primitive(start + h) - primitive(start)
        got = np.array(step(h, [start, 2.0], coefficients)).ravel()
        size = 2.0 + np.sum(np.abs(coefficients) * (start + h) ** np.arange(1, 5))
        assert got[0] == start + h
        assert abs(got[1] - exact) < 2e-15 * size


@pytest.mark.parametrize("h", [0.5, 1.0, 2.0])
def test_a_quartic_rate_has_the_error_of_simpsons_rule(h):
    """For ∫ f over a step h it is h⁵/2880 f⁗, and f = 5t⁴ has f⁗ = 120."""
    x = ca.SX.sym("x", 2)
    step = runge_kutta_step(ca.Function("quartic", [x], [ca.vertcat(1, 5 * x[0] ** 4)]))
    error = float(step(h, [0.0, 0.0])[1]) - h**5
    assert error == pytest.approx(h**5 * 120 / 2880, rel=1e-13)


def growth():
    x = ca.SX.sym("x")
    return (
        ca.Function("logistic", [x], [x * (1 - x)]),
        [0.2],
        lambda t: [1 / (1 + 4 * math.exp(-t))],
    )


def swing():
    x = ca.SX.sym("x", 2)
    return (
        ca.Function("swing", [x], [ca.vertcat(x[1], -x[0])]),
        [1.0, 0.0],
        lambda t: [
            math.cos(t),
            -math.sin(t),
        ],
    )


def draining():
    """Torricelli's tank, √x falling linearly, away from its floor."""
    x = ca.SX.sym("x")
    return ca.Function("draining", [x], [-0.1 * ca.sqrt(x)]), [1.0], lambda t: [(1 - 0.05 * t) ** 2]


def driven():
    """dx/dt = cos(t) x: x = exp(sin t), the time as a state."""
    x = ca.SX.sym("x", 2)
    rates = ca.vertcat(1, ca.cos(x[0]) * x[1])
    return ca.Function("driven", [x], [rates]), [0.0, 1.0], lambda t: [t, math.exp(math.sin(t))]


@pytest.mark.parametrize("problem", [growth, swing, draining, driven])
def test_halving_the_step_divides_the_error_by_sixteen(problem):
    dynamics, start, exact = problem()
    errors = []
    for substeps in (16, 32, 64):
        got = np.array(runge_kutta(dynamics, substeps)(4.0, start)).ravel()
        errors.append(np.max(np.abs(got - exact(4.0))))
    assert errors[-1] > 1e-14  # else rounding, not the method, would be seen
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 4.0) < 0.25), (errors, orders)


@pytest.mark.parametrize("substeps", [1, 2, 3, 7, 10])
def test_substeps_are_repeated_single_steps(substeps):
    dynamics, start, _ = swing()
    single, several = runge_kutta_step(dynamics), runge_kutta(dynamics, substeps)
    state = ca.DM(start)
    for _ in range(substeps):
        state = single(0.9 / substeps, state)
    assert np.array_equal(np.array(several(0.9, start)), np.array(state))


def swinging(dynamics, substeps, h):
    """A swing that starts at 1, and moves on by h in each sample."""

    def equations(s):
        moved = runge_kutta(dynamics, substeps)(h, ca.vertcat(s["x"], s["v"]))
        return Equations({"x": moved[0], "v": moved[1]}, {"x_now": s["x"], "v_now": s["v"]})

    return program_of(
        step_law(
            "swing",
            inputs=[],
            parameters=[],
            state=[Signal("x", initial=1.0), Signal("v")],
            outputs=[Signal("x_now"), Signal("v_now")],
            equations=equations,
        )
    )


def test_several_steps_become_one_counted_loop_and_one_step_none():
    dynamics, _, _ = swing()

    def loops(substeps: int) -> list[int]:
        block = swinging(dynamics, substeps, 0.9).block
        return [s.count for s in block.statements if isinstance(s, ForLoop)]

    assert loops(1) == []
    assert loops(6) == [6]


def test_a_kernel_of_the_method_follows_a_swing_for_many_turns():
    """|R(iω h)|: the amplitude after n steps is (1 - z⁶/72 + z⁸/576)^(n/2) with z = h."""
    dynamics, _, _ = swing()
    samples, h = 2000, 0.1
    run = Kernel(swinging(dynamics, 1, h)).run(samples)
    amplitude = np.hypot(run.output("x_now")[0], run.output("v_now")[0])
    factor = 1 - h**6 / 72 + h**8 / 576
    assert amplitude == pytest.approx(factor ** (np.arange(samples) / 2), rel=1e-12)
    angle = math.atan2(h - h**3 / 6, 1 - h**2 / 2 + h**4 / 24)
    expected = amplitude * np.cos(angle * np.arange(samples))
    assert np.max(np.abs(run.output("x_now")[0] - expected)) < 1e-11
