"""The areas of orifices, from levels at rest or from levels recorded while they move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import Finding, InputError
from clepsydra.process.elements.orifice import Orifice
from clepsydra.process.process import Process

_WEAKEST = 1e-9


def orifice_areas_at_rest(
    process: Process, records: Sequence[Mapping[str, float]]
) -> dict[str, float]:
    """Return the areas with which a process rests at recorded levels [m²], by orifice.

    The balance of each tank is linear in the areas: what flows in by the pumps and out of the
    tanks above equals a √(2 g h). With more records than needed the areas are those of least
    squares of the rates of the levels. All other parameters are those of the process.

    Parameters
    ----------
    process : Process
    records : sequence of mapping
        Every state and input by name to its value at rest [SI], "tank_1.level" and "pump_1";
        disturbances that are left out stand at their nominal values.

    Raises
    ------
    InputError
        The process has no orifices, a record lacks a signal or has one that is no number, or
        the records leave an area open, as where its tank is empty.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> found = orifice_areas_at_rest(process, [find_equilibrium(process).as_dict()])
    >>> round(1e4 * found["outlet_1"], 6)  # [cm²], its own
    0.071
    """
    place = "orifice areas at rest"
    names = [element.name for element in process.elements if isinstance(element, Orifice)]
    if not names:
        raise InputError(place, process.name, "a process with orifices", "choose another process")
    if not records:
        raise InputError(f"{place}, records", "none", "at least one", "give the levels")
    # All closed first, then each by itself with an area of 1 m².
    values = np.tile(process.parameter_values[:, None], (1, 1 + len(names)))
    areas = [[s.name for s in process.parameters].index(f"{name}.area") for name in names]
    values[areas] = np.eye(len(names), 1 + len(names), 1)
    rates = np.vstack(
        [
            np.array(
                process.dynamics(*_values(process, record, f"{place}, record {number}"), values)
            )
            for number, record in enumerate(records, 1)
        ]
    )
    effects = rates[:, 1:] - rates[:, :1]
    _check_seen(effects, names, place)
    found = np.linalg.lstsq(effects, -rates[:, 0], rcond=None)[0]
    return dict(zip(names, found.tolist(), strict=True))


def _values(process: Process, record: Mapping[str, float], place: str) -> Iterator[np.ndarray]:
    """Return states, inputs and disturbances of a record."""
    for group in (process.state, process.inputs, process.disturbances):
        values = []
        for signal in group:
            usual = signal.initial if signal in process.disturbances else None
            value = record.get(signal.name, usual)
            if not is_finite_number(value):
                raise InputError(
                    f"{place}, {signal.name}", value, f"a number [{signal.unit}]",
                    "give every state and input",
                )  # fmt: skip
            values.append(value)
        yield np.array(values, float)


def _check_seen(effects: np.ndarray, names: list[str], place: str) -> None:
    sizes = np.linalg.norm(effects, axis=0)
    scaled = effects / np.where(sizes > 0.0, sizes, 1.0)
    seen = np.linalg.svd(scaled, compute_uv=False)
    if np.any(sizes == 0.0) or len(seen) < len(names) or seen[-1] < _WEAKEST:
        hidden = [name for name, size in zip(names, sizes, strict=True) if size == 0.0]
        raise InputError(
            place,
            Finding(
                f"no flow through {', '.join(hidden)}" if hidden else "too few different levels"
            ),
            "levels at which water runs through every orifice",
            "fill the tanks, or give more records",
        )
