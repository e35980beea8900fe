"""A linear model held over a sample, and its cost, by the power series of its exponential."""

from __future__ import annotations

from clepsydra.program.routine_writer import Elements, Loops, Shape

#: What is computed in, see `arrays_held` and `arrays_of_cost`.
Arrays = tuple[Elements, Elements, Elements]
#: Terms of the power series: enough for an argument with a norm of 1/4.
TERMS = 8
#: 1, 1/2, 1/3, …
SHARES = [1.0 / k for k in range(1, TERMS + 2)]


def arrays_held(n: int, m: int) -> dict[str, Shape]:
    """Return the arrays that `hold` computes in: [Φ Γ], then those on the way."""
    return {"held": (n, n + m), "term": (n, n + m), "next_term": (n, n + m)}


def hold(
    loop: Loops, sizes: tuple[int, int], share: Elements, step: Elements, arrays: Arrays
) -> None:
    """Write [Φ Γ] = [I 0] + Σ step^k/k!.

    `step`: [A B] times the time [n, n + m]; `arrays`: of `arrays_held`.
    """
    (n, m), (held, term, next_term) = sizes, arrays
    for i in loop("i", 0, n):
        for j in loop("j", 0, n + m):
            term[i, j] = step[i, j]
            held[i, j] = step[i, j]
        held[i, i] = held[i, i] + 1
    for k in loop("k", 1, TERMS):
        for i in loop("i", 0, n):
            for j in loop("j", 0, n + m):
                next_term[i, j] = 0
                for r in loop("r", 0, n):
                    next_term[i, j] = next_term[i, j] + step[i, r] * term[r, j]
        for i in loop("i", 0, n):
            for j in loop("j", 0, n + m):
                term[i, j] = next_term[i, j] * share[k]
                held[i, j] = held[i, j] + term[i, j]


def double(loop: Loops, sizes: tuple[int, int], arrays: Arrays) -> None:
    """Let [Φ Γ] be that of twice the time: Φ Φ and Φ Γ + Γ."""
    (n, m), (held, _, next_term) = sizes, arrays
    for i in loop("i", 0, n):
        for j in loop("j", 0, n + m):
            next_term[i, j] = 0
            for r in loop("r", 0, n):
                next_term[i, j] = next_term[i, j] + held[i, r] * held[r, j]
        for j in loop("j", n, n + m):
            next_term[i, j] = next_term[i, j] + held[i, j]
    for i in loop("i", 0, n):
        for j in loop("j", 0, n + m):
            held[i, j] = next_term[i, j]


def arrays_of_cost(n: int, m: int) -> dict[str, Shape]:
    """Return the arrays that `add_up_cost` computes in: the cost, then those on the way."""
    square = (n + m, n + m)
    return {"sampled_cost": square, "part": square, "half": square}


def add_up_cost(
    loop: Loops, sizes: tuple[int, int], share: Elements, step: Elements, arrays: Arrays
) -> None:
    """Write the integral of zᵀ S z over the time; the cost begins as S times the time.

    `step`: as of `hold`; `arrays`: of `arrays_of_cost`.
    """
    (n, m), (cost, part, half) = sizes, arrays
    for i in loop("i", 0, n + m):
        for j in loop("j", 0, n + m):
            part[i, j] = cost[i, j]
    for k in loop("k", 1, TERMS + 1):
        for i in loop("i", 0, n + m):
            for j in loop("j", 0, n + m):
                half[i, j] = 0
                for r in loop("r", 0, n):
                    half[i, j] = half[i, j] + step[r, i] * part[r, j]
                half[i, j] = half[i, j] * share[k]
        for i in loop("i", 0, n + m):
            for j in loop("j", 0, n + m):
                part[i, j] = half[i, j] + half[j, i]
                cost[i, j] = cost[i, j] + part[i, j]


def double_cost(loop: Loops, sizes: tuple[int, int], held: Elements, arrays: Arrays) -> None:
    """Let the cost be that of twice the time: W + Mᵀ W M with M = [Φ Γ; 0 I] of the time so far."""
    (n, m), (cost, part, half) = sizes, arrays
    for i in loop("i", 0, n + m):
        for j in loop("j", 0, n + m):
            half[i, j] = 0
            for r in loop("r", 0, n):
                half[i, j] = half[i, j] + held[r, i] * cost[r, j]
    for i in loop("i", n, n + m):
        for j in loop("j", 0, n + m):
            half[i, j] = half[i, j] + cost[i, j]
    for i in loop("i", 0, n + m):
        for j in loop("j", 0, n + m):
            part[i, j] = 0
            for r in loop("r", 0, n):
                part[i, j] = part[i, j] + half[i, r] * held[r, j]
        for j in loop("j", n, n + m):
            part[i, j] = part[i, j] + half[i, j]
    for i in loop("i", 0, n + m):
        for j in loop("j", 0, n + m):
            cost[i, j] = cost[i, j] + part[i, j]
