"""All equilibria of a process that a search from many starts finds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.equilibrium_reasons import (
    reasons_outside_ranges,
    shown,
    undetermined,
    warnings_of_sensors,
)
from clepsydra.linear.equilibrium_request import read_request
from clepsydra.linear.equilibrium_search import EquilibriumSearch
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process

# All states at these shares of their ranges, then so many random mixtures, always the same.
_SHARES = (0.02, 0.2, 0.4, 0.6, 0.8, 0.98)
_MIXTURES = 6
# Two solutions nearer than this share of the range in every state are one.
_SAME = 1e-6


def find_equilibria(
    process: Process,
    inputs: Mapping[str, float] | None = None,
    outputs: Mapping[str, float] | None = None,
    disturbances: Mapping[str, float] | None = None,
) -> list[OperatingPoint]:
    """Find the equilibria of a request, `find_equilibrium`'s first.

    Newton's method from all states low, high and in between, and from mixtures of these. That
    it finds no other is no proof that there is none. Where the given signals leave a level
    open, only the first is returned, since every level is one.

    Parameters
    ----------
    process : Process
    inputs, outputs, disturbances : mapping, optional
        As in `find_equilibrium`.

    Returns
    -------
    list of OperatingPoint
        Each within all ranges. Where there are several, each has a warning that names another.

    Raises
    ------
    NoEquilibrium, InputError
        As in `find_equilibrium`.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> len(find_equilibria(load_process("quadruple-tank")))
    1
    """
    first = find_equilibrium(process, inputs, outputs, disturbances)
    search = EquilibriumSearch(process, read_request(process, inputs, outputs, disturbances))
    spans = search.spans[: len(first.state)]
    solution = search.run_from(search.unknowns_at(first.state, first.inputs))
    if undetermined(search, solution):
        return [first]
    found = [first]
    numbers = np.random.default_rng(1)
    starts = [np.full(len(spans), share) for share in _SHARES]
    starts += list(numbers.random((_MIXTURES, len(spans))))
    for shares in starts:
        low = np.where(np.isfinite(search.floors), search.floors, first.state - 0.5 * spans)
        attempt = search.run_from(search.unknowns_at(low + shares * spans, first.inputs))
        if not attempt.solved or reasons_outside_ranges(search, attempt):
            continue
        state, manipulated = search.values(attempt.unknowns)
        if any(_same(search, state, manipulated, known) for known in found):
            continue
        local = search.derivatives.at(state, manipulated, first.disturbances)
        found.append(
            OperatingPoint(
                process=process,
                state=state,
                inputs=manipulated,
                disturbances=first.disturbances,
                measurements=local.measured,
                residual=float(np.abs(local.rates).max(initial=0.0)),
                warnings=(*process.warnings, *warnings_of_sensors(process, local.measured)),
            )
        )
    if len(found) == 1:
        return found
    return [
        replace(point, warnings=(*point.warnings, _another(point, found[0 if place else 1])))
        for place, point in enumerate(found)
    ]


def _same(
    search: EquilibriumSearch, state: np.ndarray, inputs: np.ndarray, known: OperatingPoint
) -> bool:
    there, here = (
        search.unknowns_at(known.state, known.inputs),
        search.unknowns_at(state, inputs),
    )
    return bool(np.all(np.abs(here - there) <= _SAME * np.maximum(1.0, np.abs(there))))


def _another(point: OperatingPoint, other: OperatingPoint) -> str:
    """Return the sentence on another equilibrium, with what differs most in it."""
    process = point.process
    groups = (
        zip(process.state, point.state, other.state, strict=True),
        zip(process.inputs, point.inputs, other.inputs, strict=True),
    )
    different = [
        f"{signal.name} at {shown(signal, there)} instead of {shown(signal, here)}"
        for group in groups
        for signal, here, there in group
        if abs(there - here) > _SAME * (signal.span if np.isfinite(signal.span) else 1.0)
    ]
    return (
        f"there is another equilibrium for the same signals, with {' and '.join(different[:3])}"
        f"{' and more' if len(different) > 3 else ''}: which of them the process comes to depends "
        "on where it starts"
    )
