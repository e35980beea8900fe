"""Refinement of a sampled model by the simplex search of Nelder and Mead."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.designs.polynomial.element_sampling import sampled_transfer
from clepsydra.designs.polynomial.sampled_model import SampledModel

#: The search ends when its simplex is this small, and the cost this flat.
_PARAMETERS, _COST = 1e-9, 1e-12
_EVALUATIONS = 20_000
#: A candidate whose output leaves all numbers behind.
_USELESS = 1e300


def simplex_fit(
    model_at: Callable[[np.ndarray], SampledModel],
    start: np.ndarray,
    signal: np.ndarray,
    output: np.ndarray,
) -> SampledModel:
    """Fit the simulated output of a model to a record, from a start on, without derivatives.

    Other than least squares, which predicts one sample ahead from what was measured, the model
    runs by itself over the whole record, so that its static gain counts. The parameters are scaled
    so that changes of 5 % are reasonable; a search without an end is an InputError.

    References
    ----------
    J. C. Lagarias, J. A. Reeds, M. H. Wright, P. E. Wright, Convergence properties of the
    Nelder-Mead simplex method in low dimensions, SIAM Journal on Optimization 9, 1998, 112-147.
    """
    from scipy.optimize import minimize

    scale = float(output @ output)

    def cost(parameters: np.ndarray) -> float:
        with np.errstate(all="ignore"):
            try:
                difference = output - model_at(parameters).output(signal)
            except (InputError, OverflowError, ValueError):
                return _USELESS
            value = float(difference @ difference) / scale
        return value if math.isfinite(value) else _USELESS

    found = minimize(
        cost, np.asarray(start, dtype=float), method="Nelder-Mead",
        options={"xatol": _PARAMETERS, "fatol": _COST, "maxfev": _EVALUATIONS,
                 "maxiter": _EVALUATIONS},
    )  # fmt: skip
    if not found.success or found.fun >= _USELESS:
        raise InputError(
            "simplex search", Finding(f"no end after {found.nfev} simulations"),
            "a record that the model can follow", "start nearer, or take fewer parameters",
        )  # fmt: skip
    return model_at(found.x)


def refined_coefficients(
    model: SampledModel, signal: np.ndarray, output: np.ndarray
) -> SampledModel:
    """Refine all coefficients of a model, with its delay, so that its simulated output fits.

    Examples
    --------
    >>> u = np.sign(np.sin(1.7 * np.arange(60) ** 1.3))
    >>> right, guess = (SampledModel((b,), (a,), 2, 1.0) for b, a in ((0.2, -0.9), (0.3, -0.8)))
    >>> refined_coefficients(guess, u, right.output(u)).in_words()
    '(0.2 z⁻¹) / (1 − 0.9 z⁻¹) z⁻²'
    """
    n = model.order
    given = np.array([*model.denominator, *model.numerator])
    sizes = np.where(given == 0.0, float(np.max(np.abs(given))), given)

    def model_at(shares: np.ndarray) -> SampledModel:
        values = shares * sizes
        return SampledModel(tuple(values[n:]), tuple(values[:n]), model.delay, model.period)

    return simplex_fit(model_at, given / sizes, signal, output)


def second_order_of_gain(
    signal: np.ndarray,
    output: np.ndarray,
    *,
    gain: float,
    delay: int,
    period: float,
    start: tuple[float, float],
) -> SampledModel:
    """Fit k ω²/(s² + 2 ζ ω s + ω²), without zeros and with a known static gain, held and delayed.

    It starts from ω [rad/s] and ζ and searches their logarithms; the delay is in samples and the
    period in s.

    Examples
    --------
    >>> u = np.append([0.0, 0.0], np.ones(58))
    >>> right = sampled_transfer([2 * 0.04], [1.0, 0.32, 0.04], 3, 1.0)
    >>> found = second_order_of_gain(u, right.output(u), gain=2.0, delay=3, period=1.0,
    ...                              start=(0.1, 1.2))
    >>> bool(np.allclose(found.A, right.A, atol=1e-8))
    True
    """

    def model_at(logarithms: np.ndarray) -> SampledModel:
        frequency, damping = np.exp(logarithms)
        square = frequency**2
        return sampled_transfer(
            [gain * square], [1.0, 2.0 * damping * frequency, square], delay, period
        )

    return simplex_fit(model_at, np.log(start), signal, output)
