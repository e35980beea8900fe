"""Section 3.1: pairing, decoupler, and the loops closed by P, PI and PID, in symbols."""

from __future__ import annotations

from typing import Any, NamedTuple

from sympy import (
    Expr,
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

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.symbols import (
    AT_REST,
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
    plant,
    s,
)
from clepsydra.papers.document import Found
from clepsydra.papers.printed_table import entries
from clepsydra.papers.row import Row, Rows

_A = symbols("A")
_STRUCTURE = "Taken from the print, chosen and not computed: by (49) T11 alone compensates."
#: The elements of T by row and column, as (40) names them.
_ELEMENTS = {(0, 0): "T12", (0, 1): "T22", (1, 0): "T11", (1, 1): "T21"}


class _Section(NamedTuple):
    """What a variant prints: the places of its formulas."""

    variant: Variant
    rga: str
    p: tuple[str, str, str]  # closed loop, error, steady state
    pi: tuple[str, str, str]
    pid: str
    gains: tuple[str, str, str]  # G_c of P, PI and PID

    @property
    def sign(self) -> int:
        """Of the gain in the V loop: f_out needs a -1."""
        return 1 if self.variant == "outflow" else -1


_SECTIONS = (
    _Section("outflow", "(47)", ("(52)", "(53)", "(54)"), ("(56)", "(57)", "(58)"), "(60)",
             ("(51)", "PI control", "(59)")),
    _Section("inflow", "(65)", ("(68)", "(70)", "(71)"), ("(73)", "(74)", "(75)"), "(77)",
             ("(69)", "(72)", "(76)")),
)  # fmt: skip


def run() -> Found:
    """Return the rows on the loops in symbols."""
    for section in _SECTIONS:
        G = plant(section.variant).transfer
        gains = G.multiply_elementwise(G.inv().T).applyfunc(simplify)
        yield from PRINTED.compared(section.rga, entries("RGA", gains))
    yield from _decoupler()
    for section in _SECTIONS:
        yield from _plain(section, section.p, K1, K2)
        integral = K1 * (1 + 1 / (Ti1 * s)), K2 * (1 + 1 / (Ti2 * s))
        yield from _plain(section, section.pi, *integral)
        yield from _derivative(section)


def _decoupler() -> Rows:
    first, second, wanted = symbols("G_p11 G_p12 T_11")
    (solved,) = solve(wanted * second + first, wanted)
    T = decoupler("outflow")
    yield from PRINTED.formulas("(49)", {"T11": solved})
    for ending, found in (("", T), (" at rest", T.subs(AT_REST))):
        for (row, column), element in _ELEMENTS.items():
            line = PRINTED["(50)", f"{element}{ending} (row {row + 1}, column {column + 1})"]
            judged = line.formula(found[row, column])
            # All but T11 are a choice of structure.
            yield (judged if element == "T11" else judged.circular(_STRUCTURE))


def _loops(section: _Section, first: Expr, second: Expr) -> tuple[Any, Any]:
    return closed_loop(section.variant, controller(first, section.sign * second))


def _steady_state(error: Any) -> Any:
    """Return the limits s → 0 of s G_E A / s."""
    return error.applyfunc(lambda entry: limit(entry * _A, s, 0))


def _stability(place: str, closed: Any, sign: int) -> Row:
    """Judge "stable if", for positive parameters or for a K_p2 of the other sign."""
    parts = [expand(denom(together(closed[i, i]))) for i in range(2)]
    if sign > 0:
        # Of first or second order: stable where all coefficients agree in sign.
        coefficients = [Poly(part, s).all_coeffs() for part in parts]
        stable = all(len(each) <= 3 and all(k.is_positive for k in each) for each in coefficients)
        found = "stable for positive parameters"
    else:
        example = {K2: -1, Ti2: 1, Td2: Rational(1, 10)}
        (right, *_) = sorted((re(r) for r in roots(Poly(parts[1].subs(example), s))), reverse=True)
        stable, found = bool(right <= 0), f"pole at {float(right):.3g} for K_p2 = -1"
    line = PRINTED[place, f"stability, {place}"].told(first=parts[0], second=parts[1])
    return line.claimed(stable, found)


def _plain(section: _Section, places: tuple[str, str, str], *loops: Expr) -> Rows:
    """Judge loops without derivative action: closed, their stability, error and steady state."""
    closed, error = _loops(section, *loops)
    if section.sign < 0 and not closed[1, 1].has(Ti2):
        # The -1 of f_out is left out here, to be found missing.
        bare, _ = closed_loop("inflow", controller(K1, K2))
        (pole,) = solve(denom(together(bare[1, 1])), s)
        holds = bool(pole.subs(K2, -K2).is_negative and pole.is_positive)
        yield from PRINTED.formulas(places[0], entries("GCL", bare))
        without = PRINTED[places[0], "stability without the gain of -1"]
        yield without.claimed(holds, f"pole at s = {pole}")
        yield _stability(section.gains[0], closed, -1)
    else:
        yield from PRINTED.formulas(places[0], entries("GCL", closed))
        yield _stability(places[0], closed, section.sign)
    yield from PRINTED.formulas(places[1], entries("GE", error))
    yield from PRINTED.formulas(places[2], entries("ess", _steady_state(error)))


def _derivative(section: _Section) -> Rows:
    first = K1 * (1 + 1 / (Ti1 * s) + Td1 * s)
    second = K2 * (1 + 1 / (Ti2 * s) + Td2 * s)
    closed, error = _loops(section, first, second)
    place, gains = section.pid, section.gains[2]
    loops = entries("GCL", closed)
    yield from PRINTED.formulas(gains, entries("Gc", controller(first, section.sign * second)))
    if section.variant == "inflow":
        yield PRINTED[place, "GCL11"].stated(str(loops.pop("GCL11")), False)
    yield from PRINTED.formulas(place, loops)
    yield _stability(place, closed, section.sign)
    yield PRINTED[place, f"steady state, {place}"].claimed(
        _steady_state(error) == Matrix.zeros(2, 2), "zero in both loops"
    )
