"""Section 3.1: pairing, decoupler, and the loops closed by P, PI and PID, in symbols."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

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
from clepsydra.papers.exact_matrix import identity, inverse, with_values
from clepsydra.papers.printed_table import entries
from clepsydra.papers.rational_function import RationalFunction, symbols
from clepsydra.papers.row import Row, Rows

(_A,) = symbols("A")
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
        yield from PRINTED.compared(section.rga, entries("RGA", G * inverse(G).T))
    yield _pairing()
    yield _shape()
    yield from _decoupler()
    for section in _SECTIONS:
        yield from _plain(section, section.p, K1, K2)
        integral = K1 * (1 + 1 / (Ti1 * s)), K2 * (1 + 1 / (Ti2 * s))
        yield from _plain(section, section.pi, *integral)
        yield from _derivative(section)
    yield from _steady_errors()


def _pairing() -> Row:
    """Judge the pairing by the relative gains, which are the same in both variants."""
    gains = [G * inverse(G).T for G in (plant(section.variant).transfer for section in _SECTIONS)]
    paired, other = ({str(each[0, i]) + str(each[1, 1 - i]) for each in gains} for i in (1, 0))
    return PRINTED["section 3.1", "pairing"].claimed(
        (paired, other) == ({"11"}, {"00"}), "relative gains 1 by 1-2/2-1, 0 by 1-1/2-2"
    )


def _shape() -> Row:
    """Tell which entries of (63) and (45) are zero, as they stand and as they are paired."""
    told = []
    for place, variant in (("(63)", "inflow"), ("(45)", "outflow")):
        where = {f"{i + 1}{j + 1}": plant(variant).transfer[i, j] for i in (0, 1) for j in (0, 1)}
        told.append(f"{place} {', '.join(at for at, G in where.items() if G == 0)}")
    words = "; ".join(told)
    return PRINTED["section 3.1", "diagonal, or triangular"].remark(f"zero entries: {words}")


def _steady_errors() -> Rows:
    """Judge what P and PI control leave, as an error of C and of V."""
    of_p, of_pi = (K1, K2), (K1 * (1 + 1 / (Ti1 * s)), K2 * (1 + 1 / (Ti2 * s)))
    left = {
        name: {
            tuple(map(str, np.diag(_steady_state(_loops(section, *loops)[1]))))
            for section in _SECTIONS
        }
        for name, loops in (("P", of_p), ("PI", of_pi))
    }
    for name, found in left.items():
        words = "; ".join(f"C {of_c}, V {of_v}" for of_c, of_v in found)
        are_zero = found == {("0", "0")}
        yield PRINTED["section 3.1", f"steady-state error, {name}"].claimed(
            are_zero if name == "PI" else all(of_c != "0" for of_c, _ in found), words
        )


def _decoupler() -> Rows:
    first, second, wanted = symbols("G_p11 G_p12 T_11")
    solved = (wanted * second + first).root("T_11")
    T = decoupler("outflow")
    yield from PRINTED.formulas("(49)", {"T11": solved})
    yield from PRINTED.formulas("(50)", {"T11 by the plant": solved})
    for ending, found in (("", T), (" at rest", with_values(T, AT_REST))):
        for (row, column), element in _ELEMENTS.items():
            line = PRINTED["(50)", f"{element}{ending} (row {row + 1}, column {column + 1})"]
            judged = line.formula(found[row, column])
            # All but T11 are a choice of structure.
            yield (judged if element == "T11" else judged.circular(_STRUCTURE))
    at_rest = with_values(T, AT_REST)
    yield PRINTED["(50)", "effect at the equilibrium"].claimed(
        bool(np.all(at_rest == identity(2))), f"T = {at_rest.tolist()}"
    )


def _loops(
    section: _Section, first: RationalFunction, second: RationalFunction
) -> tuple[np.ndarray, np.ndarray]:
    return closed_loop(section.variant, controller(first, section.sign * second))


def _steady_state(error: np.ndarray) -> np.ndarray:
    """Return the limits s → 0 of s G_E A / s: a bounded entry, reduced, is continuous there."""
    return with_values(error * _A, {"s": 0})


def _stability(place: str, closed: np.ndarray, sign: int) -> Row:
    """Judge "stable if", for positive parameters or for a K_p2 of the other sign."""
    parts = [closed[i, i].denominator for i in range(2)]
    if sign > 0:
        # Of first or second order: stable where all coefficients agree in sign.
        stable = all(
            max(part.exponents("s")) <= 2 and all(k > 0 for k in part.terms.values())
            for part in parts
        )
        found = "stable for positive parameters"
    else:
        example = {"K_p2": -1, "T_i2": 1, "T_d2": Fraction(1, 10)}
        of_example = RationalFunction(parts[1]).with_values(example).numerator
        coefficients = [float(each.value) for each in of_example.all_coefficients("s")]
        right = max(np.roots(coefficients).real)
        stable, found = bool(right <= 0), f"pole at {right:.3g} for K_p2 = -1"
    line = PRINTED[place, f"stability, {place}"].told(first=parts[0], second=parts[1])
    return line.claimed(stable, found)


def _plain(section: _Section, places: tuple[str, str, str], *loops: RationalFunction) -> Rows:
    """Judge loops without derivative action: closed, their stability, error and steady state."""
    closed, error = _loops(section, *loops)
    if section.sign < 0 and "T_i2" not in closed[1, 1].symbols:
        # The -1 of f_out is left out here, to be found missing.
        bare, _ = closed_loop("inflow", controller(K1, K2))
        pole = RationalFunction(bare[1, 1].denominator).root("s")
        holds = pole == K2  # above zero for positive gains, below it for negative ones
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
        not np.any(_steady_state(error) != 0), "zero in both loops"
    )
