"""Limits of an output, and the tighter ones that a rate limit makes of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.handover import Limits
from clepsydra.controllers.blocks.validity import is_time_step
from clepsydra.program.step_law import Symbols


def rate_limit_parameter(number: int, signal: Signal, rate: float) -> Signal:
    """Return rate_limit_i of an output.

    Examples
    --------
    >>> rate_limit_parameter(1, Signal("pump_1", "V"), 2.0).unit
    'V/s'
    """
    return Signal(
        f"rate_limit_{number}",
        signals.ratio_of_units(signal.unit, "s"),
        low=0.0,
        high=signals.LARGEST_PARAMETER,
        initial=rate,
        description=f"largest rate of change of {signal.name}, "
        f"{signals.LARGEST_PARAMETER:g} for none",
    )


@dataclass(frozen=True)
class MovingLimits:
    """Between which values an output may stand in a scan.

    Given to a law as its own limits, so that its own anti-windup heeds the rate limit.

    Parameters
    ----------
    fixed, moving : Limits
        Of the actuator; and those within its reach in this scan.
    acts : casadi.SX
        Whether a rate limit is in force.
    named : dict
        Names for values on the way.

    Examples
    --------
    >>> zero, ten = ca.DM(0), ca.DM(10)
    >>> limits = MovingLimits(Limits(zero, ten), Limits(ca.DM(4), ca.DM(6)), ca.DM(1))
    >>> [bool(limits.hurried(ca.DM(value))) for value in (5, 6)]
    [False, True]
    """

    fixed: Limits
    moving: Limits
    acts: ca.SX
    named: dict[str, ca.SX] = field(default_factory=dict)

    def hurried(self, output: ca.SX) -> ca.SX:
        """Return whether an output stands at a limit that only its rate makes."""
        at_end = ca.logic_or(output <= self.moving.low, output >= self.moving.high)
        # At a limit of the actuator it is that which holds it.
        inside = ca.logic_and(output > self.fixed.low, output < self.fixed.high)
        return ca.logic_and(ca.logic_and(self.acts, inside), at_end)


def moving_limits(symbols: Symbols, number: int, last: ca.SX, counts: ca.SX) -> MovingLimits:
    """Return the limits that the rate limit leaves around the last output.

    Without a rate limit they are the very limits of the output. Limits win over the rate: an
    output beyond one is brought back at once.

    Parameters
    ----------
    symbols : mapping
        low_limit_i, high_limit_i, rate_limit_i and time_step.
    number : int
        i
    last : casadi.SX
        The output of the last scan.
    counts : casadi.SX
        Whether the rate counts in this scan: neither a fail-safe value is slowed nor what
        somebody else does to the actuator.

    Examples
    --------
    >>> given = dict(low_limit_1=0, high_limit_1=10, rate_limit_1=2, time_step=0.5)
    >>> symbols = {name: ca.DM(value) for name, value in given.items()}
    >>> found = moving_limits(symbols, 1, ca.DM(9.5), ca.DM(1)).moving
    >>> float(found.low), float(found.high)
    (8.5, 10.0)
    """
    low, high = symbols[f"low_limit_{number}"], symbols[f"high_limit_{number}"]
    rate, step = symbols[f"rate_limit_{number}"], symbols["time_step"]
    way = rate * ca.if_else(is_time_step(step), step, 0)
    acts = ca.logic_and(rate < signals.LARGEST_PARAMETER, counts)
    # The last output first in the comparison: what is not a number is passed over.
    lowest = ca.fmin(high, ca.fmax(last - way, low))
    highest = ca.fmax(low, ca.fmin(last + way, high))
    moving = Limits(ca.if_else(acts, lowest, low), ca.if_else(acts, highest, high))
    named = {
        f"rate_limit_acts_{number}": acts,
        f"largest_move_{number}": way,
        f"low_limit_used_{number}": moving.low,
        f"high_limit_used_{number}": moving.high,
    }
    return MovingLimits(Limits(low, high), moving, acts, named)
