"""Equations (9), (10) and (12) to (18): the chain and its model, sampled and estimated.

(10) and (16) define the model and the error, and (19) is a command whose function and start are
not printed, so that no row judges these; what the command finds is in `second_order_model`.
"""

from __future__ import annotations

import numpy as np

from clepsydra.identification.arx import fit_arx, regressors
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.identification import record
from clepsydra.papers.eight_tanks.six_designs import (
    GAIN,
    PERIOD,
    PRINTED_D,
    TANKS,
    TIME_CONSTANT,
    printed_model,
    sampled_chain,
)
from clepsydra.papers.rational_function import RationalFunction, exact, symbol, symbols
from clepsydra.papers.row import Row, Rows

#: Terms of a series in z^-1 that are compared.
_TERMS = 40
#: What binomials of the eighth power leave of rounding [min/m²].
_ROUNDING = 1e-12
#: An estimate from a record without noise is exact but for that.
_EXACT = 1e-6
_ORDER = 2


def run() -> Found:
    """Return the rows of these equations."""
    return (_held_chain(), *_second_order(), *_estimates(), _first_error())


def held_coefficients() -> np.ndarray:
    """Return A(x) (1 − x) Σ h(k) x^k by powers of x = z^-1, where h is the step response of (8).

    Behind eight equal tanks it is h(k) = K_g P(8, k T0/T), an incomplete gamma function. With
    the A of the sampled chain this is B of (9), and nothing else.
    """
    from scipy.special import gammainc

    step = GAIN * gammainc(TANKS, np.arange(_TERMS) / TIME_CONSTANT)
    return np.convolve(np.convolve(sampled_chain().A, [1.0, -1.0]), step)[:_TERMS]


def _held_chain() -> Row:
    model = sampled_chain()
    B = np.zeros(_TERMS)
    B[1 : 1 + len(model.numerator)] = model.numerator
    is_right = (
        len(model.numerator) == len(model.denominator) == TANKS
        and float(np.max(np.abs(held_coefficients() - B))) < _ROUNDING
    )
    words = ", ".join(
        f"{name}1 = {values[0]:.4g}, {name}{len(values)} = {values[-1]:.4g}"
        for name, values in (("b", model.numerator), ("a", model.denominator))
    )
    return PRINTED["(9)", "form of the chain, sampled"].stated(words, is_right)


def _second_order() -> Rows:
    """Write (10) with the operator x = z^-1 as an equation of samples, and with d = 5."""
    x, z, k, d, a1, a2, b1, b2 = symbols("x z k d a1 a2 b1 b2")
    A, B = 1 + a1 * x + a2 * x**2, b1 * x + b2 * x**2

    def moved(
        operator: RationalFunction, signal: str, late: RationalFunction | int
    ) -> RationalFunction:
        terms = operator.numerator.coefficients("x").items()
        return sum(
            (
                RationalFunction(factor) * symbol(f"{signal}({k - power - late})")
                for power, factor in terms
            ),
            start=exact(0),
        )

    predicted = moved(B, "u", d) - moved(A - 1, "y", 0)
    yield PRINTED["(13)", "y(k)"].formula(predicted + symbol("e_s(k)"))
    yield PRINTED["(15)", "predicted output"].formula(predicted)
    yield PRINTED["(18)", "model with five steps of delay"].formula(
        (B / A * x**PRINTED_D).with_values({"x": 1 / z})
    )


def _estimates() -> Rows:
    """Estimate (21) from a record that it made itself, and from one with noise by (12)."""
    model = printed_model()
    inflow, _ = record(0, 1)
    level = model.output(inflow)
    found = fit_arx(inflow, level, order=_ORDER, delay=PRINTED_D, period=PERIOD).coefficients
    made = np.array([*model.denominator, *model.numerator])
    words = ", ".join(f"{value:.4g}" for value in found)
    is_right = float(np.max(np.abs(found - made))) < _EXACT
    row = PRINTED["(14)", "order of the estimates"].stated(words, is_right)
    yield row.circular(
        "F is that of another paper, and not printed: here its columns are put in this order, "
        "which is that of (13)."
    )
    noise = np.random.default_rng(1).normal(0.0, float(np.std(level)), len(level))
    F, y = regressors(inflow, level + noise, _ORDER, PRINTED_D)
    by_12 = np.linalg.inv(F.T @ F) @ F.T @ y
    (least, *_) = np.linalg.lstsq(F, y)
    yield PRINTED["(12)", "estimate of least squares"].stated(
        ", ".join(f"{value:.4g}" for value in least),
        float(np.max(np.abs(by_12 - least))) < _EXACT,
    )


def _first_error() -> Row:
    first = _ORDER + PRINTED_D + 1
    return PRINTED["(17)", "first sample of the sum"].remark(f"k = {first} for d = {PRINTED_D}")
