"""A convex quadratic program by an interior point of a fixed number of turns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import casadi as ca

from clepsydra.program.routine_library import Family, Written
from clepsydra.program.routine_writer import Elements, Loops
from clepsydra.program.routines.factors import factorise, substitute

#: Turns that suffice, also where the unconstrained optimum is a thousand times beyond the bounds.
TURNS = 18
#: How far towards the nearest bound a turn goes.
_SHARE = 0.995
#: Slack times multiplier stays above this share of their mean, or turns may run in circles.
_CENTRED = 0.02
#: Rows are as good as kept where so much is left of what crossed them at the start.
_KEPT = 0.1
#: And then where the gap grows so much of a correction is made, or turns may run in circles.
_HELD_BACK = 0.5
#: A gap below this share of the cost is that of an optimum.
_THERE = 1e-12
#: Slacks stay above this share of what they start from.
_LEAST = 1e-20
#: A bound from here on is none.
_FREE = 1e30
#: A share of the slope beside which a point is nothing.
_UNSEEN = 1e-14
#: What divides in place of zero, and what is above every number; single precision has its own.
_TINY, _MOST = 1e-300, 1e300
#: What is added to each curvature of one where it is tested whether all are above zero.
_ROUNDED = 1e-9


class ProgramSolution(NamedTuple):
    """Where a quadratic program is least.

    Parameters
    ----------
    solution : casadi.SX [n]
    residual : casadi.SX
        What is left of the conditions of an optimum, added up: slopes, rows, and slack times
        multiplier, each relative to the size of its terms. At most 1e-4 at an optimum. Where it
        is larger, or not a number, the rows exclude each other, the cost is not convex, an
        argument is not finite, or the turns were too few.
    """

    solution: ca.SX
    residual: ca.SX


def _written(n: int, m: int, turns: int) -> Written:
    def algorithm(loop: Loops, *arrays: Elements) -> None:
        hessian, linear, rows, bounds, solution, residual, *own = arrays
        size, weight, curve, slope, row, bound, x, slack, z, system, lower, pivot, *own = own
        move, slack_move, z_move, by_slope, by_row, push, per_slack, per_z, *own = own
        gap, other_gap, length, stiffness, least_slack, low, total, *own = own
        least_gap, crossing, part = own
        loop.note("Unknowns in sizes in which each curves by one, rows in units of their length.")
        for i in loop("i", 0, n):
            low[()] = ca.fabs(hessian[i, i])
            size[i] = 1 / ca.sqrt(ca.if_else(low[()] > 0, low[()], 1))
        for i in loop("i", 0, n):
            slope[i] = linear[i] * size[i]
            for j in loop("j", 0, n):
                curve[i, j] = 0.5 * (hessian[i, j] + hessian[j, i]) * size[i] * size[j]
        for r in loop("r", 0, m):
            low[()] = 0
            for j in loop("j", 0, n):
                row[r, j] = rows[r, j] * size[j]
                low[()] = ca.fmax(low[()], ca.fabs(row[r, j]))
            loop.note("What every point keeps, a row of zeros or without a bound, is left out.")
            free = ca.logic_or(bounds[r] >= _FREE, ca.logic_and(low[()] <= 0, bounds[r] >= 0))
            weight[r] = ca.if_else(free, 0, 1)
            low[()] = weight[r] / ca.if_else(low[()] > 0, low[()], 1)
            weight[r] = 0
            for j in loop("j", 0, n):
                row[r, j] = row[r, j] * low[()]
                weight[r] = weight[r] + row[r, j] * row[r, j]
            weight[r] = 1 / ca.sqrt(ca.if_else(weight[r] > 0, weight[r], 1))
            bound[r] = ca.if_else(low[()] <= 0, 1, bounds[r] * low[()] * weight[r])
            for j in loop("j", 0, n):
                row[r, j] = row[r, j] * weight[r]
        loop.note("Whether it is convex: else nothing that is found is the least.")
        for i in loop("i", 0, n):
            for j in loop("j", 0, i + 1):
                system[i, j] = curve[i, j]
            system[i, i] = system[i, i] + _ROUNDED
        factorise(loop, n, system, lower, pivot)
        residual[()] = 0
        total[()] = 0
        for i in loop("i", 0, n):
            residual[()] = ca.if_else(pivot[i] > 0, residual[()], 1)
            total[()] = total[()] + slope[i] * slope[i]
        loop.note("The start: the least without rows, then twice with a price of crossing rows.")
        for r in loop("r", 0, m):
            slack[r] = 1
        for _ in loop.again("turn", 3):
            gap[()] = ca.fmax(_TINY, 1e-12 * total[()])
            for r in loop("r", 0, m):
                gap[()] = ca.if_else(slack[r] < 0, gap[()] + bound[r] * bound[r], gap[()])
            stiffness[()] = ca.fmax(1, ca.sqrt(total[()] / gap[()]))
            for r in loop("r", 0, m):
                weight[r] = ca.if_else(slack[r] < 0, stiffness[()], 0)
            _system(loop, curve, row, weight, system, low)
            factorise(loop, n, system, lower, pivot, definite=True)
            for i in loop("i", 0, n):
                x[i] = -slope[i]
            for r in loop("r", 0, m):
                low[()] = weight[r] * bound[r]
                for i in loop("i", 0, n):
                    x[i] = x[i] + row[r, i] * low[()]
            substitute(loop, n, lower, pivot, x)
            for r in loop("r", 0, m):
                slack[r] = bound[r]
                for j in loop("j", 0, n):
                    slack[r] = slack[r] - row[r, j] * x[j]
        loop.note("From there inwards, by how far the worst row is crossed, or kept by its price.")
        gap[()] = _TINY
        for i in loop("i", 0, n):
            gap[()] = ca.fmax(gap[()], 1e-6 * ca.fabs(x[i]))
        for r in loop("r", 0, m):
            beyond = ca.if_else(weight[r] > 0, ca.fabs(slack[r]), -slack[r])
            gap[()] = ca.fmax(gap[()], beyond)
        least_slack[()] = ca.fmax(_TINY, _LEAST * gap[()])
        for r in loop("r", 0, m):
            z[r] = ca.fmax(0, -slack[r])
            slack[r] = ca.fmax(0, slack[r]) + gap[()]
            z[r] = ca.fmax(stiffness[()] * (z[r] + gap[()] * gap[()] / slack[r]), _TINY)
        conditions = (curve, slope, row, bound, x, slack, z, by_slope, by_row)
        least_gap[()] = _MOST
        crossing[()] = 1
        for _ in loop.again("turn", turns):
            loop.note("Where slack times multiplier lags, the smaller of the two is raised.")
            gap[()] = 0
            for r in loop("r", 0, m):
                gap[()] = gap[()] + slack[r] * z[r]
            low[()] = _CENTRED * gap[()] / m
            for r in loop("r", 0, m):
                per_z[r] = 1 / z[r]
                raised = ca.fmax(slack[r], low[()] * per_z[r])
                slack[r] = ca.if_else(z[r] > stiffness[()] * slack[r], raised, slack[r])
                per_slack[r] = 1 / slack[r]
                z[r] = ca.fmax(z[r], low[()] * per_slack[r])
                per_z[r] = 1 / z[r]
                weight[r] = z[r] * per_slack[r]
                push[r] = z[r]
            loop.note("What is left of the conditions of an optimum.")
            _residuals(loop, conditions)
            _system(loop, curve, row, weight, system, low)
            factorise(loop, n, system, lower, pivot, definite=True)
            loop.note("Straight towards the optimum, and how far that goes.")
            direction = (by_slope, by_row, push, weight, row, lower, pivot, per_slack, per_z)
            moves = (move, slack_move, z_move, length)
            _direction(loop, direction, moves, 1)
            other_gap[()] = 0
            for r in loop("r", 0, m):
                other_gap[()] = other_gap[()] + (slack[r] + length[()] * slack_move[r]) * (
                    z[r] + length[()] * z_move[r]
                )
            loop.note("Then with a share of the gap left, the more the less that went.")
            low[()] = other_gap[()] / ca.fmax(gap[()], _TINY) * other_gap[()] / m
            circling = ca.logic_and(gap[()] > least_gap[()], crossing[()] < _KEPT)
            part[()] = ca.if_else(circling, _HELD_BACK, 1)
            least_gap[()] = ca.fmin(least_gap[()], gap[()])
            for r in loop("r", 0, m):
                push[r] = part[()] * slack_move[r] * z_move[r] - low[()]
                push[r] = z[r] + push[r] * per_slack[r]
            _direction(loop, direction, moves, _SHARE)
            loop.note("At the optimum a turn that cannot go half its way only brings rounding.")
            low[()] = 0
            for i in loop("i", 0, n):
                low[()] = low[()] + ca.fabs(slope[i] * x[i])
            there = ca.logic_and(gap[()] < _THERE * low[()], length[()] < 0.5)
            length[()] = ca.if_else(there, 0, length[()])
            crossing[()] = crossing[()] * (1 - length[()])
            for i in loop("i", 0, n):
                x[i] = x[i] + length[()] * move[i]
            for r in loop("r", 0, m):
                slack[r] = ca.fmax(slack[r] + length[()] * slack_move[r], least_slack[()])
                z[r] = ca.fmax(z[r] + length[()] * z_move[r], _TINY)
        loop.note("The solution in its own units, and how well it holds.")
        _residuals(loop, conditions)
        gap[()] = _TINY
        total[()] = _TINY
        for i in loop("i", 0, n):
            gap[()] = ca.fmax(gap[()], ca.fmax(ca.fabs(slope[i]), ca.fabs(x[i])))
            total[()] = ca.fmax(total[()], ca.fabs(x[i]))
            solution[i] = x[i] * size[i]
        low[()] = 0
        for r in loop("r", 0, m):
            low[()] = ca.fmax(low[()], ca.fabs(bound[r]))
        loop.note("A slope that is too large beside all bounds leaves nothing to be seen of rows.")
        unseen = _UNSEEN * gap[()] > ca.fmax(low[()], total[()])
        residual[()] = ca.if_else(ca.logic_and(low[()] > 0, unseen), 1, residual[()])
        total[()] = ca.fmax(total[()], _UNSEEN * gap[()])
        for i in loop("i", 0, n):
            residual[()] = residual[()] + ca.fabs(by_slope[i]) / gap[()]
        for r in loop("r", 0, m):
            low[()] = ca.fabs(by_row[r]) + slack[r] * z[r] / gap[()]
            residual[()] = residual[()] + low[()] / ca.fmax(total[()], ca.fabs(bound[r]))

    def _system(
        loop: Loops, curve: Elements, row: Elements, weight: Elements, system: Elements,
        low: Elements,
    ) -> None:  # fmt: skip
        """Write H + Aᵀ W A, below its diagonal and on it."""
        for i in loop("i", 0, n):
            for j in loop("j", 0, i + 1):
                system[i, j] = curve[i, j]
        for r in loop("r", 0, m):
            for i in loop("i", 0, n):
                low[()] = weight[r] * row[r, i]
                for j in loop("j", 0, i + 1):
                    system[i, j] = system[i, j] + low[()] * row[r, j]

    def _residuals(loop: Loops, known: Sequence[Elements]) -> None:
        """Write what is left of slope and rows."""
        curve, slope, row, bound, x, slack, z, by_slope, by_row = known
        for i in loop("i", 0, n):
            by_slope[i] = slope[i]
            for j in loop("j", 0, n):
                by_slope[i] = by_slope[i] + curve[i, j] * x[j]
        for r in loop("r", 0, m):
            by_row[r] = slack[r] - bound[r]
            for j in loop("j", 0, n):
                by_row[r] = by_row[r] + row[r, j] * x[j]
                by_slope[j] = by_slope[j] + row[r, j] * z[r]

    def _direction(
        loop: Loops, known: Sequence[Elements], moves: Sequence[Elements], share: float
    ) -> None:
        """Write the moves that take away what is left, and how far they may go.

        `push`: of slack times multiplier, over the slack. The length is a share of the one that
        takes the first slack or multiplier to zero, and at most one.
        """
        by_slope, by_row, push, weight, row, lower, pivot, per_slack, per_z = known
        move, slack_move, z_move, length = moves
        for i in loop("i", 0, n):
            move[i] = -by_slope[i]
        for r in loop("r", 0, m):
            z_move[r] = push[r] - weight[r] * by_row[r]
            for i in loop("i", 0, n):
                move[i] = move[i] + row[r, i] * z_move[r]
        substitute(loop, n, lower, pivot, move)
        length[()] = share
        for r in loop("r", 0, m):
            slack_move[r] = -by_row[r]
            for i in loop("i", 0, n):
                slack_move[r] = slack_move[r] - row[r, i] * move[i]
            z_move[r] = -push[r] - weight[r] * slack_move[r]
            length[()] = ca.fmax(
                length[()], ca.fmax(-slack_move[r] * per_slack[r], -z_move[r] * per_z[r])
            )
        length[()] = share / length[()]

    return Written(
        algorithm,
        {"hessian": (n, n), "linear": (n,), "rows": (m, n), "bounds": (m,)},
        {"solution": (n,), "residual": ()},
        {
            "size": (n,), "weight": (m,), "curve": (n, n), "slope": (n,), "row": (m, n),
            "bound": (m,), "x": (n,), "slack": (m,), "multiplier": (m,), "system": (n, n),
            "lower": (n, n), "pivot": (n,), "move": (n,), "slack_move": (m,),
            "multiplier_move": (m,), "by_slope": (n,), "by_row": (m,), "push": (m,),
            "per_slack": (m,), "per_multiplier": (m,), "gap": (), "other_gap": (), "length": (),
            "stiffness": (), "least_slack": (), "low": (), "total": (),
            "least_gap": (), "crossing": (), "part": (),
        },
    )  # fmt: skip


QUADRATIC_PROGRAM = Family(
    "quadratic_program",
    _written,
    "The least of a quadratic within rows, by a predictor and corrector of interior points.",
)


def quadratic_program(
    hessian: ca.SX,
    linear: ca.SX,
    rows: ca.SX,
    bounds: ca.SX,
    turns: int = TURNS,
) -> ProgramSolution:
    """Return the least of ½ xᵀ H x + fᵀ x where A x ≤ b.

    Mehrotra's predictor and corrector from a start of its own, with a fixed number of turns, so
    that every sample takes the same time. Rows and unknowns are scaled first: the units of the
    problem do not matter. Rows may be given twice, be zero, or leave a single point.

    Parameters
    ----------
    hessian : casadi.SX [n, n]
        H, positive definite.
    linear, bounds : casadi.SX [n], [m]
        f and b; a bound of 1e30 or above, infinity too, is none.
    rows : casadi.SX [m, n]
        A
    turns : int

    References
    ----------
    S. Mehrotra, On the implementation of a primal-dual interior point method, SIAM Journal on
    Optimization 2(4), 1992, 575-601, doi 10.1137/0802028.

    Examples
    --------
    The point of x + y ≤ 1 that is nearest to (1, 1):

    >>> found = quadratic_program(
    ...     ca.SX.eye(2), ca.SX([-1, -1]), ca.SX([[1, 1]]), ca.SX([1])
    ... )
    >>> [round(float(x), 9) for x in ca.evalf(found.solution).nonzeros()]
    [0.5, 0.5]
    >>> float(ca.evalf(found.residual)) < 1e-12
    True
    """
    sizes = linear.numel(), bounds.numel(), turns
    found = QUADRATIC_PROGRAM(sizes, ca.densify(hessian), linear, ca.densify(rows), bounds)
    return ProgramSolution(*found)
