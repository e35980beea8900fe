"""The terms of a PID loop in each of its forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from clepsydra.controllers.blocks.derivative import FilteredDerivative, filtered_derivative
from clepsydra.controllers.blocks.error_shape import gap_error, squared_error
from clepsydra.controllers.blocks.handover import Applied, Limits
from clepsydra.controllers.blocks.integral import IntegralAction
from clepsydra.controllers.blocks.validity import is_number
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
    time_step : casadi.SX
        Above zero [s].
    time_step_good : casadi.SX
        Whether it is the one given.

    Examples
    --------
    >>> values = [ca.DM(value) for value in (5, 4, 1, 0, 3, 1, 1)]
    >>> float(LoopSignals(*values).setpoint)
    5.0
    """

    setpoint: ca.SX
    measurement: ca.SX
    known: ca.SX
    switched: ca.SX
    last_applied: ca.SX
    time_step: ca.SX
    time_step_good: ca.SX


@dataclass(frozen=True)
class PidTerms:
    """What a loop asks for, and how its memory goes on.

    Parameters
    ----------
    unlimited : casadi.SX
        What it asks for.
    measurement : casadi.SX
        y
    next_state : callable
        Takes the `Applied` value and returns names of the state to their next values.
    named : dict
        Names for values on the way.

    Examples
    --------
    >>> terms = PidTerms(ca.DM(7.0), ca.DM(4.0), lambda applied: {}, {})
    >>> float(terms.unlimited)
    7.0
    """

    unlimited: ca.SX
    measurement: ca.SX
    next_state: Callable[[Applied], dict[str, ca.SX]]
    named: dict[str, ca.SX]


def pid_terms(
    form: PidForm, number: int, symbols: Symbols, loop: LoopSignals, limits: Limits
) -> PidTerms:
    """Write the terms of loop `number`; the equations of each form stand in `PidForm`.

    An integral time at or below zero switches integral action off: nothing is divided by it.
    Where a parameter differs from the last sample, the integral takes up what that changes in
    the rest of the sum, so that the output is the one that the former parameters ask for, and
    gains may be scheduled in every sample. Where the source of the setpoint differs, the output
    goes on from what was applied.

    Parameters
    ----------
    form : PidForm
    number : int
        k, from 1.
    symbols : mapping
        The law's signals by name.
    loop : LoopSignals
    limits : Limits
        Of what the loop moves.

    Examples
    --------
    One sample of PI control at an error of 1 with K = 2, Ti = 10 s and I = 5:

    >>> given = dict(proportional_gain=2, integral_time=10, setpoint_weight=1, integral=5,
    ...              last_proportional_gain=2, last_setpoint_weight=1)
    >>> symbols = {f"{name}_1": ca.DM(value) for name, value in given.items()}
    >>> loop = LoopSignals(*(ca.DM(value) for value in (1, 0, 1, 0, 5, 1, 1)))
    >>> terms = pid_terms(PidForm(anti_windup="none"), 1, symbols, loop,
    ...                   Limits(ca.DM(0), ca.DM(9)))
    >>> float(terms.unlimited)
    7.0
    """
    writer = _Writer(form, number, symbols, loop)
    return writer.velocity() if form.algorithm == "velocity" else writer.positional(limits)


