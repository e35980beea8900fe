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
    Where a gain, or the source of the setpoint, differs from the last sample, the integral is
    set so that the output goes on from what was applied.

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
        derivative = self._derivative() if form.has_derivative else None
        nonintegral, acting = self._nonintegral(derivative)
        integral_gain = self._integral_gain() if form.has_integral else ca.SX(0)
        increment = (loop.time_step * integral_gain) * acting
        restarts = self._restarts()
        integral = ca.if_else(restarts, loop.last_applied - nonintegral, self._value("integral"))
        action = IntegralAction(
            integral=integral,
            proportional=nonintegral,
            increment=increment,
            known=loop.known,
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
            heard = ca.logic_or(applied.in_force, ca.logic_and(applied.follows, loop.known))
            for parameter in remembered(self.number, form):
                value, last = self.symbols[parameter], self.symbols[f"last_{parameter}"]
                taken = ca.logic_and(heard, is_number(value))
                state[f"last_{parameter}"] = ca.if_else(taken, value, last)
            return state

        unlimited = nonintegral + integral
        named = {
            name("error"): self.error,
            name("integral_gain_used"): integral_gain,
            name("proportional"): nonintegral,
            name("increment"): increment,
            name("restarts"): restarts,
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
        derivative = self._derivative() if form.has_derivative else None
        if derivative is not None:
            turned = derivative.rate - self._value("last_derivative")
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
            return state

        named = {
            name("error"): self.error,
            name("change"): change,
            name("unlimited"): unlimited,
        }
        return PidTerms(unlimited, loop.measurement, next_state, named)

    def _nonintegral(self, derivative: FilteredDerivative | None) -> tuple[ca.SX, ca.SX]:
        """Return what does not come from the integral, and the error that it integrates."""
        form, loop = self.form, self.loop
        if form.error == "linear":
            weight = self._value("setpoint_weight")
            acting, weighted = self.error, weight * loop.setpoint - loop.measurement
        elif form.error == "gap":
            acting = gap_error(self.error, self._value("gap"), self._value("gap_gain"))
            weighted = acting
        else:
            acting = squared_error(self.error, self._value("squared_error_scale"))
            weighted = acting
        if derivative is None:
            return self.gain * weighted, acting
        if form.algorithm == "parallel":
            return self.gain * weighted + self._value("derivative_gain") * derivative.rate, acting
        lead = self._value("derivative_time") * derivative.rate
        acting = acting + lead if form.algorithm == "series" else acting
        return self.gain * (weighted + lead), acting

    def _derivative(self) -> FilteredDerivative:
        """Return the derivative of the error, or of the measurement with the other sign."""
        loop = self.loop
        if self.form.algorithm == "parallel":
            filter_time = ca.fmax(0, self._value("filter_time"))
        else:
            ratio = self._value("derivative_filter")
            given = ratio > 0
            filter_time = ca.fmax(0, self._value("derivative_time")) / ca.if_else(given, ratio, 1)
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

    def _restarts(self) -> ca.SX:
        changed = self.loop.switched
        for parameter in remembered(self.number, self.form):
            differs = self.symbols[parameter] != self.symbols[f"last_{parameter}"]
            changed = ca.logic_or(changed, differs)
        return changed

    def _kept(self, value: ca.SX, last: str) -> ca.SX:
        usable = ca.logic_and(self.loop.known, self.loop.time_step_good)
        taken = ca.logic_and(usable, is_number(value))
        return ca.if_else(taken, value, self._value(last))

    def _kept_filter(self, derivative: FilteredDerivative) -> ca.SX:
        return self._kept(derivative.filtered, "filtered_signal")
