"""What an input does to its output while other loops hold theirs."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.models.transfer_element import TransferElement, element_of_roots
from clepsydra.linear.dead_time import at_rest, lags_of
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.minimal_realisation import minimal_realisation
from clepsydra.linear.poles import origin_radius
from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.response import evaluate_transfer
from clepsydra.linear.zeros import zeros

# A pole and a zero that differ by less than this share of their size cancel.
_CANCEL = 1e-6


@lru_cache(maxsize=64)
def held_element(
    model: LinearModel, pair: tuple[str, str], others: tuple[tuple[str, str], ...]
) -> TransferElement:
    """Return the transfer function of a pair with the outputs of other pairs held at rest.

    It is det G/det G' with G' that of the others alone, which is 1/(G⁻¹)_kk = g_kk/λ_kk. The zeros
    of G and the poles of G' are its zeros, the poles of G and the zeros of G' its poles, but
    for those that cancel: a level that is held is no lag any more.

    Parameters
    ----------
    pair : (output, input)
    others : tuple of (output, input)
        At least one.

    Raises
    ------
    NotApplicable
        Ways of different dead time lead to the outputs, the others cannot hold their outputs
        without running away, or only by an input that is faster than any.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, sections
    3.4 and 10.6.

    Examples
    --------
    A level x falls by what flows out, x + u, and rises by v. With the outflow held it integrates:

    >>> A, one = np.array([[-1.0]]), np.array([[1.0]])
    >>> model = LinearModel(A, np.array([[1.0, -1.0]]), one[:, :0], np.array([[1.0], [1.0]]),
    ...                     np.array([[0.0, 0.0], [0.0, 1.0]]), ("x",), ("v", "u"), (),
    ...                     ("level", "flow"))
    >>> found = held_element(model, ("level", "v"), (("flow", "u"),))
    >>> round(found.gain, 12), found.integrators, found.poles, found.zeros
    (1.0, 1, (), ())
    """
    outputs, inputs = zip(pair, *others, strict=True)
    whole, rest = (list(outputs), list(inputs)), (list(outputs[1:]), list(inputs[1:]))
    lags = lags_of(model.select(*whole))
    if lags is None:
        raise NotApplicable("ways of different dead time lead to what is controlled together")
    together, apart = (at_rest(model.select(*names)) for names in (whole, rest))
    radius = origin_radius(model.A)
    ups, downs = _without_common(
        np.concatenate([zeros(together), _poles(apart)]),
        np.concatenate([_poles(together), zeros(apart)]),
        radius,
    )

    def value_at(point: float) -> complex:
        matrices = together.A, together.B, together.C, together.D
        gains = evaluate_transfer(*matrices, np.array([point]))[0]
        return complex(gains[0, 0] / relative_gain_array(gains)[0, 0])

    if len(ups) > len(downs):
        raise NotApplicable("the other loops would have to act faster than any can")
    return element_of_roots(downs, ups, radius, value_at, float(lags.outputs[0] - lags.inputs[0]))


def _poles(model: LinearModel) -> np.ndarray:
    A = minimal_realisation(model.A, model.B, model.C, model.D)[0]
    return np.linalg.eigvals(A).astype(complex) if len(A) else np.zeros(0, complex)


def _without_common(
    ups: np.ndarray, downs: np.ndarray, radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return zeros and poles without those that are the same."""
    kept = []
    for root in ups:
        apart = np.abs(downs - root)
        nearest = int(np.argmin(apart)) if len(apart) else 0
        if len(apart) and apart[nearest] <= max(_CANCEL * abs(root), radius):
            downs = np.delete(downs, nearest)
        else:
            kept.append(root)
    return np.array(kept, complex), downs
