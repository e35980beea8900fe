"""Section 3.1: pairing, decoupler, and the loops closed by P, PI and PID, in symbols."""

from __future__ import annotations

import dataclasses
from typing import Any, NamedTuple

from sympy import (
    Expr,
    Integer,
    Matrix,
    Poly,
    Rational,
    denom,
    expand,
    limit,
    re,
    roots,
    simplify,
    solve,
    symbols,
    together,
)

from clepsydra.papers.averaging_tank.symbols import (
    K1,
    K2,
    Td1,
    Td2,
    Ti1,
    Ti2,
    Variant,
    closed_loop,
    controller,
    decoupler,
    matrix_rows,
    plant,
    s,
    u1,
    u3,
    x1,
    x2,
)
from clepsydra.papers.comparison import (
    circular,
    claimed,
    compared,
    compared_formula,
    damaged,
    stated,
)
from clepsydra.papers.experiment import Findings
from clepsydra.papers.row import Row

_A = symbols("A")
_ZERO = Integer(0)
_STRUCTURE = "Taken from the print, chosen and not computed: by (49) T11 alone compensates."
#: What each matrix follows from.
_BY = {"GCL": "(42)", "GE": "(43)", "ess": "Limit of (44)"}
#: The elements of T by row and column, as (40) names them.
_ELEMENTS = {"11": "T12", "12": "T22", "21": "T11", "22": "T21"}


class _Section(NamedTuple):
    """What a variant prints: the places of its formulas, and the sign in its V loop."""

    variant: Variant
    plant: str
    rga: str
    p: tuple[str, str, str]  # closed loop, error, steady state
    pi: tuple[str, str, str]
    pid: str
    gains: tuple[str, str, str]  # G_c of P, PI and PID
    law: str
    loop: str  # what the formulas follow from


_SECTIONS = (
    _Section("outflow", "(45)", "(47)", ("(52)", "(53)", "(54)"), ("(56)", "(57)", "(58)"), "(60)",
             ("(51)", "PI control", "(59)"), "(61)", "(45), T of (50)"),
    _Section("inflow", "(63)", "(65)", ("(68)", "(70)", "(71)"), ("(73)", "(74)", "(75)"), "(77)",
             ("(69)", "(72)", "(76)"), "(78)", "(63), T the identity"),
)  # fmt: skip


def run() -> Findings:
    """Return the rows on the loops in symbols."""
    rows = [*_pairing(), *_decoupler()]
    for section in _SECTIONS:
        rows += [*_proportional(section), *_integral(section), *_derivative(section)]
    return Findings(tuple(rows))


def _pairing() -> list[Row]:
    rows = []
    for section in _SECTIONS:
        G = plant(section.variant).transfer
        gains = G.multiply_elementwise(G.inv().T).applyfunc(simplify)
        for i in range(2):
            for j in range(2):
                rows.append(
                    compared(
                        section.rga, f"RGA{i + 1}{j + 1}", str(int(i != j)), float(gains[i, j]),
                        digits=6,
                        why=f"G22 of {section.plant} is zero and G12 G21 is not.",
                    )
                )  # fmt: skip
    return rows


def _decoupler() -> list[Row]:
    first, second, wanted = symbols("G_p11 G_p12 T_11")
    (solved,) = solve(wanted * second + first, wanted)
    printed = Matrix([[1, 0], [-(u3 - x1) / u1, 1]])
    T = decoupler("outflow")
    rows = [compared_formula("(49)", "T11", -first / second, solved, reason="T11 G12 + G11 = 0.")]
    at_rest = T.subs({u3: 5, x1: 5, u1: 0.2})
    for name, text, found, why in (
        ("", printed, T, "-G11/G12 by (49), with (45)."),
        (
            " at rest",
            Matrix([[1, 0], [0, 1]]),
            at_rest,
            "-G11/G12 of (49) at the operating point, where C_in0 = C0.",
        ),
    ):
        rows += [_element(row, name) for row in matrix_rows("(50)", "", text, found, why)]
    return rows


def _element(row: Row, ending: str) -> Row:
    """Name an element of T as (40) does; all but T11 are a choice of structure."""
    element = _ELEMENTS[row.name]
    named = dataclasses.replace(
        row, name=f"{element}{ending} (row {row.name[0]}, column {row.name[1]})"
    )
    if element == "T11":
        return named
    return circular(dataclasses.replace(named, reason=""), _STRUCTURE)


def _with_sign(section: _Section, second: Expr) -> Expr:
    """Return the controller of V with the gain of -1 that f_out needs."""
    return second if section.variant == "outflow" else -second


def _follows(section: _Section, kind: int) -> str:
    """Return what the loops under P (0) or PI (1) follow from."""
    return f"{section.loop} and {section.gains[kind]}."


def _loops(section: _Section, first: Expr, second: Expr) -> tuple[Any, Any]:
    return closed_loop(section.variant, controller(first, _with_sign(section, second)))


