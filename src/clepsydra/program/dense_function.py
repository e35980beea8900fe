"""A CasADi function called with numbers, without CasADi's own matrices."""

from __future__ import annotations

from collections.abc import Sequence
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
        self._function = ca.Function(name, list(symbols), [ca.densify(each) for each in results])
        self._shapes = [result.shape for result in results]

    def __call__(self, *vectors: ArrayLike) -> list[np.ndarray]:
        """Return each result as a matrix of its own."""
        arguments = [np.ascontiguousarray(vector, float) for vector in vectors]
        found = [np.empty(shape, order="F") for shape in self._shapes]
        buffer: Any  # CasADi's types ask for a size, which a view brings along
        buffer, evaluate = self._function.buffer()
        for place, values in enumerate(arguments):
            buffer.set_arg(place, values.data)
        for place, matrix in enumerate(found):
            buffer.set_res(place, matrix.T.data)
        evaluate()
        return found
