"""Which of several equal pumps run: the order of duty and standby."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca


def pump_order(
    duty: ca.SX, runs: Sequence[ca.SX], ready: Sequence[ca.SX], demand: ca.SX
) -> tuple[list[ca.SX], ca.SX]:
    """Return which pumps shall run, and the number of the pump behind the one that leads.

    As many run as are asked for, and no more.
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
    >>> wanted, next_duty = pump_order(ca.DM(2), (no, no, no), (yes, no, yes), ca.DM(1))
    >>> [bool(each) for each in wanted], float(next_duty)
    ([False, False, True], 3.0)
    """
    count = len(runs)
    turns = [i - duty + count * (i < duty) for i in range(1, count + 1)]

    def comes_first(j: int, i: int) -> ca.SX:
        earlier = ca.if_else(runs[i] == runs[j], turns[j] < turns[i], runs[j])
        return ca.logic_and(ready[j], earlier)

    wanted = []
    for i in range(count):
        before = sum(comes_first(j, i) for j in range(count) if j != i)
        wanted.append(ca.logic_and(ready[i], before < demand))
    lead = ca.SX(count)  # the turn of the first pump that runs in automatic
    for running, automatic, turn in zip(runs, ready, turns, strict=True):
        lead = ca.fmin(lead, ca.if_else(ca.logic_and(running, automatic), turn, count))
    behind = duty + ca.if_else(lead < count, lead, 0) + 1
    following = ca.if_else(behind > count, behind - count, behind)
    # The number of a pump, whatever stood there.
    return wanted, ca.fmin(count, ca.fmax(1, following))
