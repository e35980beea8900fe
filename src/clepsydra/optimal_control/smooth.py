"""Equations without kinks, for a solver that follows slopes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

#: Points of the box of all states and inputs at which it is looked on which side of a kink one is.
_POINTS = 256
#: What of a difference is only the computer's rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Smoothed:
    """A function whose kinks are rounded.

    Parameters
    ----------
    function : casadi.Function
    kinks : int
        How many there are; those that the box never sees from both sides are none.
    """

    function: ca.Function
    kinks: int


def smoothed(function: ca.Function, low: ArrayLike, high: ArrayLike, share: float) -> Smoothed:
    """Return a function with max(a, b), min(a, b) and |a| replaced by smooth ones.

    max(a, b) = (a + b + |a - b|) / 2, and |d| becomes √(d² + (r D)²), with D the largest |d| in the
    box of arguments and r the share: at the kink it is r D too high. A kink that is passed nowhere
    in the box is replaced by the side on which the box is. What calls other functions is left as
    it is.

    Parameters
    ----------
    function : casadi.Function
        SX function of one vector.
    low, high : array_like
        The box of its argument; finite.
    share : float
        r, above 0.

    Examples
    --------
    >>> x = ca.SX.sym("x", 1)
    >>> found = smoothed(ca.Function("f", [x], [ca.fabs(x)]), [-1.0], [1.0], 0.01)
    >>> found.kinks, float(found.function(0.0)), round(float(found.function(1.0)), 4)
    (1, 0.01, 1.0)
    """
    if any(function.instruction_id(k) == ca.OP_CALL for k in range(function.n_instructions())):
        return Smoothed(function, 0)
    x = ca.SX.sym("x", function.numel_in(0))
    _, differences = _walked(function, x, ())
    sides = _sides(x, differences, np.asarray(low, float), np.asarray(high, float))
    outputs, _ = _walked(function, x, [_rounded(*side, share) for side in sides])
    kinks = sum(sign == 0 for sign, _ in sides)
    return Smoothed(ca.Function(function.name(), [x], outputs), kinks)


def _sides(
    x: ca.SX, differences: list[ca.SX], low: np.ndarray, high: np.ndarray
) -> list[tuple[int, float]]:
    """Return of each difference its sign, 0 where that changes in the box, and its largest size."""
    if not differences:
        return []
    random = np.random.default_rng(1).random((len(low), _POINTS))
    points = np.column_stack([low, high, low[:, None] + (high - low)[:, None] * random])
    found = np.array(ca.Function("differences", [x], [ca.vertcat(*differences)])(points))
    sizes = np.max(np.abs(found), axis=1)
    over = np.min(found, axis=1) >= -_ROUNDING * sizes
    under = np.max(found, axis=1) <= _ROUNDING * sizes
    signs = over.astype(int) - under.astype(int)
    return list(zip(signs.tolist(), sizes.tolist(), strict=True))


def _rounded(sign: int, size: float, share: float) -> Callable[[ca.SX], ca.SX]:
    """Return what stands for the magnitude of a difference."""
    if sign:
        return lambda difference: sign * difference
    width = share * size
    return lambda difference: ca.sqrt(difference * difference + width * width)


def _walked(
    function: ca.Function, x: ca.SX, magnitudes: Sequence[Callable[[ca.SX], ca.SX]]
) -> tuple[list[ca.SX], list[ca.SX]]:
    """Return the outputs, and the difference of each kink.

    Parameters
    ----------
    magnitudes : sequence of callable
        What stands for the magnitude of each of these; the magnitude itself where there is none.
    """
    work = [ca.SX(0)] * function.sz_w()
    values = [[ca.SX(0)] * function.nnz_out(place) for place in range(function.n_out())]
    differences: list[ca.SX] = []

    def magnitude(difference: ca.SX) -> ca.SX:
        differences.append(difference)
        return magnitudes[len(differences) - 1](difference) if magnitudes else difference.fabs()

    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        target, source = function.instruction_output(k), function.instruction_input(k)
        if code == ca.OP_OUTPUT:
            values[target[0]][target[1]] = work[source[0]]
            continue
        if code == ca.OP_INPUT:
            found = x[source[1]]
        elif code == ca.OP_CONST:
            found = ca.SX(function.instruction_constant(k))
        elif code == ca.OP_FABS:
            found = magnitude(work[source[0]])
        elif code in (ca.OP_FMIN, ca.OP_FMAX):
            a, b = (work[place] for place in source)
            apart = magnitude(a - b)
            found = (a + b + (apart if code == ca.OP_FMAX else -apart)) / 2
        elif len(source) == 2:
            found = ca.SX.binary(code, work[source[0]], work[source[1]])
        else:
            found = ca.SX.unary(code, work[source[0]])
        work[target[0]] = found
    shapes = (function.sparsity_out(place) for place in range(function.n_out()))
    outputs = [ca.SX(shape, ca.vertcat(*v)) for shape, v in zip(shapes, values, strict=True)]
    return outputs, differences
