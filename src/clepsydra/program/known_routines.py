"""The routines that a law may call."""

from __future__ import annotations

import casadi as ca

from clepsydra.program.kept_equations import entries_of, with_calls_written_out
from clepsydra.program.routine import Routine
from clepsydra.program.routine_library import called_family, is_conditional
from clepsydra.program.routines.current_observer import OBSERVER_CORRECTION, OBSERVER_PREDICTION
from clepsydra.program.routines.predictive_plan import BOUNDED_PLAN, LINEAR_PLAN
from clepsydra.program.routines.quadratic_program import QUADRATIC_PROGRAM
from clepsydra.program.routines.recomputed_gain import RECOMPUTED_GAIN
from clepsydra.program.routines.symmetric_solution import SYMMETRIC_SOLUTION

#: A law that is sent elsewhere calls them by their names.
FAMILIES = (
    BOUNDED_PLAN,
    LINEAR_PLAN,
    OBSERVER_CORRECTION,
    OBSERVER_PREDICTION,
    QUADRATIC_PROGRAM,
    RECOMPUTED_GAIN,
    SYMMETRIC_SOLUTION,
)


def routine_of(function: ca.Function) -> Routine | None:
    """Return the routine that a called function stands for, or None for any other call.

    Examples
    --------
    >>> routine_of(ca.Function("square", [], [])) is None
    True
    """
    found = called_family(function, FAMILIES)
    return found[0].routine(found[1]) if found else None


def without_routines(function: ca.Function) -> ca.Function:
    """Return a function in which the calls of routines are expressions, as derivatives need them.

    Where an argument is zero, what it multiplies is left out. Where a law is linear the conditions
    of routines are false.
    """

    def written_out(called: ca.Function, given: list[ca.SX]) -> list[ca.SX] | None:
        found = called_family(called, FAMILIES)
        if is_conditional(called):
            return _zeros(called)
        return found[0].expressions(found[1], given) if found else None

    return with_calls_written_out(function, written_out)


def where_linear(function: ca.Function) -> ca.Function:
    """Return a function as it is where a law is linear: the conditions of routines are false.

    CasADi would look for the slopes of what has none: 2.7 s of a quadratic program, for 0.02 s.
    Every other call stays as it is, with the slopes that it brings along.
    """

    def passed_over(called: ca.Function, given: list[ca.SX]) -> list[ca.SX]:
        if is_conditional(called):
            return _zeros(called)
        return [entry for each in called.call(given) for entry in entries_of(each)]

    return with_calls_written_out(function, passed_over)


def _zeros(called: ca.Function) -> list[ca.SX]:
    return [ca.SX(0)] * sum(called.nnz_out(i) for i in range(called.n_out()))
