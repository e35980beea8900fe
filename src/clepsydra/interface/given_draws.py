"""Plants whose numbers a caller gives, column by column."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.arguments import require_signal
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import factor_of
from clepsydra.interface.quantities import read_signal
from clepsydra.process.signal_values import beyond_range
from clepsydra.studies.robustness.drawn_plants import GivenPlants

if TYPE_CHECKING:
    from clepsydra.studies.robustness.drawn_loops import DrawnLoops

_PLACE = "batch, draws"


def given_plants(loops: DrawnLoops, draws: Mapping[str, Any]) -> GivenPlants:
    """Return plants whose parameters, disturbances, levels and settings are given.

    Parameters
    ----------
    loops : DrawnLoops
        Of the plant from which they differ, with the controller whose settings they may be.
    draws : mapping
        Name to a value for each plant.

    Raises
    ------
    InputError
        A name is unknown, a value is none of it or beyond what it can be, or columns differ in
        their lengths.
    """
    process, law = loops.plants.point.process, loops.controller.law
    groups: dict[str, list[Signal]] = {
        "values": [*process.parameters, *process.disturbances],
        "settings": list(law.parameters),
        "levels": list(process.state),
    }
    known = {s.name: (what, s) for what, group in reversed(groups.items()) for s in group}
    signals = [signal for _, signal in known.values()]
    words = f"a parameter, disturbance or state of {process.name}, or a parameter of the law"
    found: dict[str, dict[str, np.ndarray]] = {what: {} for what in groups}
    lengths: dict[int, str] = {}
    for name, values in draws.items():
        require_signal(_PLACE, name, signals, words)
        what, signal = known[name]
        column = _column(signal, values, in_si=what == "settings")
        lengths[len(column)] = name
        found[what][name] = column
    if len(lengths) != 1 or 0 in lengths:
        raise InputError(
            _PLACE, f"{len(lengths)} lengths" if lengths else "nothing that varies",
            "a value for each plant, as many of every name",
            f"give {' and '.join(lengths.values()) or 'tank_1.area, say,'} the same number",
        )  # fmt: skip
    plants = loops.plants
    return GivenPlants(
        plants.point, plants.pairing, found["values"], found["settings"], found["levels"]
    )


def _column(signal: Signal, values: Any, *, in_si: bool) -> np.ndarray:
    """Return the values of a signal in SI."""
    place, unit = f"{_PLACE}, {signal.name}", signal.shown_unit
    try:
        column = np.asarray(values)
    except ValueError:
        column = np.zeros((0, 0))
    if column.ndim != 1:
        raise InputError(
            place, f"{column.ndim} dimensions", "a value for each plant",
            f"write as in [{signal.initial:.4g}, …]",
        )  # fmt: skip
    if column.dtype.kind in "US":
        texts = [str(each) for each in column]
        found = np.array([read_signal(place, "value", text, signal, "a value") for text in texts])
    elif column.dtype.kind in "iuf":
        factor = 1.0 if in_si or unit == signal.unit else float(factor_of(unit, signal.unit))
        found = column.astype(float) * factor
    else:
        raise InputError(
            place,
            column.dtype.name,
            f"numbers in {unit}, or texts with units",
            "write as in '1 cm'",
        )
    outside = ~((found >= signal.low) & (found <= signal.high) & np.isfinite(found))
    if outside.any():
        draw = int(np.argmax(outside))
        beyond = beyond_range(signal, float(found[draw]), "values")
        value, expected = beyond or (str(found[draw]), "finite numbers")
        raise InputError(place, f"{value} in draw {draw + 1}", expected, "stay inside the range")
    return found
