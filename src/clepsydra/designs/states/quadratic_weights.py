"""The weights of a quadratic cost, by matrices or by names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from clepsydra.base.arguments import is_finite_number, require_type
from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.linear_model import LinearModel

T = TypeVar("T")
#: A weight this far below zero, as a share of the largest, is rounding and not negative.
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class QuadraticWeights:
    """The cost ∫ xᵀ Q x + uᵀ R u dt + Δt Σ wᵀ W w of deviations x, u and integrals w = ∫ y dt.

    Parameters
    ----------
    states : ndarray [n, n]
        Q, symmetric, not negative [1 / state unit²].
    inputs : ndarray [m, m]
        R, symmetric, positive definite [1 / input unit²].
    integrals : ndarray [q, q] or None
        W, symmetric, positive definite [1 / (output unit · s)²]; None without integral action.

    Raises
    ------
    InputError
        A weight is no symmetric matrix of finite numbers, or not definite as it must be.

    Examples
    --------
    >>> QuadraticWeights(np.eye(2), -np.eye(1))
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: weights, inputs: got [[-1.0]], expected a positive definite \
matrix; its smallest eigenvalue is -1, raise the weights on its diagonal.
    """

    states: np.ndarray
    inputs: np.ndarray
    integrals: np.ndarray | None = None

    def __post_init__(self) -> None:
        for name in ("states", "inputs", "integrals"):
            if name != "integrals" or self.integrals is not None:
                matrix = _checked(name, getattr(self, name), positive=name != "states")
                object.__setattr__(self, name, matrix)


def checked_weights(weights: object, model: LinearModel) -> QuadraticWeights:
    """Return given weights if they are weights and fit a model.

    Raises
    ------
    InputError

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> checked_weights([4.0, 0.25], tank)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: weights: got 'a list', expected QuadraticWeights; make them \
by diagonal_weights(model, {"tank.level": 1.0}, {"pump": 1.0}), or from matrices.
    """
    example = f'{{"{model.states[0]}": 1.0}}, {{"{model.inputs[0]}": 1.0}}'
    remedy = f"make them by diagonal_weights(model, {example}), or from matrices"
    require_type(weights, QuadraticWeights, "weights", "QuadraticWeights", remedy)
    assert isinstance(weights, QuadraticWeights)
    names = {"states": model.states, "inputs": model.inputs, "integrals": model.outputs}
    for what, known in names.items():
        size, matrix = len(known), getattr(weights, what)
        if matrix is not None and matrix.shape != (size, size):
            expected = f"a matrix of {(size, size)}, for {', '.join(known)}"
            remedy = "give one row and one column for each"
            raise InputError(f"weights, {what}", matrix.shape, expected, remedy)
    return weights


def by_weights(
    gains_of: Callable[[QuadraticWeights], T],
    weights: QuadraticWeights,
    usual: QuadraticWeights | None,
) -> T:
    """Return the gains by given weights; where there are none, say whether that is their fault.

    Parameters
    ----------
    gains_of : callable
        Takes weights.
    usual : QuadraticWeights or None
        None where the weights are the usual ones.

    Raises
    ------
    InputError
        The usual weights have gains, and these have none.
    NotApplicable
        No weights have gains.

    Examples
    --------
    >>> by_weights(lambda given: given.inputs, QuadraticWeights(np.eye(1), 2.0 * np.eye(1)), None)
    array([[2.]])
    """
    try:
        return gains_of(weights)
    except NotApplicable as refusal:
        if usual is None:
            raise
        gains_of(usual)
        raise InputError(
            "weights",
            refusal.reason,
            "weights that make a stable loop",
            "weigh every state that does not settle by itself, and begin with 1 over the square "
            "of the largest acceptable deviation for every weight",
        ) from None


def diagonal_weights(
    model: LinearModel,
    states: Mapping[str, float],
    inputs: Mapping[str, float],
    integrals: Mapping[str, float] | None = None,
) -> QuadraticWeights:
    """Return weights on squares of named quantities; states that are left out have none.

    Parameters
    ----------
    states, inputs, integrals : mapping
        Names of states, inputs and outputs to their weights.

    Raises
    ------
    InputError
        A name is unknown, an input or output is left out, or a weight is not positive.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> diagonal_weights(tank, {"tank.level": 4.0}, {"pump": 0.25}).inputs
    array([[0.25]])
    """
    return QuadraticWeights(
        _diagonal("states", states, model.states, whole=False),
        _diagonal("inputs", inputs, model.inputs, whole=True),
        None if integrals is None else _diagonal("integrals", integrals, model.outputs, whole=True),
    )


def _diagonal(
    what: str, given: Mapping[str, float], names: Sequence[str], *, whole: bool
) -> np.ndarray:
    place = f"weights, {what}"
    if not isinstance(given, Mapping):
        raise InputError(place, given, "names with numbers", "give a dictionary")
    for name, value in given.items():
        if name not in names:
            remedy = suggestion(str(name), names, "correct the name")
            raise InputError(place, name, f"one of {', '.join(names)}", remedy)
        if not is_finite_number(value) or value < 0.0 or (whole and value == 0.0):
            least = "above zero" if whole else "not below zero"
            raise InputError(f"{place}, {name}", value, f"a number {least}", "correct the weight")
    missing = [name for name in names if name not in given]
    if whole and missing:
        raise InputError(
            place, sorted(given), f"a weight for {', '.join(names)}", f"add {', '.join(missing)}"
        )
    return np.diag([float(given.get(name, 0.0)) for name in names])


def _checked(name: str, matrix: np.ndarray, *, positive: bool) -> np.ndarray:
    place = f"weights, {name}"
    try:
        numbers = np.asarray(matrix, float)
    except (TypeError, ValueError):
        numbers = np.full((1, 2), np.nan)
    square = numbers.ndim == 2 and numbers.shape[0] == numbers.shape[1]
    if not square or not np.all(np.isfinite(numbers)):
        expected = "a square matrix of finite numbers"
        raise InputError(place, matrix, expected, "give one number for each pair")
    size = float(np.abs(numbers).max(initial=0.0))
    if not np.allclose(numbers, numbers.T, rtol=0.0, atol=_ROUNDING * size):
        remedy = "take half of the matrix and its mirror"
        raise InputError(place, numbers.tolist(), "a symmetric matrix", remedy)
    # In the roots of the diagonal: the weights of signals of other units differ by far.
    diagonal = np.diag(numbers)
    sizes = np.sqrt(np.where(diagonal > 0.0, diagonal, size or 1.0))
    smallest = float(np.linalg.eigvalsh(numbers / np.outer(sizes, sizes)).min(initial=np.inf))
    if smallest < -_ROUNDING or (positive and smallest <= _ROUNDING):
        smallest = float(np.linalg.eigvalsh(numbers).min())
        expected = "a positive definite matrix" if positive else "a matrix that is not negative"
        remedy = f"its smallest eigenvalue is {smallest:.3g}, raise the weights on its diagonal"
        raise InputError(place, numbers.tolist(), expected, remedy)
    return numbers
