"""A regulator that was designed elsewhere: its four matrices, looked at before they are used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.quantity import Quantity
from clepsydra.controllers.conditioned_linear import MOST_STATES

METHOD = "regulator"
#: From here on a number is a mistake, or the regulator a limiter.
_LARGEST = 1e12
_NAMES = ("A", "B", "C", "D")
_TOGETHER = "give A, B, C and D of one state space"
SAMPLING_PERIOD = Quantity(
    "sampling_period", "s", low=0.0, strict=True, expected="a time",
    remedy='write as in "1 s", or leave it out in continuous time',
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class GivenRegulator:
    """x' = A x + B e, u = C x + D e in continuous time, or x(k+1) with a sampling period.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, p], [m, n], [m, p]
        In units of one's own. A D of a single zero is one of the size that fits.
    period : float, optional
        Of a regulator that is sampled already [s].
    place : str
        Where it stands, for messages.

    Raises
    ------
    InputError
        A matrix is none of real finite numbers, or two do not fit together; there are no or more
        than 60 states; or the period is none.

    Examples
    --------
    PI control with K = 2 and Ti = 10 s:

    >>> GivenRegulator(0.0, 0.2, 1.0, 2.0).D.tolist()
    [[2.0]]
    >>> GivenRegulator([[0.0, 1.0]], 0.2, 1.0, 2.0)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: regulator, A: got '1 × 2', expected a square matrix of 1 to \
60 states; give A, B, C and D of one state space, a regulator without states as a PID or own law.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    period: float | None = None
    place: str = METHOD

    def __post_init__(self) -> None:
        for name in _NAMES:
            object.__setattr__(self, name, self._matrix(name))
        n, (m, _), (_, p), together = len(self.A), self.C.shape, self.B.shape, _TOGETHER
        if self.A.shape != (n, n) or not 1 <= n <= MOST_STATES:
            remedy = f"{together}, a regulator without states as a PID or own law"
            if n == self.A.shape[1] > MOST_STATES:
                remedy = "reduce the order of the regulator, as with balred or balreduce"
            raise self._refused("A", f"a square matrix of 1 to {MOST_STATES} states", remedy)
        if self.D.shape == (1, 1) and not self.D.any():
            object.__setattr__(self, "D", np.zeros((m, p)))
        for name, (rows, columns) in (("B", (n, p)), ("C", (m, n)), ("D", (m, p))):
            if getattr(self, name).shape != (rows, columns):
                others = f"as the others have {n} states, {p} inputs and {m} outputs"
                raise self._refused(name, f"{rows} × {columns}, {others}", together)
        period = self.period
        if period is not None and (not is_finite_number(period) or period <= 0.0):
            remedy = "leave it out for a regulator in continuous time"
            raise InputError(f"{self.place}, sampling period", period, "a time above 0", remedy)

    def _matrix(self, name: str) -> np.ndarray:
        expected, remedy = "a matrix of real finite numbers", "give numbers alone, without units"
        place = f"{self.place}, {name}"
        try:
            given = np.asarray(getattr(self, name))
        except ValueError:  # rows of different lengths
            raise InputError(place, "rows of different lengths", expected, remedy) from None
        is_complex = given.dtype.kind == "c"
        if is_complex and not np.any(np.imag(given)):
            given = np.real(given)
        if given.ndim > 2 or given.dtype.kind not in "iuf":
            shown = "complex numbers" if is_complex else f"{given.dtype} numbers"
            shown = f"{given.ndim} dimensions" if given.ndim > 2 else shown
            raise InputError(place, shown, expected, remedy)
        found = np.array(np.atleast_2d(given), float)
        wrong = found[~(np.abs(found) <= _LARGEST)]
        if wrong.size:
            expected = f"{expected}, none above {_LARGEST:g}"
            remedy = "look at how the regulator was made"
            raise InputError(place, float(wrong[0]), expected, remedy)
        return found

    def _refused(self, name: str, expected: str, remedy: str) -> InputError:
        rows, columns = getattr(self, name).shape
        return InputError(f"{self.place}, {name}", f"{rows} × {columns}", expected, remedy)


def given_regulator(regulator: Any, period: float | None = None) -> GivenRegulator:
    """Return a regulator from its matrices, or from what has them.

    Parameters
    ----------
    regulator : sequence of four matrices, GivenRegulator, or object
        A, B, C and D; or a StateSpace of python-control or SciPy.
    period : float, optional
        Of a regulator that is sampled already, and does not say so itself [s].

    Raises
    ------
    InputError
        It is none of these, it is wrong, or it has another sampling period than the one given.

    Examples
    --------
    >>> import control
    >>> given_regulator(control.ss([[0.5]], [[1.0]], [[1.0]], [[0.0]], 2.0)).period
    2.0
    """
    place, stated = METHOD, None
    if isinstance(regulator, GivenRegulator):
        stated, place = regulator.period, regulator.place
        matrices: Any = [getattr(regulator, name) for name in _NAMES]
    elif all(hasattr(regulator, name) for name in _NAMES):
        matrices = [getattr(regulator, name) for name in _NAMES]
        stated = _period_of(regulator, period)
    elif isinstance(regulator, (list, tuple)) and len(regulator) == len(_NAMES):
        matrices = regulator
    else:
        expected = "a MAT file, four matrices (A, B, C, D), or a state space of python-control or "
        remedy = "turn a transfer function into one, as with control.ss(controller)"
        raise InputError(METHOD, f"a {type(regulator).__name__}", f"{expected}SciPy", remedy)
    if period is not None and stated is not None and not np.isclose(period, stated, rtol=1e-9):
        expected = f"{stated:g} s, as the regulator has"
        raise InputError(f"{place}, sampling period", f"{period:g} s", expected, "leave it out")
    A, B, C, D = matrices
    return GivenRegulator(A, B, C, D, stated if stated is not None else period, place)


def _period_of(system: Any, given: float | None) -> float | None:
    """Return the sampling period of a system; None in continuous time, or where it is given."""
    step = getattr(system, "dt", 0)
    # SciPy's continuous systems have none; of python-control that is a time not told.
    if step is None and type(system).__module__.startswith("scipy."):
        return None
    if (step is None or step is True) and given is None:
        remedy = 'give it, as in sampling_period="1 s", or 0 to the system for continuous time'
        expected = "the one that it was designed for"
        raise InputError(f"{METHOD}, sampling period", "none", expected, remedy)
    return None if step is None or step is True or step == 0 else float(step)
