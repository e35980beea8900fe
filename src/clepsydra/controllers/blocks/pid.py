"""The terms of a PID loop in each of its forms."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from clepsydra.controllers.blocks.anti_windup import next_integral
from clepsydra.controllers.blocks.filters import (
    FilteredDerivative,
    filtered_derivative,
    gap_error,
    squared_error,
)
from clepsydra.controllers.blocks.ports import Applied
from clepsydra.controllers.blocks.validity import (
    any_of,
    is_number,
    is_time_step,
    time_step_of,
)
from clepsydra.controllers.pid_form import PidForm
from clepsydra.program.step_law import Symbols

#: What a reader is told above the steps of a loop, in any form.
PID_WORDS = {
    "measurement_used": "not a number: counts as zero, and the output is held",
    "error": "control error",
    "faceplate.error": "control error",
    "proportional": "proportional and derivative part",
    "faceplate.p_part": "proportional and derivative part",
    "faceplate.i_part": "integral part, bumpless at a change of settings",
    "increment": "increment of the integral in this scan",
    "filtered": "signal behind the filter of the derivative",
    "change": "change of the output in this scan",
    "unlimited": "unlimited output of the loop",
    "signals_known": "setpoint and measurement are valid, and the sensor is good",
    "last_proportional_gain": "last settings, for a bumpless change",
    "last_derivative_time": "last settings, for a bumpless change",
}
#: How a parameter is read: as it is, or as it was in the last sample.
_Read = Callable[[str], ca.SX]


def pid_terms(form: PidForm, s: Symbols) -> dict[str, ca.SX]:
    """Return the terms of a loop; the equations of each form stand in `PidForm`.

    An integral time at or below zero switches integral action off: nothing is divided by it.
    Where a parameter differs from the last sample, the integral takes up what that changes in
    the rest of the sum, so that the output is the one that the former parameters ask for, and
    gains may be scheduled in every sample. Where the source of the setpoint differs, the output
    goes on from what was applied.

    `s`: parameters and state of the loop by name, and the time step; setpoint_used and
    measurement_used, always numbers, and signals_known, whether they may be used; switched, whether
    the setpoint comes from another source than in the last sample; last_applied.

    Returns
    -------
    dict
        unlimited, what it asks for; and on the way there error, and proportional, increment and
        integral_used, or in the velocity form change; filtered and rate of the derivative, and
        p_part and d_part of proportional.
    """
    error = s["setpoint_used"] - s["measurement_used"]
    written = _velocity if form.algorithm == "velocity" else _positional
    return {"error": error, **written(form, {**s, "error": error})}


def pid_state(
    form: PidForm, s: Symbols, applied: Applied
) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
    """Return the next state of a loop, and names for values on the way there.

    `s`: as for `pid_terms`, with the terms.
    """
    known, good = s["signals_known"], is_time_step(s["time_step"])
    usable = ca.logic_and(known, good)

    def kept(value: ca.SX, last: str) -> ca.SX:
        return ca.if_else(ca.logic_and(usable, is_number(value)), value, s[last])

    state: dict[str, ca.SX] = {}
    named: dict[str, ca.SX] = {}
    if form.has_derivative:
        state["filtered_signal"] = kept(s["filtered"], "filtered_signal")
    if form.algorithm == "velocity":
        state["last_setpoint"] = kept(s["setpoint_used"], "last_setpoint")
        state["last_measurement"] = kept(s["measurement_used"], "last_measurement")
        if form.has_derivative:
            state["last_derivative"] = kept(s["rate"], "last_derivative")
        accepted = usable
    else:
        if form.has_derivative:  # there is none without a time step
            known = usable
        following, named = next_integral(
            form.winding, s, applied, known=known, last_applied=s["last_applied"]
        )
        # After nonsense at run time the integral is still the one before it.
        state["integral"] = ca.if_else(is_number(following), following, s["integral"])
        accepted = ca.logic_or(applied.in_force, ca.logic_and(applied.follows, known))
        named = {**named, "settings_accepted": accepted}
    for parameter in form.remembered:
        taken = ca.logic_and(accepted, is_number(s[parameter]))
        state[f"last_{parameter}"] = ca.if_else(taken, s[parameter], s[f"last_{parameter}"])
    return state, named


def _former(form: PidForm, s: Symbols) -> _Read:
    """Return what reads a parameter as it was in the last sample, if a change of it matters."""
    return lambda name: s[f"last_{name}" if name in form.remembered else name]


def _positional(form: PidForm, s: Symbols) -> dict[str, ca.SX]:
    time_step, time_step_good = time_step_of(s)
    known, derivative, found = s["signals_known"], None, {}
    former = _former(form, s)
    if form.has_derivative:  # there is none without a time step
        known = ca.logic_and(known, time_step_good)
        derivative = _derivative(form, s, s.__getitem__)
        found["filtered"] = derivative.filtered
    proportional, acting, parts = _nonintegral(form, s, derivative, s.__getitem__)
    integral_gain = _integral_gain(form, s) if form.has_integral else ca.SX(0)
    # With the integral of this sample the output goes on without a bump.
    before = s["integral"]
    last = _derivative(form, s, former) if form.has_derivative else None
    standing, *_ = _nonintegral(form, s, last, former)
    changed = any_of([ca.SX(0), *(s[name] != s[f"last_{name}"] for name in form.remembered)])
    taken_up = ca.if_else(ca.logic_and(changed, known), before + (standing - proportional), before)
    restarted = s["last_applied"] - proportional
    integral_used = ca.if_else(ca.logic_and(s["switched"], known), restarted, taken_up)
    return {
        "integral_gain_used": integral_gain,
        "proportional": proportional,
        "increment": (time_step * integral_gain) * acting,
        "integral_used": integral_used,
        "unlimited": proportional + integral_used,
        **found,
        **parts,
    }


def _velocity(form: PidForm, s: Symbols) -> dict[str, ca.SX]:
    time_step, _ = time_step_of(s)
    gain, setpoint = s["proportional_gain"], s["setpoint_used"]
    # A setpoint from another source moves the output by its integral alone.
    last_setpoint = ca.if_else(s["switched"], setpoint, s["last_setpoint"])
    moved = s["setpoint_weight"] * (setpoint - last_setpoint) - (
        s["measurement_used"] - s["last_measurement"]
    )
    change = gain * moved + (time_step * _integral_gain(form, s)) * s["error"]
    found = {}
    if form.has_derivative:
        derivative = _derivative(form, s, s.__getitem__)
        # A change of the filter, or of the source of the setpoint, is no turn of the signal.
        turned = _derivative(form, s, _former(form, s)).rate - s["last_derivative"]
        if form.derivative_on == "error":
            turned = ca.if_else(s["switched"], 0, turned)
        change = change + (gain * s["derivative_time"]) * turned
        found = {"filtered": derivative.filtered, "rate": derivative.rate}
    return {**found, "change": change, "unlimited": s["last_applied"] + change}


def _nonintegral(
    form: PidForm, s: Symbols, derivative: FilteredDerivative | None, read: _Read
) -> tuple[ca.SX, ca.SX, dict[str, ca.SX]]:
    """Return what does not come from the integral, the error that it integrates, and the parts."""
    gain, acting = read("proportional_gain"), s["error"]
    if form.error == "gap":
        weighted = acting = gap_error(acting, read("gap"), read("gap_gain"))
    elif form.error == "squared":
        weighted = acting = squared_error(acting, read("squared_error_scale"))
    else:
        weighted = read("setpoint_weight") * s["setpoint_used"] - s["measurement_used"]
    part = gain * weighted
    if derivative is None:
        return part, acting, {}
    if form.algorithm == "parallel":
        lead = read("derivative_gain") * derivative.rate
        return part + lead, acting, {"p_part": part, "d_part": lead}
    lead = read("derivative_time") * derivative.rate
    acting = acting + lead if form.algorithm == "series" else acting
    return gain * (weighted + lead), acting, {"p_part": part, "d_part": gain * lead}


def _derivative(form: PidForm, s: Symbols, read: _Read) -> FilteredDerivative:
    """Return the derivative of the error, or of the measurement with the other sign."""
    time_step, _ = time_step_of(s)
    if form.algorithm == "parallel":
        filter_time = ca.fmax(0, read("filter_time"))
    else:
        ratio = read("derivative_filter")
        given = ratio > 0
        filter_time = ca.fmax(0, read("derivative_time")) / ca.if_else(given, ratio, 1)
    filtered = s["filtered_signal"]
    if form.derivative_on == "measurement":
        found = filtered_derivative(s["measurement_used"], filtered, filter_time, time_step)
        return FilteredDerivative(-found.rate, found.filtered)
    # A setpoint from another source is no movement of the error.
    filtered = ca.if_else(s["switched"], s["error"], filtered)
    return filtered_derivative(s["error"], filtered, filter_time, time_step)


def _integral_gain(form: PidForm, s: Symbols) -> ca.SX:
    if form.algorithm == "parallel":
        return s["integral_gain"]
    acts = s["integral_time"] > 0
    gain = s["proportional_gain"] / ca.if_else(acts, s["integral_time"], 1)
    return ca.if_else(acts, gain, 0)
