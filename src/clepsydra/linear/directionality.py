"""How strongly a process answers in each direction, and how its loops interact, by frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.base.json_values import json_values
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import integrators
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.response import frequency_response

# The few frequencies of a table, in each decade.
_NICE = (1.0, 3.0)
_MOST = 9


def singular_values(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return the singular values of G(jω): the gains of the strongest to the weakest direction.

    They depend on units; `in_known_ranges(model)` gives those that compare. There a smallest value
    below one says that some combination of outputs cannot be moved through its range.

    Parameters
    ----------
    omegas : array_like [l]
        [rad/s]

    Returns
    -------
    ndarray [l, min(q, m)]
        Falling. [output unit / input unit], where all outputs and all inputs share one.

    Raises
    ------
    InputError
        A frequency is not finite or is a pole.

    Examples
    --------
    >>> A, B = -np.eye(2), np.array([[3.0, 0.0], [0.0, 4.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.eye(2), np.zeros((2, 2)), ("a", "b"),
    ...                     ("u", "v"), (), ("y", "z"))
    >>> singular_values(model, 0.0)
    array([[4., 3.]])
    """
    return np.asarray(np.linalg.svd(frequency_response(model, omegas), compute_uv=False))


def condition_numbers(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return the condition number of G(jω), its largest over its smallest singular value.

    Above about ten, a controller that inverts the model follows its small errors. Like the
    singular values it depends on units.

    Parameters
    ----------
    omegas : array_like [l]
        [rad/s]

    Returns
    -------
    ndarray [l]
        [1]; infinite where some combination of outputs answers to no input.

    Raises
    ------
    InputError
        A frequency is not finite or is a pole.
    """
    sizes = singular_values(model, omegas)
    largest, smallest = sizes[:, 0], sizes[:, -1]
    nothing = smallest <= np.finfo(float).eps * largest
    return np.where(nothing, np.inf, largest / np.where(nothing, 1.0, smallest))


@dataclass(frozen=True, eq=False)
class Directionality:
    """Singular values, condition numbers and relative gains at some frequencies.

    Parameters
    ----------
    frequencies : ndarray [l]
        [rad/s]
    singular_values : ndarray [l, min(q, m)] or None
        Of G(jω) from shares of the inputs' ranges to shares of the outputs' ranges [1], falling;
        None where a signal has no range.
    condition_numbers : ndarray [l] or None
        [1], the largest over the smallest.
    relative_gains : ndarray [l, q, m], complex
        [1]; not a number where G(jω) has not full rank.
    """

    frequencies: np.ndarray
    singular_values: np.ndarray | None
    condition_numbers: np.ndarray | None
    relative_gains: np.ndarray

    def as_dict(self) -> dict[str, Any]:
        """Return it as values for JSON; a relative gain is {"re": …, "im": …} or null."""
        found: dict[str, Any] = json_values(vars(self))
        return found


def directionality(model: LinearModel, omegas: ArrayLike) -> Directionality:
    """Return how the process answers at these frequencies, exact with dead time.

    Parameters
    ----------
    omegas : array_like [l]
        [rad/s]; none of them a pole.

    Raises
    ------
    InputError
        A frequency is not finite or is a pole.
    """
    frequencies = np.atleast_1d(np.asarray(omegas, float))
    shares = in_known_ranges(model)
    gains = []
    for gain in frequency_response(shares or model, frequencies):
        try:
            gains.append(relative_gain_array(gain))
        except InputError:  # a zero: nothing to divide by
            gains.append(np.full(gain.shape, np.nan + 0j))
    return Directionality(
        frequencies,
        None if shares is None else singular_values(shares, frequencies),
        None if shares is None else condition_numbers(shares, frequencies),
        np.array(gains, complex).reshape(len(frequencies), len(model.outputs), len(model.inputs)),
    )


def few_frequencies(model: LinearModel, poles: np.ndarray) -> np.ndarray:
    """Return round frequencies [rad/s] about the poles, and zero where nothing integrates.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> few_frequencies(tank, np.array([-0.02]))
    array([0.   , 0.003, 0.01 , 0.03 , 0.1  ])
    """
    rates = np.abs(poles[np.abs(poles) > 0.0])
    rates = np.append(rates, 1.0 / model.times)
    low, high = (rates.min() / 9.0, rates.max() * 9.0) if rates.size else (0.01, 100.0)
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    nice = [float(f"{share:g}e{k}") for k in decades for share in _NICE]
    chosen = [omega for omega in nice if low <= omega <= high]
    if len(chosen) > _MOST:
        chosen = [chosen[i] for i in np.linspace(0, len(chosen) - 1, _MOST).round().astype(int)]
    return np.array(chosen if integrators(model.A) else [0.0, *chosen])
