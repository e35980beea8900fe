"""Checks of a controller's numbers before it may run."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.step_law import StepLaw


def check_parameters(law: StepLaw, values: Mapping[str, float], place: str) -> None:
    """Refuse parameter values that a law cannot run with.

    `values`: parameter name to value, in the law's units; `place`: the controller's name, for the
    message.

    Raises InputError: A parameter is missing, unknown, not a finite number or outside its range (an
    integral time at or below zero, say), or a low limit is not below its high limit.

    Examples
    --------
    >>> from clepsydra.controllers.pid import multiloop_pid_law
    >>> law = multiloop_pid_law(["level"], ["pump"])
    >>> check_parameters(law, {parameter.name: 0.0 for parameter in law.parameters}, "PI")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: PI, level.integral_time: got 0.0, expected a number from \
1e-06 to 1e+09 s; give a value in this range.
    """
    check_numbers(law.parameters, values, place)
    for parameter in law.parameters:
        value, low, high = values[parameter.name], parameter.low, parameter.high
        if not low <= value <= high:
            unit = "" if parameter.unit == "1" else f" {parameter.unit}"
            expected = f"a number from {low:g} to {high:g}{unit}"
            name = f"{place}, {parameter.name}"
            raise InputError(name, value, expected, "give a value in this range")
    for parameter in (each for each in law.parameters if each.below):
        lowest, highest = parameter.name, path(parameter.owner, parameter.below)
        if not values[lowest] < values[highest]:
            expected, remedy = f"a value below {highest}", "exchange the limits or widen them"
            raise InputError(f"{place}, {lowest}", values[lowest], expected, remedy)


def remembered_parameters(law: StepLaw, values: Mapping[str, float]) -> dict[str, float]:
    """Return the states that remember a parameter, last_K of K, with the parameter's value."""
    return {state: float(values[parameter]) for state, parameter in remembers(law, values)}


def remembers(law: StepLaw, parameters: Collection[str]) -> list[tuple[str, str]]:
    """Return each state that remembers one of some parameters, with that parameter."""
    named = (
        (state.name, path(state.owner, state.part.removeprefix("last_")))
        for state in map(signal_of, law.state)
    )
    return [(state, parameter) for state, parameter in named if parameter in parameters]


def check_numbers(entries: Sequence[Entry], values: Mapping[str, float], place: str) -> None:
    """Refuse values, of parameters or of an initial state, that are not one finite number for each.

    Raises InputError: One is missing, unknown or not a finite number.
    """
    names = [entry.name for entry in entries]
    missing = [name for name in names if name not in values]
    unknown = [name for name in values if name not in names]
    if missing or unknown:
        steps = [f"add {', '.join(missing)}"] if missing else []
        steps += [f"remove {', '.join(unknown)}"] if unknown else []
        expected = f"values for {', '.join(names)}"
        raise InputError(place, sorted(values), expected, " and ".join(steps))
    for name, value in values.items():
        check_finite(f"{place}, {name}", value)


def check_finite(place: str, value: float) -> None:
    """Refuse what is no finite number.

    Raises
    ------
    InputError
    """
    if not is_finite_number(value):
        raise InputError(place, value, "a finite number", "give a finite number")
