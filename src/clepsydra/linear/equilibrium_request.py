"""What is asked of an equilibrium: which signals are given, and which are to be found."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.process.process import Process
from clepsydra.process.signal_values import beyond_range

#: Values of signals by their names [SI].
Given = Mapping[str, float] | None
#: What fixes an operating point: "inputs", "outputs" and "disturbances" to what is given of each.
Asked = Mapping[str, Given]


@dataclass(frozen=True)
class EquilibriumRequest:
    """The given values, and the inputs that are free to meet the asked outputs.

    Parameters
    ----------
    inputs : ndarray [m]
        Given values; where an input is free, the value to start from.
    free_inputs : tuple of int
        Places of the inputs to be found.
    disturbances : ndarray [k]
    outputs : tuple of int
        Places of the measurements whose values are asked for, as many as free inputs.
    targets : ndarray
        The asked values, in the order of `outputs`.
    """

    inputs: np.ndarray
    free_inputs: tuple[int, ...]
    disturbances: np.ndarray
    outputs: tuple[int, ...]
    targets: np.ndarray


def read_request(
    process: Process, inputs: Given, outputs: Given, disturbances: Given
) -> EquilibriumRequest:
    """Check what is asked and complete it from the process's nominal values.

    Parameters
    ----------
    inputs, outputs, disturbances : mapping, optional
        As in `find_equilibrium`.

    Raises
    ------
    InputError
        A name is unknown, a value is not a finite number or outside the signal's range, the
        number of outputs is not that of the free inputs, or inputs are left out where the process
        has nominal outputs.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> read_request(load_process("quadruple-tank"), {"pump_1": 2.5}, None, None).inputs
    array([2.5, 3. ])
    """
    if inputs is None and outputs is None and process.nominal_outputs:
        outputs = process.nominal_outputs
    given = _checked(process.inputs, inputs or {}, "inputs", "an input")
    asked = _checked(process.measurements, outputs or {}, "outputs", "a measurement")
    forced = _checked(process.disturbances, disturbances or {}, "disturbances", "a disturbance")
    free = [i for i, signal in enumerate(process.inputs) if signal.name not in given]
    if free and not asked and process.nominal_outputs:
        _refuse_missing(process, free)
    if not asked:
        free = []
    elif len(asked) != len(free):
        _refuse_number(process, given, asked, free)
    places = [i for i, signal in enumerate(process.measurements) if signal.name in asked]
    values = np.array([given.get(s.name, s.initial) for s in process.inputs], float)
    loads = np.array([forced.get(s.name, s.initial) for s in process.disturbances], float)
    targets = np.array([asked[process.measurements[place].name] for place in places], float)
    return EquilibriumRequest(values, tuple(free), loads, tuple(places), targets)


def _refuse_number(
    process: Process, given: dict[str, float], asked: dict[str, float], free: list[int]
) -> None:
    names = ", ".join(process.inputs[place].name for place in free) or "none"
    if given:
        expected = f"as many outputs as inputs that are not given ({len(free)}: {names})"
        remedy = "give either an input or an output for each degree of freedom, not both"
    else:
        expected = f"exactly {len(free)} outputs, one for each manipulated input ({names})"
        remedy = "name as many outputs as there are inputs to be found"
    raise InputError("operating point, outputs", ", ".join(asked), expected, remedy)


def _refuse_missing(process: Process, free: list[int]) -> None:
    """Refuse to rest where inputs are left out, of which the process file does not say a value."""
    names = [process.inputs[place].name for place in free]
    expected = (
        f"a value of every input, since the file of {process.name} gives measurements at rest "
        f"({', '.join(process.nominal_outputs)}) and no inputs"
    )
    remedy = f"give {' and '.join(names)} too, or measurements in place of inputs"
    raise InputError("operating point, inputs", Finding(f"no {', '.join(names)}"), expected, remedy)


def _checked(
    signals: tuple[Signal, ...], values: Mapping[str, float], what: str, one: str
) -> dict[str, float]:
    by_name = {signal.name: signal for signal in signals}
    checked = {}
    for name, value in values.items():
        place = f"operating point, {what}.{name}"
        if name not in by_name:
            remedy = suggestion(name, by_name, f"use the name of {one}")
            expected = "one of " + ", ".join(by_name) if by_name else f"no name: there is not {one}"
            raise InputError(place, name, expected, remedy)
        signal = by_name[name]
        number = isinstance(value, (int, float, np.integer, np.floating))
        if not number or isinstance(value, bool) or not math.isfinite(value):
            unit = "" if signal.unit == "1" else f" {signal.unit}"
            span = f"a number from {signal.low:g} to {signal.high:g}{unit}"
            raise InputError(place, value, span, "give a finite number in SI units")
        if beyond := beyond_range(signal, value, "a value"):
            raise InputError(place, *beyond, f"choose a value inside the range of {name}")
        checked[name] = float(value)
    return checked
