"""Exercises 2.1.1 to 2.1.6: the linear model, its zeros and its relative gains, in symbols."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import zeros
from clepsydra.papers.document import Found
from clepsydra.papers.exact_matrix import (
    determinant,
    identity,
    inverse,
    jacobian,
    matrix,
    with_values,
)
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    NON_MINIMUM,
    SET_UPS,
    course_model,
)
from clepsydra.papers.four_tank_laboratory.words import GIVEN, levels_of
from clepsydra.papers.printed_table import entries
from clepsydra.papers.rational_function import RationalFunction, square_root, symbols
from clepsydra.papers.row import Row, Rows

#: Where a reason says that the model is linear.
_AT = {
    "at": levels_of(MINIMUM),
    "upper": "{2:g} and {3:g} cm".format(*MINIMUM.course_levels),
    "other": levels_of(NON_MINIMUM),
    "given": GIVEN,
}


def run() -> Found:
    """Derive what the report derives from its balances (4)."""
    return (*_linear_model(), *_zeros(), *_relative_gains())


def _linear_model() -> Rows:
    A, a, h, T = (symbols(f"{x}_1 {x}_2 {x}_3 {x}_4") for x in "AahT")
    gamma, k, u = (symbols(f"{name}_1 {name}_2") for name in ("gamma", "k", "u"))
    g, kc, s = symbols("g k_c s")
    # (3), with (2) and what the valves let through
    out = [a[i] * square_root(2 * g * h[i]) for i in range(4)]
    lower = [gamma[i] * k[i] * u[i] for i in range(2)]
    upper = [(1 - gamma[i]) * k[i] * u[i] for i in range(2)]
    flows = [out[2] + lower[0], out[3] + lower[1], upper[1], upper[0]]
    rates = [(flows[i] - out[i]) / A[i] for i in range(4)]
    state, inputs = jacobian(rates, h), jacobian(rates, u)
    filled = [tank for tank in (3, 4) if inputs[tank - 1, 0] != 0]
    times = [(-1 / state[i, i], {"A_1": A[i], "a_1": a[i], "h_1": h[i]}) for i in range(4)]
    holes = {str(a[i]): A[i] / T[i] * square_root(2 * h[i] / g) for i in range(4)}
    state = with_values(state, holes)
    matrices = entries("A, row {}, column {}", state) | entries("B, row {}, column {}", inputs)
    show = jacobian([kc * h[0], kc * h[1]], h)
    matrices |= entries("C, row {}, column {}", show)
    G = show @ inverse(identity(4) * s - state) @ inputs
    plugged = {str(symbol): 0 for symbol in a} | {str(symbol): 1 for symbol in gamma}
    by_place = {
        "(4)": {f"rate of h{i + 1}": rates[i] for i in range(4)},
        "(9)": {name: value for name, value in matrices.items() if value != 0},
        "(11)": entries("g", G),
        "(21)": {
            f"rise of tank {i + 1} with the holes of tanks {i + 1} and {i + 3} closed": (
                rates[i].with_values(plugged)
            )
            for i in (0, 1)
        },
        "(12)": {f"det G, {line} line": determinant(G) for line in ("first", "second")},
        **_array(G),
        **_holes(flows, h, g),
    }
    yield PRINTED["(10)", "T_i"].formula_in(times)
    yield from (row for place, found in by_place.items() for row in PRINTED.formulas(place, found))
    wrong = PRINTED["Exercise 2.1.7", "upper tank that pump 1 fills"]
    (right,) = (f"Tank {tank}" for tank in filled)
    yield wrong.stated(right, wrong.text.endswith(right))


def _holes(
    flows: Sequence[RationalFunction], h: Sequence[RationalFunction], g: RationalFunction
) -> dict[str, dict[str, RationalFunction]]:
    """Return the holes that hold levels at rest, by the place and name of their formulas."""
    found = {f"a_{tank}": flows[tank - 1] / square_root(2 * g * h[tank - 1]) for tank in (3, 4)}
    for tank in (1, 2):
        through = flows[tank - 1].with_values(found)
        found[f"a_{tank}"] = through / square_root(2 * g * h[tank - 1])
    places = {"(22)": (3,), "(23)": (4,), "(24)": (1, 2)}
    return {
        place: {f"formula of a{tank}": found[f"a_{tank}"] for tank in tanks}
        for place, tanks in places.items()
    }


def _array(G: np.ndarray) -> dict[str, dict[str, RationalFunction]]:
    """Return the relative gains of G by the place and name of their formulas."""
    names = "g_11 g_12 g_21 g_22"
    g = matrix(symbols(names)).reshape(2, 2)
    array = g * inverse(g).T
    of_gains = array[0, 0].with_values(dict(zip(names.split(), G.flat, strict=True)))
    return {
        "(15)": entries("RGA, row {}, column {}", array),
        "(16)": {"λ": array[0, 0]},
        "(17)": {"RGA, entry beside λ": array[0, 1]},
        "(18)": {"λ at s = 0": of_gains.with_values({"s": 0})},
    }


def _zeros() -> Rows:
    splits = np.linspace(0.02, 1.0, 50)
    one, two = np.meshgrid(splits, splits)
    times = -1.0 / course_model(MINIMUM).A.diagonal()[2:]
    # The roots of (12) for every pair of splits.
    middle = times.sum() / times.prod()
    last = (one + two - 1.0) / (one * two * times.prod())
    root = np.sqrt((0.25 * middle**2 - last).astype(complex))
    roots = np.sort([(-0.5 * middle + sign * root).real for sign in (1.0, -1.0)], axis=0)
    on_the_border = np.abs(one + two - 1.0) < 1e-9
    above = (one + two > 1.0) & ~on_the_border
    left, right = roots
    in_the_right_half = right > -1e-12  # where rounding leaves a zero at the origin
    poles = max(course_model(set_up).A.diagonal().max() for set_up in SET_UPS)
    yield PRINTED["Exercise 2.1.5", "poles"].claimed(
        bool(poles < 0.0), f"largest real part {poles:.3g} rad/s", **_AT
    )
    yield PRINTED["(13)", "zeros for 1 < γ1 + γ2 ≤ 2"].claimed(
        bool(np.all(right[above] < 0.0)),
        f"largest real part {right[above].max():.3g} rad/s",
        pairs=above.sum(),
        **_AT,
    )
    yield _zeros_of_14(left[~above], right[~above])
    found = {
        set_up.phase: max(zero.real for zero in zeros(course_model(set_up))) for set_up in SET_UPS
    }
    yield PRINTED["Exercise 2.1.5", "phase of the process"].claimed(
        bool(np.all(in_the_right_half == ~above))
        and found["minimum phase"] < 0.0 < found["non-minimum phase"],
        ", ".join(f"{phase}: {value:+.4f} rad/s" for phase, value in found.items()),
        pairs=above.size,
        **_AT,
    )


def _zeros_of_14(left: np.ndarray, right: np.ndarray) -> Row:
    """Judge a plural: whether both zeros have the sign that one of them has."""
    line = PRINTED["(14)", "zeros for 0 < γ1 + γ2 ≤ 1"]
    line = line.told(pairs=right.size, **_AT)
    told = f"right zero from {right.min():.3g} rad/s on, left one up to {left.max():.3g} rad/s"
    if np.all(right > -1e-12) and np.any(left < 0.0):
        return line.remark(told)
    return line.claimed(bool(np.all(left >= 0.0)), told)


def _relative_gains() -> Rows:
    for set_up, place in ((MINIMUM, "(19)"), (NON_MINIMUM, "(20)")):
        array = relative_gain_array(static_gain(course_model(set_up)))
        found = {("Exercise 2.1.6", f"λ, {set_up.phase}"): array[0, 0]} | {
            (place, name): gain for name, gain in entries("RGA, row {}, column {}", array).items()
        }
        for key, gain in found.items():
            yield PRINTED[key].compared(float(gain), split=set_up.split)