def _diagonal(place: str, name: str, printed: tuple[Expr, Expr], found: Any, why: str) -> list[Row]:
    matrix = Matrix([[printed[0], 0], [0, printed[1]]])
    return matrix_rows(place, name, matrix, found, f"{_BY[name]} with {why}")


def _steady_state(place: str, error: Any, printed: tuple[Expr, Expr], of: str) -> list[Row]:
    """Compare the limits s → 0 of s G_E A / s."""
    found = error.applyfunc(lambda entry: limit(entry * _A, s, 0))
    why = f"G_E of {of} at s = 0."
    return _diagonal(place, "ess", printed, found, why)


def _stable_for_positive(denominator: Expr) -> bool:
    """Judge a polynomial of first or second order: stable where all coefficients agree in sign."""
    coefficients = Poly(denominator, s).all_coeffs()
    signs = {bool(coefficient.is_positive) for coefficient in coefficients}
    return len(coefficients) <= 3 and signs == {True}


def _stability(
    place: str, gains: str, closed: Any, words: str, sign: int = 1, note: str = ""
) -> Row:
    """Judge "stable if", for positive parameters or for a K_p2 of the other sign."""
    parts = [expand(denom(together(closed[i, i]))) for i in range(2)]
    if sign > 0:
        stable = all(_stable_for_positive(part) for part in parts)
        found, reason = "stable for positive parameters", (
            "For positive parameters all coefficients of both denominators, of second order at "
            f"most, are positive: {parts[0]} and {parts[1]}.{note}"
        )  # fmt: skip
    else:
        example = {K2: -1, Ti2: 1, Td2: Rational(1, 10)}
        (right, *_) = sorted((re(r) for r in roots(Poly(parts[1].subs(example), s))), reverse=True)
        stable = bool(right <= 0)
        given = {Ti2: "T_i2 = 1 s", Td2: "T_d2 = 0.1 s"}
        used = [words for symbol, words in given.items() if parts[1].has(symbol)]
        times = f" The example has {' and '.join(used)}." if used else ""
        far = " or K_p2 < -1/T_d2" if parts[1].has(Td2) else ""
        found, reason = f"pole at {float(right):.3g} for K_p2 = -1", (
            f"The gain of -1 is in {gains} already: the V loop has the denominator {parts[1]}, "
            f"which asks for K_p2 > 0{far}.{times}"
        )  # fmt: skip
    return claimed(place, f"stability, {place}", words, stable, found, reason=reason)


def _proportional(section: _Section) -> list[Row]:
    places, why = section.p, _follows(section, 0)
    closed, error = _loops(section, K1, K2)
    first = K1 * u1 / (s * x2 + u1 * (1 + K1))
    if section.variant == "outflow":
        rows = _diagonal(places[0], "GCL", (first, K2 / (s + K2)), closed, why)
        rows.append(
            _stability(places[0], section.gains[0], closed, "stable if K_p1 > 0 and K_p2 > 0")
        )
    else:
        bare, _ = closed_loop("inflow", controller(K1, K2))
        # The -1 of f_out is left out here, to be found missing.
        (pole,) = solve(denom(together(bare[1, 1])), s)
        k1, k2, kx = symbols("kappa_p1 kappa_p2 kappa_20", positive=True)
        printed = k1 * u1 / (s * kx + u1 * (1 + K1)), k2 / (-s + k2)
        without = f"{section.loop} and (67)."
        rows = [
            damaged(row, "κ stands for K" + (", and κ_20 for x_20." if "11" in row.name else "."))
            for row in _diagonal(places[0], "GCL", printed, bare, without)
        ]
        rows.append(
            claimed(
                places[0], "stability without the gain of -1",
                "the condition for system's stability is K_p2 < 0",
                bool(pole.subs(K2, -K2).is_negative and pole.is_positive),
                f"pole at s = {pole}", reason="The pole of the V loop of (68).",
            )
        )  # fmt: skip
        gains, words = section.gains[0], "stable if K_p1 > 0 and -K_p2 > 0"
        rows.append(_stability(gains, gains, closed, words, -1))
    errors = (s * x2 + u1) / (s * x2 + u1 * (1 + K1)), s / (s + K2)
    rows += _diagonal(places[1], "GE", errors, error, why)
    rows += _steady_state(places[2], error, (_A / (1 + K1), _ZERO), places[1])
    return rows


