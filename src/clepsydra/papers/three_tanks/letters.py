"""The linear model in letters: the slopes k1 to k3, and the matrices that they make."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.exact_matrix import jacobian
from clepsydra.papers.formula import read_formula
from clepsydra.papers.printed_table import entries
from clepsydra.papers.rational_function import symbols
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.printed_model import LEVELS, printed_model

_PLACE = "matrices in letters"
#: Flow of (1) through each opening by its drop, and the symbol of that.
_FLOWS = {
    "k1": ("a*C1*sqrt(2*g*d12)", "d12"),
    "k2": ("a*C2*sqrt(2*g*d23)", "d23"),
    "k3": ("a*C3*sqrt(2*g*h3s)", "h3s"),
}


def run() -> Found:
    """Derive slopes and matrices from (1), and compare."""
    *levels, q1, q3, k1, k2, k3, area = symbols("h1 h2 h3 q1 q3 k1 k2 k3 A")
    h1, h2, h3 = levels
    q12, q23, q2 = k1 * (h1 - h2), k2 * (h2 - h3), k3 * h3
    rates = [(q1 - q12) / area, (q12 - q23) / area, (q23 + q3 - q2) / area]
    inputs = jacobian(rates, [q1])
    yield from PRINTED.formulas(_PLACE, entries("A", jacobian(rates, levels)))
    yield from PRINTED.formulas(_PLACE, {f"B{i + 1}": inputs[i, 0] for i in range(3)})
    slopes = {name: read_formula(flow).derivative(by) for name, (flow, by) in _FLOWS.items()}
    yield from PRINTED.formulas(_PLACE, slopes)
    assert np.allclose(model_of_table_1(), printed_model().A, rtol=1e-12, atol=0.0)


def model_of_table_1() -> np.ndarray:
    """Return A [3, 3] by k1 to k3 as printed, with the numbers of Table 1."""
    gravity, opening, *factors = PRINTED.numbers("Table 1", "g", "a", "C1", "C2", "C3")
    area, drops = PRINTED["Table 1", "A"].value, -np.diff([*LEVELS, 0.0])
    k1, k2, k3 = opening * np.array(factors) * np.sqrt(2.0 * gravity) / (2.0 * np.sqrt(drops))
    return np.array([[-k1, k1, 0.0], [k1, -(k2 + k1), k2], [0.0, k2, -(k2 + k3)]]) / area
