"""Section 2: the equations of the chain, and its numbers."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np

from clepsydra.linear.static_gain import static_gain
from clepsydra.papers.comparison import circular, compared, compared_formula, damaged, stated
from clepsydra.papers.eight_tanks.six_designs import GAIN, MINUTE, TANKS, chain
from clepsydra.papers.experiment import Findings
from clepsydra.papers.row import Row

_DIAMETER, _AREA, _TIME = "1", "0.785", "2"  # [m], [m²], [min]
_K1, _GAIN = "0.3925", "3.08"


def run() -> Findings:
    """Return the rows of section 2."""
    return Findings((*_numbers(), *_transfer_function(), *_formulas()))


def _numbers() -> list[Row]:
    area = np.pi * float(_DIAMETER) ** 2 / 4.0
    coefficient = float(_AREA) / float(_TIME)
    gain = 1.0 / float(_K1)
    # Exponents of m and min: K1 is an area over a time.
    of_k1 = {"m": 2, "min": -1}
    of_gain = {unit: -power for unit, power in of_k1.items()}
    return [
        compared("section 2", "tank area F", _AREA, float(area), "m²", why="π d² / 4"),
        compared("section 2", "K1", _K1, coefficient, "m²/min", why="F / T"),
        compared(
            "section 2", "static gain K_g = 1/K1", _GAIN, gain, "min/m²",
            right_if=[
                (f"F / T = {_AREA} / {_TIME} is the printed K1", coefficient == float(_K1)),
                (
                    f"the printed fraction 1 / {_K1} is {gain:.3f}",
                    abs(gain * float(_K1) - 1.0) < 1e-12 and abs(GAIN * float(_K1) - 1.0) > 0.2,
                ),
            ],
        ),
        damaged(
            stated(
                "section 2", "unit of K_g", "m² min", "min/m²", of_gain == {"m": 2, "min": 1},
                "A level over an inflow, and the inverse of K1 in m²/min: min/m².",
            ),
            "It looks as if the minus sign of m⁻² min was lost.",
        ),
    ]  # fmt: skip


@cache
def _poles() -> np.ndarray:
    return np.asarray(np.linalg.eigvals(chain().model.A))


def _transfer_function() -> list[Row]:
    """Return the numbers of (8) beside those of the process that is simulated here."""
    gain = float(static_gain(chain().model)[0, 0]) / MINUTE
    # Eight equal poles come out as a ring; its middle is exact.
    time_constant = float(-1.0 / np.mean(_poles()).real) / MINUTE
    why = "Read back from that process, linearised."
    by_tank = f"By the printed K1 it is {1.0 / float(_K1):.3f} min/m², see K_g in section 2."
    rows = [
        compared("(8)", "static gain", _GAIN, gain, "min/m²", why=f"{why} {by_tank}"),
        compared("(8)", "time constant of a tank", _TIME, time_constant, "min", why=why),
        compared("(8)", "order", str(TANKS), float(len(_poles())), why=why),
    ]
    taken = "The process eight-tanks:paper was made from (8), to be the document's chain."
    return [circular(row, taken) for row in rows]


def _formulas() -> list[Row]:
    from sympy import solve, symbols

    s, T, K1, F = symbols("s T K_1 F", positive=True)
    inflow, outflow, level = symbols("q_I q_O h")
    second_inflow, first_level = symbols("q_2I h_1")

    def tank(into: object) -> dict[object, object]:
        """Solve equations (2) of one tank for its level and outflow."""
        found = solve(
            [F * s * level - (into - outflow), outflow - K1 * level], [level, outflow], dict=True
        )[0]
        return {name: value.subs(F, T * K1) for name, value in found.items()}

    first = tank(inflow)
    last, into = first, inflow
    for _ in range(TANKS):
        last = tank(into)
        into = last[outflow]
    one = (1 / K1) / (T * s + 1)
    why = "from equations (2) in Laplace transforms, with T = F/K1"
    return [
        compared_formula(
            "(3)", "level over inflow of a tank", one, first[level] / inflow, reason=why
        ),
        compared_formula("(4)", "level of tank 1", one * inflow, first[level], reason=why),
        compared_formula(
            "(5)", "level of tank 2", one * second_inflow, tank(second_inflow)[level], reason=why
        ),
        dataclasses.replace(
            compared_formula(
                "(5)", "level of tank 2 by that of tank 1", one * K1 * first_level,
                tank(K1 * first_level)[level],
                reason=f"{why}; the inflow is K_1 h_1 by the second of them",
            ),
            printed="1/(K_1*(T*s + 1))*K_1*h_1",
        ),
        compared_formula(
            "(6), (7)", "level of tank n over inflow of tank 1, n = 8",
            (1 / K1) / (T * s + 1) ** TANKS, last[level] / inflow,
            reason=f"{why}; K_g is 1/K_1, as below (7)",
        ),
    ]  # fmt: skip
