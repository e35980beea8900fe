"""Section 2: the equations of the chain, and its numbers."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.static_gain import static_gain
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.six_designs import GAIN, MINUTE, TANKS, chain
from clepsydra.papers.rational_function import RationalFunction, symbols
from clepsydra.papers.row import Rows

_DIAMETER, _TIME, _AREA, _K1 = PRINTED.numbers(
    "section 2", "tank diameter d_T", "time constant T", "tank area F", "K1"
)  # [m], [min], [m²], [m²/min]


def run() -> Found:
    """Return the rows of section 2."""
    return (*_numbers(), *_transfer_function(), *_formulas())


def _numbers() -> Rows:
    area = np.pi * _DIAMETER**2 / 4.0
    coefficient = _AREA / _TIME
    gain = 1.0 / _K1
    evidence = [
        (f"F / T = {_AREA} / {_TIME:g} is the printed K1", coefficient == _K1),
        (
            f"the printed fraction 1 / {_K1} is {gain:.3f}",
            abs(gain * _K1 - 1.0) < 1e-12 and abs(GAIN * _K1 - 1.0) > 0.2,
        ),
    ]
    # Exponents of m and min: K1 is an area over a time.
    of_k1 = {"m": 2, "min": -1}
    of_gain = {unit: -power for unit, power in of_k1.items()}
    yield from PRINTED.compared("section 2", {"tank area F": area, "K1": coefficient})
    yield PRINTED["section 2", "static gain K_g = 1/K1"].compared(gain, right_if=evidence)
    yield PRINTED["section 2", "unit of K_g"].stated("min/m²", of_gain == {"m": 2, "min": 1})


def _transfer_function() -> Rows:
    """Return the numbers of (8) beside those of the process that is simulated here."""
    gain = float(static_gain(chain().model)[0, 0]) / MINUTE
    poles = np.linalg.eigvals(chain().model.A)
    # Eight equal poles come out as a ring; its middle is exact.
    time_constant = float(-1.0 / np.mean(poles).real) / MINUTE
    found = {"static gain": gain, "time constant of a tank": time_constant, "order": len(poles)}
    for name, value in found.items():
        row = PRINTED["(8)", name].compared(value, gain=1.0 / _K1)
        yield row.circular(
            "The chain that everything is computed on, eight balances (2), was made from (8)."
        )


def _formulas() -> Rows:
    s, T, K1, h = symbols("s T K_1 h")
    inflow, first_inflow, second_inflow, first_level = symbols("q_I q_1I q_2I h_1")
    F = T * K1

    def outflow(level: RationalFunction) -> RationalFunction:
        return K1 * level

    def level(into: RationalFunction) -> RationalFunction:
        """Solve equations (2) of one tank for its level."""
        return (F * s * h - (into - outflow(h))).root("h")

    last = level(inflow)
    for _ in range(TANKS - 1):
        last = level(outflow(last))
    found = {
        ("(3)", "level over inflow of a tank"): level(inflow) / inflow,
        ("(4)", "level of tank 1"): level(first_inflow),
        ("(5)", "level of tank 2"): level(second_inflow),
        ("(5)", "level of tank 2 by that of tank 1"): level(outflow(first_level)),
        ("(6), (7)", "level of tank n over inflow of tank 1, n = 8"): last / inflow,
    }
    yield from (PRINTED[line].formula(value) for line, value in found.items())
