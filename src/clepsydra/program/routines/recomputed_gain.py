"""The gain of a linear quadratic regulator from a model that changes: a Riccati step a sample."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import casadi as ca

from clepsydra.program.routine_library import Family, Written
from clepsydra.program.routine_writer import Elements, Loops
from clepsydra.program.routines.held_model import (
    SHARES,
    TERMS,
    add_up_cost,
    arrays_held,
    arrays_of_cost,
    double,
    double_cost,
    hold,
)


class RecomputedGain(NamedTuple):
    """What a sample makes of a cost to go.

    Parameters
    ----------
    gain : casadi.SX [m, n + q]
    cost : casadi.SX [n + q, n + q]
        To go, a sample earlier.
    definite : casadi.SX
        Whether R + Γᵀ P Γ was positive definite in every step.
    """

    gain: ca.SX
    cost: ca.SX
    definite: ca.SX


def _written(n: int, m: int, q: int, doublings: int, steps: int) -> Written:
    def algorithm(loop: Loops, *arrays: Elements) -> None:
        model, weight, sums, before, time, share, *computed = arrays
        gain, to_go, definite, step, held, term, next_term, cost, part, half, *others = computed
        model_arrays, cost_arrays = (held, term, next_term), (cost, part, half)
        for i in loop("i", 0, n):
            for j in loop("j", 0, n + m):
                step[i, j] = model[i, j] * (time[()] * 0.5**doublings)
        loop.note("The model held over the sample: the power series of its exponential.")
        hold(loop, (n, m), share, step, model_arrays)
        for i in loop("i", 0, n + m):
            for j in loop("j", 0, n + m):
                cost[i, j] = weight[i, j] * (time[()] * 0.5**doublings)
        loop.note("The cost of the sample, by the same series.")
        add_up_cost(loop, (n, m), share, step, cost_arrays)
        for _ in loop("doubling", 0, doublings):
            double_cost(loop, (n, m), held, cost_arrays)
            double(loop, (n, m), model_arrays)
        for i in loop("i", 0, n + m):
            for j in loop("j", 0, n + m):
                cost[i, j] = cost[i, j] / time[()]
        for i in loop("i", 0, n + q):
            for j in loop("j", i, n + q):
                to_go[i, j] = before[i, j]
        definite[()] = 1
        for _ in loop("step", 0, steps):
            _go_back(loop, held, sums, cost, gain, to_go, definite, others)

    def _go_back(
        loop: Loops, held: Elements, sums: Elements, cost: Elements, gain: Elements,
        to_go: Elements, definite: Elements, others: Sequence[Elements],
    ) -> None:  # fmt: skip
        carried, pivot, inner, closed, left, whole = others
        loop.note("The cost to go P, of which the upper triangle counts, times the moved states.")
        for i in loop("i", 0, n + q):
            for j in loop("j", 0, i):
                to_go[i, j] = to_go[j, i]
        for i in loop("i", 0, n + q):
            for j in loop("j", 0, m):
                carried[i, j] = 0
                for r in loop("r", 0, n):
                    carried[i, j] = carried[i, j] + to_go[i, r] * held[r, n + j]
        loop.note("What a move costs, and what it costs together with a state.")
        for i in loop("i", 0, m):
            for j in loop("j", 0, m):
                inner[i, j] = 0
                for r in loop("r", 0, n):
                    inner[i, j] = inner[i, j] + held[r, n + i] * carried[r, j]
                inner[i, j] = cost[n + i, n + j] + inner[i, j]
            for j in loop("j", 0, n):
                gain[i, j] = 0
                for r in loop("r", 0, n):
                    gain[i, j] = gain[i, j] + carried[r, i] * held[r, j]
                for r in loop("r", 0, q):
                    gain[i, j] = gain[i, j] + carried[n + r, i] * sums[r, j]
                gain[i, j] = gain[i, j] + cost[j, n + i]
            for j in loop("j", n, n + q):
                gain[i, j] = carried[j, i]
        loop.note("The gain: solved by L D L'.")
        for k in loop("k", 0, m):
            definite[()] = ca.if_else(inner[k, k] > 0, definite[()], 0)
            pivot[k] = ca.if_else(inner[k, k] > 0, inner[k, k], 1)
            for i in loop("i", k + 1, m):
                inner[i, k] = inner[i, k] / pivot[k]
                for j in loop("j", 0, n + q):
                    gain[i, j] = gain[i, j] - inner[i, k] * gain[k, j]
                for j in loop("j", k + 1, i + 1):
                    inner[i, j] = inner[i, j] - inner[i, k] * inner[j, k] * pivot[k]
        for k in loop("k", 0, m):
            i = m - 1 - k
            for j in loop("j", 0, n + q):
                gain[i, j] = gain[i, j] / pivot[i]
                for r in loop("r", i + 1, m):
                    gain[i, j] = gain[i, j] - inner[r, i] * gain[r, j]
        loop.note("The model with its feedback, and the sums of errors below it.")
        for j in loop("j", 0, n + q):
            for i in loop("i", 0, n):
                closed[i, j] = 0
                for r in loop("r", 0, m):
                    closed[i, j] = closed[i, j] + held[i, n + r] * gain[r, j]
            for i in loop("i", n, n + q):
                closed[i, j] = 0
        for i in loop("i", 0, n):
            for j in loop("j", 0, n):
                closed[i, j] = held[i, j] - closed[i, j]
            for j in loop("j", n, n + q):
                closed[i, j] = -closed[i, j]
        for i in loop("i", 0, q):
            for j in loop("j", 0, n):
                closed[n + i, j] = sums[i, j]
            closed[n + i, n + i] = 1
        loop.note("The cost to go from the next sample on.")
        for i in loop("i", 0, n + q):
            for j in loop("j", 0, n + q):
                left[i, j] = 0
                for r in loop("r", 0, n + q):
                    left[i, j] = left[i, j] + closed[r, i] * to_go[r, j]
        for i in loop("i", 0, n + q):
            for j in loop("j", 0, n + q):
                whole[i, j] = 0
                for r in loop("r", 0, n + q):
                    whole[i, j] = whole[i, j] + left[i, r] * closed[r, j]
        loop.note("And that of this sample, in which the sum of an error costs 1.")
        for i in loop("i", 0, n + q):
            for j in loop("j", 0, n + q + m):
                left[i, j] = 0
        for i in loop("i", 0, n):
            for j in loop("j", 0, n):
                left[i, j] = cost[i, j]
            for j in loop("j", 0, m):
                left[i, n + q + j] = cost[i, n + j]
        for i in loop("i", n, n + q):
            left[i, i] = 1
        for i in loop("i", 0, n + q):
            for r in loop("r", 0, m):
                for j in loop("j", 0, n):
                    left[i, j] = left[i, j] - gain[r, i] * cost[n + r, j]
                for j in loop("j", 0, m):
                    left[i, n + q + j] = left[i, n + q + j] - gain[r, i] * cost[n + r, n + j]
        for i in loop("i", 0, n + q):
            for j in loop("j", i, n + q):
                for r in loop("r", 0, m):
                    left[i, j] = left[i, j] - left[i, n + q + r] * gain[r, j]
                to_go[i, j] = whole[i, j] + left[i, j]

    own = arrays_held(n, m)
    held = own.pop("held")
    return Written(
        algorithm,
        {
            "model": (n, n + m),
            "weight": (n + m, n + m),
            "sums": (q, n),
            "before": (n + q, n + q),
            "time": (),
            "share": (TERMS + 1,),
        },
        {"gain": (m, n + q), "to_go": (n + q, n + q), "definite": ()},
        {
            "step": (n, n + m),
            "held": held,
            **own,
            **arrays_of_cost(n, m),
            "carried": (n + q, m),
            "pivot": (m,),
            "inner": (m, m),
            "closed": (n + q, n + q),
            "left": (n + q, n + q + m),
            "whole": (n + q, n + q),
        },
    )


RECOMPUTED_GAIN = Family(
    "recomputed_gain",
    _written,
    "The model held over a sample, its cost, and a step of the Riccati difference equation.",
)


def recomputed_gain(
    model: ca.SX, weight: ca.SX, sums: ca.SX, to_go: ca.SX, time: ca.SX, doublings: int, steps: int
) -> RecomputedGain:
    """Return the gain that follows from a model, and the cost to go a sample earlier.

    ẋ = A x + B u and the integral of zᵀ S z of z = [x; u] are held over a sample by the power
    series of the exponential (Van Loan), over a time halved so often that it converges, and
    doubled: W(2h) = W(h) + M(h)ᵀ W(h) M(h), M(2h) = M(h)². The cost is per second; sums
    w⁺ = w + C x cost wᵀ w a sample. Then each step of the Riccati difference equation is

        K = (R + Γᵀ P Γ)⁻¹ (Γᵀ P Φ + Nᵀ),
        P⁺ = (Φ − Γ K)ᵀ P (Φ − Γ K) + [I; −K]ᵀ W [I; −K],

    in which rounding cannot make P negative. A pivot of L D Lᵀ that is not above zero is replaced
    by one, so that nothing is divided by zero; the step then does not hold.

    Parameters
    ----------
    model : casadi.SX [n, n + m]
        [A B]
    weight : casadi.SX [n + m, n + m]
        S, symmetric.
    sums : casadi.SX [q, n]
        C
    to_go : casadi.SX [n + q, n + q]
        P, of which the upper triangle is read.
    time : casadi.SX
        Of a sample [s].
    doublings, steps : int

    References
    ----------
    C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Transactions on
    Automatic Control 23(3), 1978, 395-404, doi 10.1109/TAC.1978.1101743.
    B. D. O. Anderson and J. B. Moore, Optimal Control: Linear Quadratic Methods, Prentice Hall
    1990, chapters 2 and 4.

    Examples
    --------
    An integrator held over 1 s with Q = R = 1 and no cost to go: x² + x u + 4/3 u² is least at
    u = −3/8 x.

    >>> model, none = ca.SX([[0, 1]]), ca.SX(0, 1)
    >>> found = recomputed_gain(model, ca.SX.eye(2), none, ca.SX(1, 1), ca.SX(1), 2, 1)
    >>> [round(float(ca.evalf(each)), 9) for each in found]
    [0.375, 0.8125, 1.0]
    """
    n, m, q = model.shape[0], model.shape[1] - model.shape[0], sums.shape[0]
    shares = ca.SX(SHARES)
    sizes = n, m, q, doublings, steps
    gain, cost, definite = RECOMPUTED_GAIN(sizes, model, weight, sums, to_go, time, shares)
    return RecomputedGain(gain, cost, definite > 0)
