"""How inputs share their limits: the moves within them that leave the least summed error."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import casadi as ca

from clepsydra.controllers.blocks.validity import limit

#: More inputs would have too many corners to look at, in a law that somebody has to read.
MOST_INPUTS = 2
#: What is less than this share of a largest error decides nothing, or rounding would: neither a
#: gain in which moves differ, nor an effect of an input that goes from limit to limit.
_NOTHING = 1e-6
#: A determinant that is less than this share of its two products is none.
_SINGULAR = 1e-9
#: An input that may go further than this has no limits.
_FARTHEST = 1e30

Values = Sequence[ca.SX]


def shared_moves(
    errors: Values, slopes: Sequence[Values], low: Values, high: Values, largest: Values
) -> list[ca.SX]:
    """Return the moves within limits that leave the least sum of |e_j − Σ_i S_ji δ_i|/ē_j.

    Where the limits let them, all errors are made zero. Else the sum is least in a corner, where
    one input stands at a limit, or stays, and the other does for one output what it can.

    Parameters
    ----------
    errors : sequence of casadi.SX [m]
        e, what is left to be done.
    slopes : sequence of sequence of casadi.SX [m][m]
        S: what each move does, a row for each output.
    low, high : sequence of casadi.SX [m]
        Limits of the moves.
    largest : sequence of casadi.SX [m]
        ē, above zero.

    Examples
    --------
    One input moves both outputs, the other only the second. The first meets its limit; the second
    then makes up for what the first does to its output:

    >>> one = [ca.SX(1), ca.SX(1)]
    >>> given = [ca.SX(4), ca.SX(0)], [[ca.SX(1), ca.SX(0)], [ca.SX(1), ca.SX(1)]]
    >>> [float(move) for move in shared_moves(*given, [-3 * each for each in one], [3, 3], one)]
    [3.0, -3.0]
    """

    def limited(moves: Values) -> list[ca.SX]:
        return [limit(*each) for each in zip(moves, low, high, strict=True)]

    def left(moves: Values) -> ca.SX:
        return sum(
            (
                ca.fabs(e - sum(s * move for s, move in zip(row, moves, strict=True))) / size
                for e, row, size in zip(errors, slopes, largest, strict=True)
            ),
            ca.SX(0),
        )

    slopes = [
        [_felt(*each, size) for each in zip(row, low, high, strict=True)]
        for row, size in zip(slopes, largest, strict=True)
    ]
    if len(errors) == 1:
        return limited([_divided(errors[0], slopes[0][0])])
    best = limited(_solved(errors, slopes))
    least = left(best)
    for moves in map(limited, _corners(errors, slopes, low, high)):
        sum_left = left(moves)
        better = sum_left < least - _NOTHING
        least = ca.if_else(better, sum_left, least)
        best = [ca.if_else(better, new, old) for new, old in zip(moves, best, strict=True)]
    return best


def _corners(
    errors: Values, slopes: Sequence[Values], low: Values, high: Values
) -> list[list[ca.SX]]:
    """Return moves with one input at a place and the other solved for one output."""
    found = []
    for i, j in product(range(2), repeat=2):
        for place in (ca.SX(0), low[i], high[i]):
            rest = errors[j] - slopes[j][i] * place
            other = _divided(rest, slopes[j][1 - i])
            found.append([place, other] if i == 0 else [other, place])
    return found


def _solved(errors: Values, slopes: Sequence[Values]) -> list[ca.SX]:
    """Return the moves that make both errors zero, or none."""
    (a, b), (c, d) = slopes
    determinant = a * d - b * c
    sizes = ca.fabs(a * d) + ca.fabs(b * c)
    determinant = ca.if_else(ca.fabs(determinant) > _SINGULAR * sizes, determinant, 0)
    first, second = errors
    return [
        _divided(d * first - b * second, determinant),
        _divided(a * second - c * first, determinant),
    ]


def _felt(slope: ca.SX, low: ca.SX, high: ca.SX, largest: ca.SX) -> ca.SX:
    """Return a slope, or none where the whole way between the limits has hardly an effect."""
    width = ca.fmin(high - low, _FARTHEST)
    return ca.if_else(ca.fabs(slope) * width > _NOTHING * largest, slope, 0)


def _divided(value: ca.SX, by: ca.SX) -> ca.SX:
    return ca.if_else(by == 0, 0, value / ca.if_else(by == 0, 1, by))
