"""The integral of one output or loop, from one sample to the next."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.controllers.blocks.anti_windup import (
    AntiWindup,
    back_calculation,
    clamping,
    conditional_integration,
    tracking_share,
)
from clepsydra.controllers.blocks.handover import Applied, Limits
from clepsydra.controllers.blocks.mode import followed_integral
from clepsydra.controllers.blocks.validity import is_number, is_time_step


@dataclass(frozen=True)
class IntegralAction:
    """What the integral of an output gains, and what it has to heed.

    Parameters
    ----------
    integral : casadi.SX
        In this sample; like all values here in the unit of the output.
    proportional : casadi.SX
        The rest of what is asked for: proportional + integral.
    increment : casadi.SX
        What it gains in automatic.
    known : casadi.SX
        Whether `proportional` was computed from valid signals.
    last_applied : casadi.SX
        What was applied in the last sample.
    anti_windup : AntiWindup
    time_step, tracking_time : casadi.SX
        [s]; the tracking time counts with back-calculation only.
    limits : Limits
        They count with clamping only.

    Examples
    --------
    Asked for 12 where 10 is the limit, with an error that asks for still more:

    >>> action = IntegralAction(
    ...     ca.DM(7), ca.DM(5), ca.DM(1), ca.DM(1), ca.DM(0), "conditional_integration",
    ...     ca.DM(1), ca.DM(5), Limits(ca.DM(0), ca.DM(10)))
    >>> float(action.following(Applied(ca.DM(10), ca.DM(1), ca.DM(0))))
    7.0
    """

    integral: ca.SX
    proportional: ca.SX
    increment: ca.SX
    known: ca.SX
    last_applied: ca.SX
    anti_windup: AntiWindup
    time_step: ca.SX
    tracking_time: ca.SX | None
    limits: Limits

    def following(self, applied: Applied) -> ca.SX:
        """Return the next integral, always a number.

        Where the output had its say the integral takes its increment under the anti-windup
        rule; where the actuator moved without it, it follows, so that automatic continues from
        there; else it stays.
        """
        followed = followed_integral(
            self.integral, applied.value, self.last_applied, self.proportional, self.known
        )
        elsewhere = ca.if_else(applied.follows, followed, self.integral)
        following = ca.if_else(applied.in_force, self._in_force(applied.value), elsewhere)
        # An increment beyond the range of numbers is not taken.
        return ca.if_else(is_number(following), following, self.integral)

    def _in_force(self, applied: ca.SX) -> ca.SX:
        unlimited = self.proportional + self.integral
        if self.anti_windup == "conditional_integration":
            return conditional_integration(self.integral, self.increment, unlimited, applied)
        if self.anti_windup == "clamping":
            return clamping(self.integral, self.increment, self.limits.low, self.limits.high)
        if self.anti_windup == "none" or self.tracking_time is None:
            return self.integral + self.increment
        step = ca.if_else(is_time_step(self.time_step), self.time_step, 1)
        share = tracking_share(step, self.tracking_time)
        return back_calculation(self.integral, self.increment, unlimited, applied, share)
