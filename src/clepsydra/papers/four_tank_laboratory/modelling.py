"""Exercises 2.1.1 to 2.1.6: the linear model, its zeros and its relative gains, in symbols."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import zeros
from clepsydra.papers.comparison import claimed, compared, compared_formula
from clepsydra.papers.experiment import Findings
from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    NON_MINIMUM,
    OF_THE_COURSE,
    course_model,
)
from clepsydra.papers.row import Row


def run() -> Findings:
    """Derive what the report derives from its balances (4)."""
    return Findings((*_linear_model(), *_zeros(), *_relative_gains()))


def _linear_model() -> list[Row]:
    import sympy as sp

    A, a, h = (sp.symbols(f"{name}_1:5", positive=True) for name in "Aah")
    T = sp.symbols("T_1:5", positive=True)
    gamma, k, u = (sp.symbols(f"{n}_1:3", positive=True) for n in ("gamma", "k", "u"))
    g, kc, s = sp.Symbol("g", positive=True), sp.Symbol("k_c", positive=True), sp.Symbol("s")
    out = [a[i] * sp.sqrt(2 * g * h[i]) for i in range(4)]
    # (4), the balances of the four tanks
    rates = sp.Matrix(
        [
            (-out[0] + out[2] + gamma[0] * k[0] * u[0]) / A[0],
            (-out[1] + out[3] + gamma[1] * k[1] * u[1]) / A[1],
            (-out[2] + (1 - gamma[1]) * k[1] * u[1]) / A[2],
            (-out[3] + (1 - gamma[0]) * k[0] * u[0]) / A[3],
        ]
    )
    state = rates.jacobian(sp.Matrix(h))
    inputs = rates.jacobian(sp.Matrix(u))
    rows = []
    printed_times = [A[i] / a[i] * sp.sqrt(2 * h[i] / g) for i in range(4)]
    times = [sp.simplify(-1 / state[i, i]) for i in range(4)]
    # One formula for four tanks: the row shows one that differs, if any does.
    tank = next((i for i in range(4) if sp.simplify(printed_times[i] - times[i]) != 0), 0)
    rows.append(
        compared_formula(
            "(10)",
            "T_i",
            printed_times[tank],
            times[tank],
            reason="Jacobian of (4); of tank 1, and the other three agree.",
        )
    )
    in_times = {a[i]: A[i] / T[i] * sp.sqrt(2 * h[i] / g) for i in range(4)}
    state = sp.simplify(state.subs(in_times))
    printed_state = sp.Matrix(
        [
            [-1 / T[0], 0, A[2] / (A[0] * T[2]), 0],
            [0, -1 / T[1], 0, A[3] / (A[1] * T[3])],
            [0, 0, -1 / T[2], 0],
            [0, 0, 0, -1 / T[3]],
        ]
    )
    printed_inputs = sp.Matrix(
        [
            [gamma[0] * k[0] / A[0], 0],
            [0, gamma[1] * k[1] / A[1]],
            [0, (1 - gamma[1]) * k[1] / A[2]],
            [(1 - gamma[0]) * k[0] / A[3], 0],
        ]
    )
    for name, printed, found in (("A", printed_state, state), ("B", printed_inputs, inputs)):
        for i in range(4):
            for j in range(printed.cols):
                if printed[i, j] != 0 or found[i, j] != 0:
                    rows.append(
                        compared_formula(
                            "(9)", f"{name}, row {i + 1}, column {j + 1}", printed[i, j],
                            found[i, j], reason="Jacobian of (4)",
                        )
                    )  # fmt: skip
    show = sp.Matrix([[kc, 0, 0, 0], [0, kc, 0, 0]])
    G = (show * (s * sp.eye(4) - printed_state).inv() * printed_inputs).applyfunc(sp.factor)
    c = [T[i] * kc / A[i] for i in range(2)]
    lags = [1 + s * T[i] for i in range(4)]
    printed_g = sp.Matrix(
        [
            [gamma[0] * k[0] * c[0] / lags[0], (1 - gamma[1]) * k[1] * c[0] / lags[2] / lags[0]],
            [(1 - gamma[0]) * k[0] * c[1] / lags[3] / lags[1], gamma[1] * k[1] * c[1] / lags[1]],
        ]
    )
    for i in range(2):
        for j in range(2):
            rows.append(
                compared_formula(
                    "(11)", f"g{i + 1}{j + 1}", printed_g[i, j], G[i, j],
                    reason="C (sI − A)⁻¹ B of (9)",
                )
            )  # fmt: skip
    plugged = {a[0]: 0, a[1]: 0, a[2]: 0, a[3]: 0, gamma[0]: 1, gamma[1]: 1}
    for i in range(2):
        rows.append(
            compared_formula(
                "(21)", f"rise of tank {i + 1} with its holes closed", k[i] * u[i] / A[i],
                rates[i].subs(plugged), reason="(4) without holes and with γ = 1",
            )
        )  # fmt: skip
    return [*rows, *_determinant(G, gamma, k, c, T, s), *_array(G)]


def _determinant(G, gamma, k, c, T, s) -> list[Row]:  # type: ignore[no-untyped-def]
    import sympy as sp

    determinant = sp.factor(G.det())
    poles = sp.prod(1 + s * time for time in T)
    front = gamma[0] * gamma[1] * k[0] * k[1] * c[0] * c[1] / poles
    split = (1 - gamma[0]) * (1 - gamma[1]) / (gamma[0] * gamma[1])
    first = front * ((1 + s * T[2]) * (1 + s * T[3]) - split)
    both = T[2] * T[3]
    second = (
        front
        * both
        * (
            s**2
            + (T[2] + T[3]) / both * s
            + (gamma[0] + gamma[1] - 1) / (gamma[0] * gamma[1] * both)
        )
    )
    return [
        compared_formula("(12)", "det G, first line", first, determinant, reason="det of (11)"),
        compared_formula("(12)", "det G, second line", second, determinant, reason="det of (11)"),
    ]


def _array(G) -> list[Row]:  # type: ignore[no-untyped-def]
    import sympy as sp

    g = sp.Matrix(2, 2, sp.symbols("g_11 g_12 g_21 g_22"))
    array = sp.simplify(g.multiply_elementwise(g.inv().T))
    determinant = g[0, 0] * g[1, 1] - g[0, 1] * g[1, 0]
    first = 1 / (1 - g[0, 1] * g[1, 0] / (g[0, 0] * g[1, 1]))
    named = {symbol.name: symbol for symbol in G.free_symbols}
    one, two, s = named["gamma_1"], named["gamma_2"], named["s"]
    at_rest = sp.factor(array[0, 0].subs(dict(zip(g, G, strict=True))).subs(s, 0))
    straight, across = g[0, 0] * g[1, 1] / determinant, -g[0, 1] * g[1, 0] / determinant
    rows = [
        compared_formula(
            "(15)",
            f"RGA, row {i + 1}, column {j + 1}",
            printed,
            array[i, j],
            reason="G times the transpose of its inverse, entry by entry",
        )
        for (i, j), printed in zip(
            ((0, 0), (0, 1), (1, 0), (1, 1)), (straight, across, across, straight), strict=True
        )
    ]
    return [
        *rows,
        compared_formula("(16)", "λ", first, array[0, 0], reason="first entry of (15)"),
        compared_formula(
            "(17)", "RGA, entry beside λ", 1 - first, array[0, 1], reason="second entry of (15)"
        ),
        compared_formula(
            "(18)",
            "λ at s = 0",
            one * two / (one + two - 1),
            at_rest,
            reason="(15) of the static gain of (11)",
        ),
    ]


def _zeros() -> list[Row]:
    splits = np.linspace(0.02, 1.0, 50)
    one, two = np.meshgrid(splits, splits)
    times = -1.0 / course_model(MINIMUM).A.diagonal()[2:]
    # The roots of (12) for every pair of splits.
    middle = times.sum() / times.prod()
    last = (one + two - 1.0) / (one * two * times.prod())
    root = np.sqrt((0.25 * middle**2 - last).astype(complex))
    larger, smaller = -0.5 * middle + root, -0.5 * middle - root
    rightmost = np.maximum(larger.real, smaller.real)
    on_the_border = np.abs(one + two - 1.0) < 1e-9
    above = (one + two > 1.0) & ~on_the_border
    found = {
        set_up.phase: max(zero.real for zero in zeros(course_model(set_up)))
        for set_up in (MINIMUM, NON_MINIMUM)
    }
    return [
        claimed(
            "(13)", "zeros for 1 < γ1 + γ2 ≤ 2", "holds for zeros with negative real part",
            bool(np.all(rightmost[above] < 0.0)),
            f"largest real part {rightmost[above].max():.3g} rad/s",
            reason=f"Roots of (12) for {above.sum()} pairs of splits, T3 and T4 at the "
            f"course's levels with {OF_THE_COURSE}; for any others their sum stays negative and "
            "their product positive.",
        ),
        claimed(
            "(14)", "zeros for 0 < γ1 + γ2 ≤ 1", "holds for zeros with non-negative real part",
            bool(np.all(rightmost[~above] >= -1e-12)),
            f"smallest real part of the right one {rightmost[~above].min():.3g} rad/s",
            reason=(
                f"The right root of (12) for {(~above).sum()} pairs of splits, which makes the "
                "process non-minimum phase; at γ1 + γ2 = 1 it stands at zero."
            ),
        ),
        claimed(
            "Exercise 2.1.6", "the two set-ups",
            "For the minimum phase we have γ1 = γ2 = 0.625 …; for the non-minimum phase case we "
            "have γ1 = γ2 = 0.375",
            found["minimum phase"] < 0.0 < found["non-minimum phase"],
            ", ".join(f"{phase}: {value:+.4f} rad/s" for phase, value in found.items()),
            reason="Rightmost transmission zero of the linear model at levels of the course's "
            f"exercise and with {OF_THE_COURSE}; its sign is that of 1 - γ1 - γ2 at any levels.",
        ),
    ]  # fmt: skip


def _relative_gains() -> list[Row]:
    rows = []
    for set_up, place, printed, value in (
        (MINIMUM, "(19)", (("1.5625", "-0.5625"), ("-0.5625", "1.5625")), "1.5625"),
        (NON_MINIMUM, "(20)", (("-0.5625", "1.5625"), ("1.5625", "-0.5625")), "-0.5625"),
    ):
        array = relative_gain_array(static_gain(course_model(set_up)))
        rows.append(
            compared(
                "Exercise 2.1.6", f"λ, {set_up.phase}", value, float(array[0, 0]),
                why="Static gain of the linear model of the process, in which γ is "
                f"{set_up.split:g}.",
            )
        )  # fmt: skip
        for i in range(2):
            for j in range(2):
                rows.append(
                    compared(place, f"RGA, row {i + 1}, column {j + 1}", printed[i][j],
                             float(array[i, j]), why="Static gain of the linear model.")
                )  # fmt: skip
    return rows
