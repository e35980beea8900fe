"""The classical Runge-Kutta method of order four, as an expression."""

from __future__ import annotations

from itertools import accumulate

import casadi as ca

from clepsydra.program.counted_loop import counted_loop


def runge_kutta_step(dynamics: ca.Function) -> ca.Function:
    """Return one step of the classical fourth-order method.

    With k1 = f(x), k2 = f(x + h/2 k1), k3 = f(x + h/2 k2), k4 = f(x + h k3), the next state is
    x + h/6 (k1 + 2 k2 + 2 k3 + k4). Source: Kutta 1901; Hairer, Nørsett & Wanner, Solving
    Ordinary Differential Equations I, table II.1.2.

    Parameters
    ----------
    dynamics : casadi.Function
        SX function (x [n], held …) → dx/dt [n]; everything but x is held during the step.

    Returns
    -------
    casadi.Function
        SX function (h [s], x [n], held …) → x after h.

    Examples
    --------
    >>> x = ca.SX.sym("x")
    >>> decay = ca.Function("decay", [x], [-x])
    >>> round(float(runge_kutta_step(decay)(0.1, 1.0)), 9)  # exp(-0.1) = 0.904837418
    0.9048375
    """
    h = ca.SX.sym("h")
    x, *held = (ca.SX.sym(f"a{i}", dynamics.numel_in(i)) for i in range(dynamics.n_in()))
    half = h / 2
    k1 = dynamics(x, *held)
    k2 = dynamics(x + half * k1, *held)
    k3 = dynamics(x + half * k2, *held)
    k4 = dynamics(x + h * k3, *held)
    return ca.Function(
        f"{dynamics.name()}_step", [h, x, *held], [x + h / 6 * (k1 + 2 * (k2 + k3) + k4)]
    )


def runge_kutta(dynamics: ca.Function, substeps: int) -> ca.Function:
    """Return several equal steps: (time [s], x [n], held …) → x after that time.

    More than one step becomes a counted loop.

    Examples
    --------
    >>> x = ca.SX.sym("x")
    >>> decay = ca.Function("decay", [x], [-x])
    >>> round(float(runge_kutta(decay, 10)(0.1, 1.0)), 9)  # exp(-0.1) = 0.904837418
    0.904837418
    """
    step = runge_kutta_step(dynamics)
    if substeps == 1:
        return step
    duration = ca.SX.sym("duration")
    x, *held = (ca.SX.sym(f"a{i}", dynamics.numel_in(i)) for i in range(dynamics.n_in()))
    h = duration / substeps
    constants = ca.vertcat(h, *held)
    state, invariant = ca.SX.sym("x", x.numel()), ca.SX.sym("held", constants.numel())
    sizes = [1, *(part.numel() for part in held)]
    parts = ca.vertsplit(invariant, [0, *accumulate(sizes)])
    body = ca.Function(
        "substep", [ca.SX.sym("row", 0), state, invariant], [step(parts[0], state, *parts[1:])]
    )
    value = counted_loop("substeps", substeps, body, carried=x, invariants=constants)
    return ca.Function(f"{dynamics.name()}_steps", [duration, x, *held], [value])
