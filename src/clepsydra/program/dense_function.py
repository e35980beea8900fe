"""A CasADi function called with numbers, without CasADi's own matrices."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike


class DenseFunction:
    """A function of vectors of numbers, for who calls it hundreds of times.

    CasADi's matrices would cost five times as much as the numbers in them.

    Parameters
    ----------
    name : str
    symbols : sequence of casadi.SX
        A vector each.
    results : sequence of casadi.SX
        Expressions of them.

    Examples
    --------
    >>> x = ca.SX.sym("x", 2)
    >>> DenseFunction("slopes", [x], [ca.jacobian(x * x[0], x)])([3.0, 5.0])
    [array([[6., 0.],
           [5., 3.]])]
    """

    def __init__(self, name: str, symbols: Sequence[ca.SX], results: Sequence[ca.SX]) -> None:
        # One vector each way: every further one would cost as much as the numbers in it.
        whole = ca.vertcat(*(ca.vec(ca.densify(each)) for each in results))
        self._function = ca.Function(name, [ca.vertcat(*symbols)], [whole])
        ends = np.cumsum([0, *(each.numel() for each in results)]).tolist()
        self._parts = [
            (slice(*between), each.shape)
            for between, each in zip(pairwise(ends), results, strict=True)
        ]
        #: How many numbers the results are together.
        self.size = ends[-1]

    def __call__(self, *vectors: ArrayLike) -> list[np.ndarray]:
        """Return each result as a matrix of its own."""
        given, found = np.concatenate(vectors, dtype=float), np.empty(self.size)
        buffer: Any  # CasADi's types ask for a size, which a view brings along
        buffer, evaluate = self._function.buffer()
        buffer.set_arg(0, given.data)
        buffer.set_res(0, found.data)
        evaluate()
        return [found[part].reshape(shape, order="F") for part, shape in self._parts]

    def each(self, *vectors: ArrayLike) -> list[np.ndarray]:
        """Return each result at k points, a stack of matrices [k, rows, columns].

        Parameters
        ----------
        vectors : array_like [k, size]

        Examples
        --------
        >>> x = ca.SX.sym("x", 2)
        >>> products = DenseFunction("products", [x], [x[0] * x[1]])
        >>> products.each([[3.0, 5.0], [2.0, 1.0]])[0].ravel()
        array([15.,  2.])
        """
        found = at_rows(self._function, [np.concatenate(vectors, axis=1)])
        return [
            found[:, part].reshape(len(found), *shape[::-1]).swapaxes(1, 2)
            for part, shape in self._parts
        ]


def at_rows(function: ca.Function, vectors: Sequence[np.ndarray]) -> np.ndarray:
    """Return the first result of a function of vectors at k points, a row each.

    CasADi goes through the points by itself, with the bits of each.

    Parameters
    ----------
    vectors : sequence of ndarray [k, size]

    Examples
    --------
    >>> x, y = ca.SX.sym("x", 2), ca.SX.sym("y")
    >>> sums = ca.Function("sums", [x, y], [x + y])
    >>> at_rows(sums, [np.array([[1.0, 2.0], [5.0, 6.0]]), np.array([[0.5], [0.0]])])
    array([[1.5, 2.5],
           [5. , 6. ]])
    """
    count = len(vectors[0])
    given = [np.ascontiguousarray(vector, float) for vector in vectors]
    found = np.empty((count, function.numel_out(0)))
    if count:
        buffer: Any
        buffer, evaluate = _mapped(function, count).buffer()
        for place, rows in enumerate(given):
            buffer.set_arg(place, rows.data)
        buffer.set_res(0, found.data)
        evaluate()
    return found


@lru_cache(maxsize=64)
def _mapped(function: ca.Function, count: int) -> ca.Function:
    """Return the function of that many points, which CasADi would make anew in every call."""
    symbols = [ca.MX.sym("vector", function.size_in(place)) for place in range(function.n_in())]
    first = ca.densify(function.call(symbols)[0])
    return ca.Function("first", symbols, [first]).map(count)
