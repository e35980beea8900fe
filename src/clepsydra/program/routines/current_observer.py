"""A current observer by a linear model whose numbers are tables."""

from __future__ import annotations

import casadi as ca

from clepsydra.program.routine_library import Family, Written
from clepsydra.program.routine_writer import Elements, Loops


def _correction(n: int, p: int) -> Written:
    def algorithm(loop: Loops, *arrays: Elements) -> None:
        expected, shown, known, observation, correction, estimate, surprise = arrays
        for i in loop("i", 0, n):
            estimate[i] = expected[i]
        for k in loop("k", 0, p):
            surprise[()] = shown[k]
            for i in loop("i", 0, n):
                surprise[()] = surprise[()] - observation[k, i] * expected[i]
            for i in loop("i", 0, n):
                estimate[i] = estimate[i] + correction[i, k] * (known[()] * surprise[()])

    return Written(
        algorithm,
        {
            "expected": (n,), "shown": (p,), "known": (),
            "observation": (p, n), "correction": (n, p),
        },
        {"estimate": (n,)},
        {"surprise": ()},
    )  # fmt: skip


def _prediction(n: int, m: int) -> Written:
    def algorithm(loop: Loops, *arrays: Elements) -> None:
        estimate, moves, transition, input_effect, following, total = arrays
        for i in loop("i", 0, n):
            total[()] = 0
            for j in loop("j", 0, n):
                total[()] = total[()] + transition[i, j] * estimate[j]
            for j in loop("j", 0, m):
                total[()] = total[()] + input_effect[i, j] * moves[j]
            following[i] = total[()]

    return Written(
        algorithm,
        {
            "estimate": (n,), "moves": (m,),
            "transition": (n, n), "input_effect": (n, m),
        },
        {"following": (n,)},
        {"total": ()},
    )  # fmt: skip


OBSERVER_CORRECTION = Family(
    "observer_correction", _correction, "What was expected, corrected by what the sensors show."
)
OBSERVER_PREDICTION = Family(
    "observer_prediction", _prediction, "What is expected in the next sample."
)


def corrected(
    expected: ca.SX, shown: ca.SX, known: ca.SX, observation: ca.DM, correction: ca.DM
) -> ca.SX:
    """Return x̂ + M (y − C x̂), or x̂ where what is shown is not known.

    Parameters
    ----------
    expected, shown, known : casadi.SX [n], [p], [1]
        x̂, y, and 1 or 0.
    observation, correction : casadi.DM [p, n], [n, p]
        C and M.

    Examples
    --------
    >>> one = ca.DM([[1.0]])
    >>> ca.evalf(corrected(ca.SX([1]), ca.SX([3]), ca.SX(1), one, 0.5 * one))
    DM(2)
    """
    tables = ca.SX(ca.densify(observation)), ca.SX(ca.densify(correction))
    (found,) = OBSERVER_CORRECTION(correction.shape, expected, shown, known, *tables)
    return found


def predicted(estimate: ca.SX, moves: ca.SX, transition: ca.DM, input_effect: ca.DM) -> ca.SX:
    """Return Φ x̂ + Γ u.

    Parameters
    ----------
    estimate, moves : casadi.SX [n], [m]
    transition, input_effect : casadi.DM [n, n], [n, m]
        Φ and Γ.

    Examples
    --------
    >>> one = ca.DM([[1.0]])
    >>> ca.evalf(predicted(ca.SX([4]), ca.SX([3]), 0.5 * one, one))
    DM(5)
    """
    tables = ca.SX(ca.densify(transition)), ca.SX(ca.densify(input_effect))
    (found,) = OBSERVER_PREDICTION(input_effect.shape, estimate, moves, *tables)
    return found
