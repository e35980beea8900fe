"""Validity of what arrives from outside: numbers, a time step that can be integrated, limits."""

from __future__ import annotations

from functools import reduce

import casadi as ca

from clepsydra.program.step_law import Symbols


def limit(value: ca.SX, low: ca.SX, high: ca.SX) -> ca.SX:
    """Return a value held between two limits: min(high, max(low, value)).

    The limit stands first in both comparisons, so that a limit which is not a number is
    passed over (``low > value ? low : value`` is the value); `value` must be a number.

    `value`, `low`, `high`: scalars of one unit.

    Examples
    --------
    >>> [float(limit(ca.DM(value), ca.DM(0), ca.DM(10))) for value in (-1, 4, 11)]
    [0.0, 4.0, 10.0]
    """
    return ca.fmin(high, ca.fmax(low, value))


#: Above this magnitude a value counts as not a number.
LARGEST_NUMBER = 1e300
#: Whole numbers are counted and judged up to it; single precision holds every one.
LARGEST_COUNT = 1e7


def is_number(value: ca.SX) -> ca.SX:
    """Return whether a value is a finite number: |value| <= 1e300.

    The comparison is false for a not-a-number; ``value == value`` would not do, since CasADi
    folds it to true.

    Examples
    --------
    >>> [bool(is_number(ca.DM(value))) for value in (3.0, float("nan"), float("-inf"))]
    [True, False, False]
    """
    return ca.fabs(value) <= LARGEST_NUMBER


def value_or_zero(value: ca.SX, valid: ca.SX) -> ca.SX:
    """Return the value where it is valid and zero elsewhere.

    Zero enters the arithmetic in its place, so that what is computed is a number even where
    it must not be used.
    """
    return ca.if_else(valid, value, 0)


def is_time_step(time_step: ca.SX) -> ca.SX:
    """Return whether a time step [s] is a number above zero.

    Examples
    --------
    >>> [bool(is_time_step(ca.DM(value))) for value in (1.0, 0.0, -1.0, float("nan"))]
    [True, False, False, False]
    """
    return ca.logic_and(time_step > 0, time_step <= LARGEST_NUMBER)


def time_step_of(s: Symbols) -> tuple[ca.SX, ca.SX]:
    """Return the time step, 1 s in place of one that is none, and whether it is one."""
    good = is_time_step(s["time_step"])
    return ca.if_else(good, s["time_step"], 1), good


def all_of(conditions: list[ca.SX]) -> ca.SX:
    """Return whether all of the conditions hold."""
    return reduce(ca.logic_and, conditions)


def any_of(conditions: list[ca.SX]) -> ca.SX:
    """Return whether one of the conditions holds."""
    return reduce(ca.logic_or, conditions)
