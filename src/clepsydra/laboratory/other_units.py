"""Other units in which the signals of a process are known: those of its variants."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import unit_text
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.report.quantities import display_factor


def other_units(process: Process) -> dict[str, list[dict[str, Any]]]:
    """Return the units that variants of a process have for each signal, and their size [SI].

    Examples
    --------
    >>> found = other_units(load_process("laboratory-four-tanks"))
    >>> [(each["unit"], round(each["size"], 6)) for each in found["level_1"] + found["pump_1"]]
    [('V', 0.2), ('V', 0.066667)]
    """
    found: dict[str, list[dict[str, Any]]] = {}
    for other in _variants(process):
        theirs = {each.name: each for each in (*other.measurements, *other.inputs)}
        for signal in (*process.measurements, *process.inputs):
            size = _size(signal, theirs.get(signal.name))
            unit = unit_text(theirs[signal.name].shown_unit) if size else ""
            known = found.setdefault(signal.name, [])
            if size and all(unit != each["unit"] for each in known):
                known.append({"unit": unit, "size": size})
    return {name: units for name, units in found.items() if units}


def _variants(process: Process) -> Iterator[Process]:
    """Return the process in each other variant, in the place of the one with which it conflicts."""
    where = process.path or process.name
    for variant in process.variants:
        if variant in process.variant:
            continue
        for left in ("", *process.variant):
            kept = [each for each in process.variant if each != left]
            with suppress(InputError):
                yield load_process(where, (*kept, variant))
                break


def _size(signal: Signal, other: Signal | None) -> float | None:
    """Return what one unit of a signal of a variant is in SI, where only its unit is another."""
    if other is None or not (signal.has_range and other.has_range):
        return None
    span, theirs = signal.high - signal.low, other.high - other.low
    place = (signal.initial - signal.low) / span
    is_alike = math.isclose(place, (other.initial - other.low) / theirs, abs_tol=1e-9)
    if unit_text(other.shown_unit) == unit_text(signal.shown_unit) or not is_alike:
        return None
    return span / (theirs * display_factor(other))