class _Writer:
    def __init__(self, form: PidForm, number: int, symbols: Symbols, loop: LoopSignals) -> None:
        self.form, self.number, self.symbols, self.loop = form, number, symbols, loop
        self.error = loop.setpoint - loop.measurement
        self.gain = self._value("proportional_gain")

    def _name(self, what: str) -> str:
        return f"{what}_{self.number}"

    def _value(self, what: str) -> ca.SX:
        return self.symbols[self._name(what)]

    def positional(self, limits: Limits) -> PidTerms:
        form, loop, name = self.form, self.loop, self._name
        derivative = self._derivative(self._value) if form.has_derivative else None
        nonintegral, acting = self._nonintegral(derivative, self._value)
        integral_gain = self._integral_gain() if form.has_integral else ca.SX(0)
        increment = (loop.time_step * integral_gain) * acting
        known = loop.known
        if derivative is not None:  # there is none without a time step
            known = ca.logic_and(known, loop.time_step_good)
        integral = self._integral(nonintegral, known)
        action = IntegralAction(
            integral=integral,
            proportional=nonintegral,
            increment=increment,
            known=known,
            last_applied=loop.last_applied,
            anti_windup=form.winding,
            time_step=loop.time_step,
            tracking_time=self.symbols.get(name("tracking_time")),
            limits=limits,
        )

        def next_state(applied: Applied) -> dict[str, ca.SX]:
            following = action.following(applied)
            # After nonsense at run time the integral is still the one before it.
            kept = ca.if_else(is_number(following), following, self._value("integral"))
            state = {name("integral"): kept}
            if derivative is not None:
                state[name("filtered_signal")] = self._kept_filter(derivative)
            heard = ca.logic_or(applied.in_force, ca.logic_and(applied.follows, known))
            return state | self._remembered(heard)

        unlimited = nonintegral + integral
        named = {
            name("error"): self.error,
            name("integral_gain_used"): integral_gain,
            name("proportional"): nonintegral,
            name("increment"): increment,
            name("integral_used"): integral,
            name("unlimited"): unlimited,
        }
        return PidTerms(unlimited, loop.measurement, next_state, named)

    def velocity(self) -> PidTerms:
        form, loop, name = self.form, self.loop, self._name
        # A setpoint from another source moves the output by its integral alone.
        last_setpoint = ca.if_else(loop.switched, loop.setpoint, self._value("last_setpoint"))
        moved = self._value("setpoint_weight") * (loop.setpoint - last_setpoint) - (
            loop.measurement - self._value("last_measurement")
        )
        change = self.gain * moved + (loop.time_step * self._integral_gain()) * self.error
        derivative = self._derivative(self._value) if form.has_derivative else None
        if derivative is not None:
            # A change of the filter, or of the source of the setpoint, is no turn of the signal.
            turned = self._derivative(self._former).rate - self._value("last_derivative")
            if form.derivative_on == "error":
                turned = ca.if_else(loop.switched, 0, turned)
            change = change + (self.gain * self._value("derivative_time")) * turned
        unlimited = loop.last_applied + change

        def next_state(applied: Applied) -> dict[str, ca.SX]:
            state = {
                name("last_setpoint"): self._kept(loop.setpoint, "last_setpoint"),
                name("last_measurement"): self._kept(loop.measurement, "last_measurement"),
            }
            if derivative is not None:
                state[name("filtered_signal")] = self._kept_filter(derivative)
                state[name("last_derivative")] = self._kept(derivative.rate, "last_derivative")
            return state | self._remembered(ca.logic_and(loop.known, loop.time_step_good))

        named = {
            name("error"): self.error,
            name("change"): change,
            name("unlimited"): unlimited,
        }
        return PidTerms(unlimited, loop.measurement, next_state, named)

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
        filtered = self._value("filtered_signal")
        if self.form.derivative_on == "measurement":
            found = filtered_derivative(loop.measurement, filtered, filter_time, loop.time_step)
            return FilteredDerivative(-found.rate, found.filtered)
        # A setpoint from another source is no movement of the error.
        filtered = ca.if_else(loop.switched, self.error, filtered)
        return filtered_derivative(self.error, filtered, filter_time, loop.time_step)

    def _integral_gain(self) -> ca.SX:
        if self.form.algorithm == "parallel":
            return self._value("integral_gain")
        integral_time = self._value("integral_time")
        acts = integral_time > 0
        return ca.if_else(acts, self.gain / ca.if_else(acts, integral_time, 1), 0)

    def _former(self, what: str) -> ca.SX:
        """Return a parameter as it was in the last sample, if a change of it matters."""
        return self.symbols.get(f"last_{self._name(what)}", self._value(what))

    def _integral(self, nonintegral: ca.SX, known: ca.SX) -> ca.SX:
        """Return the integral with which this sample goes on without a bump."""
        form, integral = self.form, self._value("integral")
        derivative = self._derivative(self._former) if form.has_derivative else None
        former, _ = self._nonintegral(derivative, self._former)
        changed = ca.SX(0)
        for parameter in remembered(self.number, form):
            differs = self.symbols[parameter] != self.symbols[f"last_{parameter}"]
            changed = ca.logic_or(changed, differs)
        taken_up = ca.if_else(
            ca.logic_and(changed, known), integral + (former - nonintegral), integral
        )
        restarted = self.loop.last_applied - nonintegral
        return ca.if_else(ca.logic_and(self.loop.switched, known), restarted, taken_up)

    def _remembered(self, heard: ca.SX) -> dict[str, ca.SX]:
        state = {}
        for parameter in remembered(self.number, self.form):
            value, last = self.symbols[parameter], self.symbols[f"last_{parameter}"]
            taken = ca.logic_and(heard, is_number(value))
            state[f"last_{parameter}"] = ca.if_else(taken, value, last)
        return state

    def _kept(self, value: ca.SX, last: str) -> ca.SX:
        usable = ca.logic_and(self.loop.known, self.loop.time_step_good)
        taken = ca.logic_and(usable, is_number(value))
        return ca.if_else(taken, value, self._value(last))

    def _kept_filter(self, derivative: FilteredDerivative) -> ca.SX:
        return self._kept(derivative.filtered, "filtered_signal")
