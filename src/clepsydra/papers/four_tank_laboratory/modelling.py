"""Exercises 2.1.1 to 2.1.6: the linear model, its zeros and its relative gains, in symbols."""

from __future__ import annotations

from typing import Any

import numpy as np

from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import zeros
from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    NON_MINIMUM,
    OF_THE_COURSE,
    course_model,
)
from clepsydra.papers.printed_table import entries
from clepsydra.papers.row import Rows


def run() -> Found:
    """Derive what the report derives from its balances (4)."""
    return (*_linear_model(), *_zeros(), *_relative_gains())


def _linear_model() -> Rows:
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
    times = [
        (sp.simplify(-1 / state[i, i]), {"A_1": A[i], "a_1": a[i], "h_1": h[i]}) for i in range(4)
    ]
    state = sp.simplify(state.subs({a[i]: A[i] / T[i] * sp.sqrt(2 * h[i] / g) for i in range(4)}))
    matrices = entries("A, row {}, column {}", state) | entries("B, row {}, column {}", inputs)
    show = sp.Matrix([[kc, 0, 0, 0], [0, kc, 0, 0]])
    G = (show * (s * sp.eye(4) - state).inv() * inputs).applyfunc(sp.factor)
    determinant = sp.factor(G.det())
    plugged = {a[0]: 0, a[1]: 0, a[2]: 0, a[3]: 0, gamma[0]: 1, gamma[1]: 1}
    by_place = {
        "(9)": {name: value for name, value in matrices.items() if value != 0},
        "(11)": entries("g", G),
        "(21)": {
            f"rise of tank {i + 1} with its holes closed": rates[i].subs(plugged) for i in (0, 1)
        },
        "(12)": {f"det G, {line} line": determinant for line in ("first", "second")},
        **_array(G),
    }
    yield PRINTED["(10)", "T_i"].formula_in(times)
    yield from (row for place, found in by_place.items() for row in PRINTED.formulas(place, found))


def _array(G: Any) -> dict[str, dict[str, Any]]:
    """Return the relative gains of G by the place and name of their formulas."""
    import sympy as sp

    g = sp.Matrix(2, 2, sp.symbols("g_11 g_12 g_21 g_22"))
    array = sp.simplify(g.multiply_elementwise(g.inv().T))
    at_rest = array[0, 0].subs(dict(zip(g, G, strict=True))).subs(sp.Symbol("s"), 0)
    return {
        "(15)": entries("RGA, row {}, column {}", array),
        "(16)": {"λ": array[0, 0]},
        "(17)": {"RGA, entry beside λ": array[0, 1]},
        "(18)": {"λ at s = 0": sp.factor(at_rest)},
    }


def _zeros() -> Rows:
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
    left = PRINTED["(13)", "zeros for 1 < γ1 + γ2 ≤ 2"]
    right = PRINTED["(14)", "zeros for 0 < γ1 + γ2 ≤ 1"]
    yield left.claimed(
        bool(np.all(rightmost[above] < 0.0)),
        f"largest real part {rightmost[above].max():.3g} rad/s",
        pairs=above.sum(),
        course=OF_THE_COURSE,
    )
    yield right.claimed(
        bool(np.all(rightmost[~above] >= -1e-12)),
        f"smallest real part of the right one {rightmost[~above].min():.3g} rad/s",
        pairs=(~above).sum(),
    )
    yield PRINTED["Exercise 2.1.6", "the two set-ups"].claimed(
        found["minimum phase"] < 0.0 < found["non-minimum phase"],
        ", ".join(f"{phase}: {value:+.4f} rad/s" for phase, value in found.items()),
        course=OF_THE_COURSE,
    )


def _relative_gains() -> Rows:
    for set_up, place in ((MINIMUM, "(19)"), (NON_MINIMUM, "(20)")):
        array = relative_gain_array(static_gain(course_model(set_up)))
        yield from PRINTED.compared("Exercise 2.1.6", {f"λ, {set_up.phase}": array[0, 0]})
        yield from PRINTED.compared(place, entries("RGA, row {}, column {}", array))
