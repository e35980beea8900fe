"""What crosses the boundary of a plant, added up, so that the balance of a run can be drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.component import Component
from clepsydra.process.flow import Flow

#: Totals of what crosses the boundary of the plant.
ENTERED, LEFT = "balance.entered", "balance.left"
#: Total of what is on its way through the delays, more than at first.
DELAYED = "balance.delayed"


def conserved(components: Iterable[Component]) -> list[tuple[str, str]]:
    """Return what is conserved, with the unit of its amount: the liquid, then each component."""
    return [("liquid", "m^3"), *((each.name, each.amount_unit) for each in components)]


def balance_totals(of: Iterable[tuple[str, str]], *, delayed: bool) -> tuple[Signal, ...]:
    """Return the totals of a plant, with those of its delays where it has some."""
    every = list(of)
    totals = (ENTERED, LEFT, DELAYED) if delayed else (ENTERED, LEFT)
    return tuple(Signal(f"{total}.{name}", unit) for total in totals for name, unit in every)


def crossing(
    flows: Sequence[Flow], totals: Sequence[Signal], outside: Callable[[str], bool]
) -> dict[str, ca.SX]:
    """Return the rate of every total by the flows alone.

    Parameters
    ----------
    totals : sequence of Signal
        As `balance_totals` returns them.
    outside : callable
        Name of an element, empty for beyond the plant, to whether liquid there is not counted.

    Examples
    --------
    >>> totals = balance_totals([("liquid", "m^3")], delayed=False)
    >>> rain = Flow("", "tank", ca.SX(1), ca.SX(2))
    >>> crossing([rain], totals, lambda name: not name)
    {'balance.entered.liquid': SX(2), 'balance.left.liquid': SX(0)}
    """
    found = {total.name: ca.SX(0) for total in totals}
    for flow in flows:
        amounts = {"liquid": flow.rate, **(flow.fluxes or {})}
        for total, end in ((ENTERED, flow.source), (LEFT, flow.destination)):
            if outside(end):
                for name, amount in amounts.items():
                    found[f"{total}.{name}"] += amount
    return found