def _integral(section: _Section) -> list[Row]:
    places, why = section.pi, _follows(section, 1)
    closed, error = _loops(section, K1 * (1 + 1 / (Ti1 * s)), K2 * (1 + 1 / (Ti2 * s)))
    flow = symbols("u_20", positive=True) if section.variant == "outflow" else x2
    first = K1 * u1 * (1 + Ti1 * s) / (s**2 * Ti1 * flow + s * Ti1 * u1 * (1 + K1) + u1 * K1)
    if section.variant == "outflow":
        second = K2 * (1 + Ti2 * s) / (s**2 * Ti2 * K2 + K2)
    else:
        second = K2 * (1 + Ti2 * s) / (s**2 * Ti2 + s * Ti2 * K2 + K2)
    rows = [
        damaged(
            row, "The place is garbled: a fraction opens around the whole formula and breaks off. "
            "In the denominator (57) and (73) have "
            + ("x_20 for u_20." if "11" in row.name else "s T_i2 K_p2, and s² T_i2 alone."),
        )
        for row in _diagonal(places[0], "GCL", (first, second), closed, why)
    ]  # fmt: skip
    note = " They are those of (57) and (73); (56) is damaged." if flow != x2 else ""
    words, sign = _conditions(section, "T_i1 > 0, and T_i2 > 0")
    rows.append(_stability(places[0], section.gains[1], closed, words, sign, note))
    below = s**2 * Ti1 * x2 + s * Ti1 * u1 * (1 + K1) + u1 * K1
    errors = (
        (Ti1 * x2 * s**2 + Ti1 * u1 * s) / below,
        Ti2 * s**2 / (s**2 * Ti2 + s * Ti2 * K2 + K2),
    )
    rows += _diagonal(places[1], "GE", errors, error, why)
    rows += _steady_state(places[2], error, (_ZERO, _ZERO), places[1])
    return rows


def _conditions(section: _Section, times: str) -> tuple[str, int]:
    """Return the printed condition of stability, and the sign that it asks of K_p2."""
    sign = "" if section.variant == "outflow" else "-"
    return f"stable if K_p1 > 0, {sign}K_p2 > 0, {times}", -1 if sign else 1


def _without_bar(row: Row) -> Row:
    """Return GCL11 of (77) with what the text has of it."""
    printed = f"{row.printed}, without its bar"
    return damaged(
        stated(row.place, row.name, printed, str(row.computed), False, row.reason),
        "The bar of the fraction is lost.",
    )


def _derivative(section: _Section) -> list[Row]:
    first = K1 * (1 + 1 / (Ti1 * s) + Td1 * s)
    second = K2 * (1 + 1 / (Ti2 * s) + Td2 * s)
    closed, error = _loops(section, first, second)
    printed_first = K1 * (1 + 1 / (Ti1 * s) + Td2 * s)
    law = f"As {section.law} says."
    loop = f"{section.loop} and the law {section.law}."
    why = f"The controller of C differentiates with its own time, as {section.law} says."
    misread = {}
    if section.variant == "inflow":
        misread = dict(zip((Ti1, Ti2), symbols("T_l1 T_l2", positive=True), strict=True))
        why = f"T_d2 is the misprint, as in (59). {why} T_l for T_i is probably damage of the text."
    printed = Matrix([[0, _with_sign(section, second)], [printed_first, 0]]).subs(misread)
    place = section.gains[2]
    found = controller(first, _with_sign(section, second))
    rows = [
        row if row.name == "Gc21" else dataclasses.replace(row, reason=law)
        for row in matrix_rows(place, "Gc", printed, found, why)
    ]
    rows = [damaged(row, "An l looks like an i.") if row.name == "Gc12" else row for row in rows]
    above = K1 * u1 * (1 + Ti1 * s + Td1 * Ti1 * s**2)
    below = s**2 * Ti1 * (x2 + Td1 * K1 * u1) + s * Ti1 * u1 * (1 + K1) + u1 * K1
    volume = K2 * (1 + Ti2 * s + Td2 * Ti2 * s**2)
    under = s**2 * Ti2 * (1 + Td1 * K1) + s * Ti2 * K2 + K2
    loops = _diagonal(section.pid, "GCL", (above / below, volume / under), closed, loop)
    wrong = (
        "T_d1 K_p1 of the C loop stands in the denominator of the V loop, whose numerator has "
        f"T_d2. (42) with {loop}"
    )
    if section.variant == "inflow":
        loops[0] = _without_bar(loops[0])
        wrong = f"{wrong} (60) has it too."
    loops = [
        dataclasses.replace(row, reason=wrong) if row.verdict == "misprint" else row
        for row in loops
    ]
    rows += loops
    words, sign = _conditions(section, "T_i1 > 0, T_i2 > 0, T_d1 > 0, and T_d2 > 0")
    rows.append(_stability(section.pid, place, closed, words, sign))
    rest = error.applyfunc(lambda entry: limit(entry * _A, s, 0))
    rows.append(
        claimed(
            section.pid, f"steady state, {section.pid}",
            "the addition of a derivative term does not affect the steady-state error",
            rest == Matrix.zeros(2, 2),
            "zero in both loops", reason=f"Limit of (44) with {loop}",
        )
    )  # fmt: skip
    return rows
