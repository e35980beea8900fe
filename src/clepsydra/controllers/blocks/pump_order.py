"""Which of several equal pumps run: the order of duty and standby."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class PumpOrder:
    """The pumps that shall run, and the one whose turn is next.

    Parameters
    ----------
    wanted : tuple of casadi.SX
        Whether pump i shall run.
    next_duty : casadi.SX
        Number of the pump behind the one that leads now.

    Examples
    --------
    >>> float(PumpOrder((ca.DM(1), ca.DM(0)), ca.DM(2)).next_duty)
    2.0
    """

    wanted: tuple[ca.SX, ...]
    next_duty: ca.SX


def pump_order(
    duty: ca.SX, runs: Sequence[ca.SX], ready: Sequence[ca.SX], demand: ca.SX
) -> PumpOrder:
    """Return which pumps run so that as many run as are asked for, and no more.

    Those that run come first, so that no pump is stopped for another one; then they follow each
    other from the duty pump on, round and round. What is not ready is passed over.

    Parameters
    ----------
    duty : casadi.SX
        Number of the duty pump, from 1.
    runs, ready : sequence of casadi.SX
        Truth values of each pump.
    demand : casadi.SX
        How many are to run.

    Examples
    --------
    Pump 2 is on duty, but in an operator's hand, and one pump is asked for:

    >>> yes, no = ca.DM(1), ca.DM(0)
    >>> order = pump_order(ca.DM(2), (no, no, no), (yes, no, yes), ca.DM(1))
    >>> [bool(wanted) for wanted in order.wanted]
    [False, False, True]
    """
    count = len(runs)
    turns = [i - duty + count * (i < duty) for i in range(1, count + 1)]
    wanted = []
    for i in range(count):
        before = ca.SX(0)
        for j in range(count):
            if j == i:
                continue
            earlier = ca.if_else(runs[i] == runs[j], turns[j] < turns[i], runs[j])
            before = before + ca.logic_and(ready[j], earlier)
        wanted.append(ca.logic_and(ready[i], before < demand))
    return PumpOrder(tuple(wanted), _behind_the_leader(duty, runs, ready, turns))


def _behind_the_leader(
    duty: ca.SX, runs: Sequence[ca.SX], ready: Sequence[ca.SX], turns: Sequence[ca.SX]
) -> ca.SX:
    count = len(runs)
    lead = ca.SX(count)  # the turn of the first pump that runs in automatic
    for running, automatic, turn in zip(runs, ready, turns, strict=True):
        lead = ca.fmin(lead, ca.if_else(ca.logic_and(running, automatic), turn, count))
    behind = duty + ca.if_else(lead < count, lead, 0) + 1
    following = ca.if_else(behind > count, behind - count, behind)
    return ca.fmin(count, ca.fmax(1, following))  # the number of a pump, whatever stood there
