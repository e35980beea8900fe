"""The terms of a PID loop in each of its forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from clepsydra.controllers.blocks.derivative import FilteredDerivative, filtered_derivative
from clepsydra.controllers.blocks.error_shape import gap_error, squared_error
from clepsydra.controllers.blocks.handover import Applied
from clepsydra.controllers.blocks.integral import applied_ports, integral
from clepsydra.controllers.blocks.ports import called
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.pid_parameters import remembered
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class LoopSignals:
    """What a loop computes with; all but the truth values are numbers.

    Parameters
    ----------
    setpoint, measurement : casadi.SX
        r and y [measurement unit].
    known : casadi.SX
        Whether they may be used.
    switched : casadi.SX
        Whether the setpoint comes from another source than in the last sample.
    last_applied : casadi.SX
        What the loop moves, in the last sample.

    Examples
    --------
    >>> values = [ca.DM(value) for value in (5, 4, 1, 0, 3)]
    >>> float(LoopSignals(*values).setpoint)
    5.0
    """

    setpoint: ca.SX
    measurement: ca.SX
    known: ca.SX
    switched: ca.SX
    last_applied: ca.SX


def time_step_of(s: Symbols) -> tuple[ca.SX, ca.SX]:
    """Return the time step, 1 s in place of one that is none, and whether it is one.

    Examples
    --------
    >>> [float(value) for value in time_step_of({"time_step": ca.DM(-2)})]
    [1.0, 0.0]
    """
    good = is_time_step(s["time_step"])
    return ca.if_else(good, s["time_step"], 1), good


def pid_terms(form: PidForm, s: Symbols, loop: LoopSignals) -> dict[str, ca.SX]:
    """Return the terms of a loop; the equations of each form stand in `PidForm`.

    An integral time at or below zero switches integral action off: nothing is divided by it.
    Where a parameter differs from the last sample, the integral takes up what that changes in
    the rest of the sum, so that the output is the one that the former parameters ask for, and
    gains may be scheduled in every sample. Where the source of the setpoint differs, the output
    goes on from what was applied.

    Parameters
    ----------
    form : PidForm
    s : mapping
        Parameters and state of the loop by name, and the time step.
    loop : LoopSignals

    Returns
    -------
    dict
        unlimited, what it asks for; and on the way there error, and proportional, increment and
        integral_used, or in the velocity form change; filtered and rate of the derivative.

    Examples
    --------
    One sample of PI control at an error of 1 with K = 2, Ti = 10 s and I = 5:

    >>> given = dict(proportional_gain=2, integral_time=10, setpoint_weight=1, integral=5,
    ...              last_proportional_gain=2, last_setpoint_weight=1, time_step=1)
    >>> s = {name: ca.DM(value) for name, value in given.items()}
    >>> loop = LoopSignals(*(ca.DM(value) for value in (1, 0, 1, 0, 5)))
    >>> float(pid_terms(PidForm(anti_windup="none"), s, loop)["unlimited"])
    7.0
    """
    writer = _Writer(form, s, loop)
    return writer.velocity() if form.algorithm == "velocity" else writer.positional()


def pid_state(form: PidForm, s: Symbols, applied: Applied) -> dict[str, ca.SX]:
    """Return the next state of a loop.

    Parameters
    ----------
    form : PidForm
    s : mapping
        Parameters and state of the loop, its terms, and setpoint_used, measurement_used and
        signals_known of its `LoopSignals`; last_applied.
    applied : Applied

    Examples
    --------
    What was applied by hand is followed:

    >>> given = dict(integral=5, integral_used=5, proportional=2, increment=1, last_applied=7,
    ...              proportional_gain=2, setpoint_weight=1, last_proportional_gain=2,
    ...              last_setpoint_weight=1, signals_known=1, time_step=1)
    >>> s = {name: ca.DM(value) for name, value in given.items()}
    >>> by_hand = Applied(ca.DM(9), ca.DM(0), ca.DM(1))
    >>> float(pid_state(PidForm(anti_windup="none"), s, by_hand)["integral"])
    7.0
    """
    known, good = s["signals_known"], is_time_step(s["time_step"])
    usable = ca.logic_and(known, good)

    def kept(value: ca.SX, last: str) -> ca.SX:
        return ca.if_else(ca.logic_and(usable, is_number(value)), value, s[last])

    state: dict[str, ca.SX] = {}
    if form.has_derivative:
        state["filtered_signal"] = kept(s["filtered"], "filtered_signal")
    if form.algorithm == "velocity":
        state["last_setpoint"] = kept(s["setpoint_used"], "last_setpoint")
        state["last_measurement"] = kept(s["measurement_used"], "last_measurement")
        if form.has_derivative:
            state["last_derivative"] = kept(s["rate"], "last_derivative")
        heard = usable
    else:
        if form.has_derivative:  # there is none without a time step
            known = usable
        block = integral(form.winding)
        given = {**s, **applied_ports(applied), "integral": s["integral_used"], "known": known}
        found = called(block, "integral_action", given)
        following = found.outputs["following"]
        # After nonsense at run time the integral is still the one before it.
        state["integral"] = ca.if_else(is_number(following), following, s["integral"])
        heard = ca.logic_or(applied.in_force, ca.logic_and(applied.follows, known))
    for parameter in remembered(form):
        taken = ca.logic_and(heard, is_number(s[parameter]))
        state[f"last_{parameter}"] = ca.if_else(taken, s[parameter], s[f"last_{parameter}"])
    return state


class _Writer:
    def __init__(self, form: PidForm, s: Symbols, loop: LoopSignals) -> None:
        self.form, self.s, self.loop = form, s, loop
        self.time_step, self.time_step_good = time_step_of(s)
        self.error = loop.setpoint - loop.measurement
        self.gain = s["proportional_gain"]

    def positional(self) -> dict[str, ca.SX]:
        form, loop = self.form, self.loop
        derivative = self._derivative(self._now) if form.has_derivative else None
        proportional, acting = self._nonintegral(derivative, self._now)
        integral_gain = self._integral_gain() if form.has_integral else ca.SX(0)
        increment = (self.time_step * integral_gain) * acting
        known = loop.known
        if derivative is not None:  # there is none without a time step
            known = ca.logic_and(known, self.time_step_good)
        integral_used = self._integral(proportional, known)
        return {
            "error": self.error,
            "integral_gain_used": integral_gain,
            "proportional": proportional,
            "increment": increment,
            "integral_used": integral_used,
            "unlimited": proportional + integral_used,
            **({} if derivative is None else {"filtered": derivative.filtered}),
        }

    def velocity(self) -> dict[str, ca.SX]:
        form, loop, s = self.form, self.loop, self.s
        # A setpoint from another source moves the output by its integral alone.
        last_setpoint = ca.if_else(loop.switched, loop.setpoint, s["last_setpoint"])
        moved = s["setpoint_weight"] * (loop.setpoint - last_setpoint) - (
            loop.measurement - s["last_measurement"]
        )
        change = self.gain * moved + (self.time_step * self._integral_gain()) * self.error
        found = {"error": self.error}
        if form.has_derivative:
            derivative = self._derivative(self._now)
            # A change of the filter, or of the source of the setpoint, is no turn of the signal.
            turned = self._derivative(self._former).rate - s["last_derivative"]
            if form.derivative_on == "error":
                turned = ca.if_else(loop.switched, 0, turned)
            change = change + (self.gain * s["derivative_time"]) * turned
            found |= {"filtered": derivative.filtered, "rate": derivative.rate}
        return {**found, "change": change, "unlimited": loop.last_applied + change}

    def _now(self, what: str) -> ca.SX:
        return self.s[what]

    def _former(self, what: str) -> ca.SX:
        """Return a parameter as it was in the last sample, if a change of it matters."""
        return self.s[f"last_{what}" if what in remembered(self.form) else what]

    def _nonintegral(
        self, derivative: FilteredDerivative | None, read: Callable[[str], ca.SX]
    ) -> tuple[ca.SX, ca.SX]:
        """Return what does not come from the integral, and the error that it integrates."""
        form, loop, gain = self.form, self.loop, read("proportional_gain")
        if form.error == "linear":
            weight = read("setpoint_weight")
            acting, weighted = self.error, weight * loop.setpoint - loop.measurement
        elif form.error == "gap":
            acting = gap_error(self.error, read("gap"), read("gap_gain"))
            weighted = acting
        else:
            acting = squared_error(self.error, read("squared_error_scale"))
            weighted = acting
        if derivative is None:
            return gain * weighted, acting
        if form.algorithm == "parallel":
            return gain * weighted + read("derivative_gain") * derivative.rate, acting
        lead = read("derivative_time") * derivative.rate
        acting = acting + lead if form.algorithm == "series" else acting
        return gain * (weighted + lead), acting

    def _derivative(self, read: Callable[[str], ca.SX]) -> FilteredDerivative:
        """Return the derivative of the error, or of the measurement with the other sign."""
        loop = self.loop
        if self.form.algorithm == "parallel":
            filter_time = ca.fmax(0, read("filter_time"))
        else:
            ratio = read("derivative_filter")
            given = ratio > 0
            filter_time = ca.fmax(0, read("derivative_time")) / ca.if_else(given, ratio, 1)
        filtered = self.s["filtered_signal"]
        if self.form.derivative_on == "measurement":
            found = filtered_derivative(loop.measurement, filtered, filter_time, self.time_step)
            return FilteredDerivative(-found.rate, found.filtered)
        # A setpoint from another source is no movement of the error.
        filtered = ca.if_else(loop.switched, self.error, filtered)
        return filtered_derivative(self.error, filtered, filter_time, self.time_step)

    def _integral_gain(self) -> ca.SX:
        if self.form.algorithm == "parallel":
            return self.s["integral_gain"]
        integral_time = self.s["integral_time"]
        acts = integral_time > 0
        return ca.if_else(acts, self.gain / ca.if_else(acts, integral_time, 1), 0)

    def _integral(self, nonintegral: ca.SX, known: ca.SX) -> ca.SX:
        """Return the integral with which this sample goes on without a bump."""
        form, before = self.form, self.s["integral"]
        derivative = self._derivative(self._former) if form.has_derivative else None
        former, _ = self._nonintegral(derivative, self._former)
        changed = ca.SX(0)
        for parameter in remembered(form):
            changed = ca.logic_or(changed, self.s[parameter] != self.s[f"last_{parameter}"])
        taken_up = ca.if_else(ca.logic_and(changed, known), before + (former - nonintegral), before)
        restarted = self.loop.last_applied - nonintegral
        return ca.if_else(ca.logic_and(self.loop.switched, known), restarted, taken_up)
