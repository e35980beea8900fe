"""The moves of a predictive controller: those of its linear law, and those of a program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca

from clepsydra.program.routine_library import Family, Written
from clepsydra.program.routine_writer import Elements, Loops, Shape
from clepsydra.program.routines.factors import factorise, substitute
from clepsydra.program.routines.quadratic_program import QUADRATIC_PROGRAM, TURNS

#: What the square of an overstepped bound costs, as a share of its range and in each sample of
#: the horizon, where a largest acceptable error costs one.
SOFTNESS = 1e3


class PlanningTables(NamedTuple):
    """What is known beforehand of a plan of n moves, held over blocks of samples.

    Moves are ordered block by block. What is known in a sample is z [c].

    Parameters
    ----------
    curves, slopes : casadi.DM [q · n, n], [q · n, c]
        Of each output: Σ_k e(k)² = vᵀ C v + 2 (S z)ᵀ v + what no move changes.
    lengths : casadi.DM [blocks]
        The samples of each block.
    reached, moved : casadi.DM [k · blocks, c], [k · blocks, n]
        Each of k levels with a bound at the end of each block: reached · z + moved · v.
    spans : casadi.DM [k]
        Their ranges.
    """

    curves: ca.DM
    slopes: ca.DM
    lengths: ca.DM
    reached: ca.DM
    moved: ca.DM
    spans: ca.DM


class Request(NamedTuple):
    """What is asked of a plan in a sample.

    Parameters
    ----------
    errors, moves : casadi.SX [q], [m]
        Weights of the squares of errors, and of changes from block to block.
    free : casadi.SX [m]
        One, or zero for an input that stays where it is.
    known : casadi.SX [c]
        z
    up, down : casadi.SX [m]
        Room of each input to its limits.
    rise : casadi.SX [m] or [0]
        By how much each may change in a sample, if that is limited.
    above : casadi.SX [k]
        Bound of each level less its value at rest.
    """

    errors: ca.SX
    moves: ca.SX
    free: ca.SX
    known: ca.SX
    up: ca.SX
    down: ca.SX
    rise: ca.SX
    above: ca.SX


@dataclass(frozen=True)
class _Sizes:
    blocks: int
    m: int
    q: int
    known: int
    rates: int
    levels: int
    samples: int

    @property
    def n(self) -> int:
        """Moves."""
        return self.blocks * self.m

    @property
    def soft(self) -> int:
        """Further unknowns."""
        return 1 if self.levels else 0

    @property
    def rows(self) -> int:
        """Limits, rates and bounds."""
        return 2 * self.n * (1 + (self.rates > 0)) + self.levels * self.blocks

    def arguments(self) -> dict[str, Shape]:
        """Return the arrays that both routines are given."""
        n, m, q, c, k = self.n, self.m, self.q, self.known, self.levels
        found: dict[str, Shape] = {
            "errors": (q,), "moves": (m,), "free": (m,), "state": (c,), "up": (m,), "down": (m,),
            "curves": (q * n, n), "slopes": (q * n, c),
        }  # fmt: skip
        if self.rates:
            found |= {"rise": (m,), "lengths": (self.blocks,)}
        if k:
            found |= {"above": (k,), "reached": (k * self.blocks, c), "moved": (k * self.blocks, n)}
            found |= {"spans": (k,)}
        return found


Arrays = Mapping[str, Elements]


def _cost(loop: Loops, sizes: _Sizes, a: Arrays) -> None:
    """Write ½ vᵀ H v + fᵀ v: of errors over the horizon, and of changes from block to block."""
    n, m, hessian, linear, total = sizes.n, sizes.m, a["hessian"], a["linear"], a["total"]
    loop.note("What moves cost over the horizon: errors of each output, and the moves.")
    for i in loop("i", 0, n):
        linear[i] = 0
        for j in loop("j", 0, n):
            hessian[i, j] = 0
    for output in loop("output", 0, sizes.q):
        for i in loop("i", 0, n):
            total[()] = 0
            for j in loop("j", 0, sizes.known):
                total[()] = total[()] + a["slopes"][output * n + i, j] * a["state"][j]
            linear[i] = linear[i] + a["errors"][output] * total[()]
            for j in loop("j", 0, n):
                hessian[i, j] = hessian[i, j] + a["errors"][output] * a["curves"][output * n + i, j]
    for i in loop("i", 0, m):
        hessian[i, i] = hessian[i, i] + a["moves"][i]
    for block in loop("block", 1, sizes.blocks):
        for i in loop("i", 0, m):
            own, last = block * m + i, block * m + i - m
            hessian[own, own] = hessian[own, own] + a["moves"][i]
            hessian[last, last] = hessian[last, last] + a["moves"][i]
            hessian[own, last] = hessian[own, last] - a["moves"][i]
            hessian[last, own] = hessian[last, own] - a["moves"][i]
    loop.note("An input that is not free stays where it is.")
    for block in loop("block", 0, sizes.blocks):
        for i in loop("i", 0, m):
            own = block * m + i
            linear[own] = linear[own] * a["free"][i]
            for j in loop("j", 0, n):
                hessian[own, j] = hessian[own, j] * a["free"][i]
            for j in loop("j", 0, n):
                hessian[j, own] = hessian[j, own] * a["free"][i]
            hessian[own, own] = hessian[own, own] + (1 - a["free"][i])


def _linear_plan(*given: int) -> Written:
    sizes = _Sizes(*given)
    n, m = sizes.n, sizes.m
    arguments = sizes.arguments()
    results: dict[str, Shape] = {"plan": (n,), "excess": ()}
    local: dict[str, Shape] = {
        "hessian": (n, n), "linear": (n,), "total": (), "pivot": (n,), "lower": (n, n),
    }  # fmt: skip

    def algorithm(loop: Loops, *arrays: Elements) -> None:
        a = dict(zip([*arguments, *results, *local], arrays, strict=True))
        plan, excess, total = a["plan"], a["excess"], a["total"]
        _cost(loop, sizes, a)
        loop.note("The moves that cost least without limits.")
        factorise(loop, n, a["hessian"], a["lower"], a["pivot"])
        for i in loop("i", 0, n):
            plan[i] = -a["linear"][i]
        substitute(loop, n, a["lower"], a["pivot"], plan)
        loop.note("By how much they overstep limits, rates and bounds.")
        excess[()] = 0
        for block in loop("block", 0, sizes.blocks):
            for i in loop("i", 0, m):
                own = block * m + i
                excess[()] = ca.fmax(plan[own] - a["up"][i], excess[()])
                excess[()] = ca.fmax(-plan[own] - a["down"][i], excess[()])
        if sizes.rates:
            for i in loop("i", 0, m):
                excess[()] = ca.fmax(ca.fabs(plan[i]) - a["rise"][i], excess[()])
            for block in loop("block", 1, sizes.blocks):
                for i in loop("i", 0, m):
                    own = block * m + i
                    excess[()] = ca.fmax(
                        ca.fabs(plan[own] - plan[own - m]) - a["rise"][i] * a["lengths"][block - 1],
                        excess[()],
                    )
        for level in loop("level", 0, sizes.levels):
            for block in loop("block", 0, sizes.blocks):
                row = level * sizes.blocks + block
                total[()] = -a["above"][level]
                for j in loop("j", 0, sizes.known):
                    total[()] = total[()] + a["reached"][row, j] * a["state"][j]
                for j in loop("j", 0, n):
                    total[()] = total[()] + a["moved"][row, j] * plan[j]
                excess[()] = ca.fmax(total[()], excess[()])

    return Written(algorithm, arguments, results, local)


def _bounded_plan(*given: int) -> Written:
    *shape, turns = given
    sizes = _Sizes(*shape)
    n, m, size, count = sizes.n, sizes.m, sizes.n + sizes.soft, sizes.rows
    program = QUADRATIC_PROGRAM.write(size, count, turns)
    arguments = sizes.arguments()
    results: dict[str, Shape] = {"plan": (size,), "residual": ()}
    own: dict[str, Shape] = {
        "hessian": (size, size), "linear": (size,), "rows": (count, size), "bounds": (count,),
        "cost_total": (),
    }  # fmt: skip
    local = {**own, **program.local}

    def algorithm(loop: Loops, *arrays: Elements) -> None:
        a = dict(zip([*arguments, *results, *local], arrays, strict=True))
        _cost(loop, sizes, {**a, "total": a["cost_total"]})
        if sizes.soft:
            loop.note("The share of its range by which the worst bound is overstepped.")
            a["linear"][n] = 0
            for j in loop("j", 0, n):
                a["hessian"][n, j] = 0
                a["hessian"][j, n] = 0
            a["hessian"][n, n] = SOFTNESS * sizes.samples
        loop.note("Limits, rates and bounds as rows.")
        for r in loop("r", 0, count):
            for j in loop("j", 0, size):
                a["rows"][r, j] = 0
        for block in loop("block", 0, sizes.blocks):
            for i in loop("i", 0, m):
                move = block * m + i
                a["rows"][move, move] = 1
                a["bounds"][move] = a["up"][i]
                a["rows"][n + move, move] = -1
                a["bounds"][n + move] = a["down"][i]
        if sizes.rates:
            _rate_rows(loop, a)
        first = 2 * n * (1 + (sizes.rates > 0))
        for level in loop("level", 0, sizes.levels):
            for block in loop("block", 0, sizes.blocks):
                end = level * sizes.blocks + block
                a["bounds"][first + end] = a["above"][level]
                for j in loop("j", 0, sizes.known):
                    a["bounds"][first + end] = (
                        a["bounds"][first + end] - a["reached"][end, j] * a["state"][j]
                    )
                for j in loop("j", 0, n):
                    a["rows"][first + end, j] = a["moved"][end, j]
                a["rows"][first + end, n] = -a["spans"][level]
        known = [a[name] for name in ("hessian", "linear", "rows", "bounds", "plan", "residual")]
        program.algorithm(loop, *known, *(a[name] for name in program.local))

    def _rate_rows(loop: Loops, a: Arrays) -> None:
        for i in loop("i", 0, m):
            for sign, first in ((1, 2 * n), (-1, 3 * n)):
                a["rows"][first + i, i] = sign
                a["bounds"][first + i] = a["rise"][i]
        for block in loop("block", 1, sizes.blocks):
            for i in loop("i", 0, m):
                move = block * m + i
                for sign, first in ((1, 2 * n), (-1, 3 * n)):
                    a["rows"][first + move, move] = sign
                    a["rows"][first + move, move - m] = -sign
                    a["bounds"][first + move] = a["rise"][i] * a["lengths"][block - 1]

    return Written(algorithm, arguments, results, local)


LINEAR_PLAN = Family(
    "linear_plan", _linear_plan, "The plan of the linear law, and by how much it oversteps bounds."
)
BOUNDED_PLAN = Family(
    "bounded_plan", _bounded_plan, "The plan within limits, rates and bounds, by a program."
)


class LinearPlan(NamedTuple):
    """The plan that costs least without limits.

    Parameters
    ----------
    moves : casadi.SX [n]
    excess : casadi.SX
        By how much it oversteps a limit, a rate or a bound; zero where it does not.
    """

    moves: ca.SX
    excess: ca.SX


class BoundedPlan(NamedTuple):
    """The plan that costs least within limits, rates and bounds.

    Parameters
    ----------
    moves : casadi.SX [n]
    residual : casadi.SX
        Of the program, see `quadratic_program.ProgramSolution`.
    """

    moves: ca.SX
    residual: ca.SX


def linear_plan(tables: PlanningTables, asked: Request) -> LinearPlan:
    """Return the moves v that make Σ_j w_j Σ_k e_j(k)² + Σ_i s_i Σ_b (v_bi − v_(b−1)i)² least.

    v = 0 before the first block.

    Examples
    --------
    One output that is e = x + v, with x = 0.5 and weights of 4 and 1: v = −4 · 0.5/(4 + 1).

    >>> one, none = ca.DM([[1.0]]), ca.DM(0, 1)
    >>> tables = PlanningTables(one, one, one, none, none, none)
    >>> asked = [[4], [1], [1], [0.5], [9], [0.3]]
    >>> found = linear_plan(tables, Request(*map(ca.SX, asked), ca.SX(0, 1), ca.SX(0, 1)))
    >>> ca.evalf(found.moves), round(float(ca.evalf(found.excess)), 9)
    (DM(-0.4), 0.1)
    """
    sizes, given = _called(tables, asked)
    return LinearPlan(*LINEAR_PLAN(sizes, *given))


def bounded_plan(tables: PlanningTables, asked: Request, where: ca.SX) -> BoundedPlan:
    """Return the moves of `linear_plan` within limits, rates and soft bounds of levels.

    Parameters
    ----------
    where : casadi.SX
        A condition: where it is false nothing is solved, and moves and residual are zero.

    Examples
    --------
    That of `linear_plan` with a room of 0.3:

    >>> one, none = ca.DM([[1.0]]), ca.DM(0, 1)
    >>> tables = PlanningTables(one, one, one, none, none, none)
    >>> asked = [[4], [1], [1], [0.5], [9], [0.3]]
    >>> request = Request(*map(ca.SX, asked), ca.SX(0, 1), ca.SX(0, 1))
    >>> round(float(ca.evalf(bounded_plan(tables, request, ca.SX(1)).moves)), 9)
    -0.3
    """
    sizes, given = _called(tables, asked)
    plan, residual = BOUNDED_PLAN.where(where, (*sizes, TURNS), *given)
    return BoundedPlan(plan[: tables.curves.shape[1]], residual)


def _called(tables: PlanningTables, asked: Request) -> tuple[tuple[int, ...], list[ca.SX]]:
    """Return the sizes and the arguments of both routines."""
    m, q, c = (each.numel() for each in (asked.moves, asked.errors, asked.known))
    rates, levels, blocks = asked.rise.numel(), asked.above.numel(), tables.lengths.numel()
    sizes = _Sizes(blocks, m, q, c, rates, levels, round(float(ca.sum1(tables.lengths))))
    values = {
        **{name: getattr(asked, name) for name in ("errors", "moves", "free", "up", "down")},
        "state": asked.known, "rise": asked.rise, "above": asked.above,
        **{name: ca.SX(ca.densify(table)) for name, table in tables._asdict().items()},
    }  # fmt: skip
    given = [values[name] for name in sizes.arguments()]
    return (blocks, m, q, c, rates, levels, sizes.samples), given
