"""The equilibria of a process: from given inputs, or from given outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import ClepsydraError
from clepsydra.base.remark import Remark
from clepsydra.base.rounding import rounded
from clepsydra.linear.equilibrium_continuation import by_homotopy, by_pseudo_transient
from clepsydra.linear.equilibrium_inputs import BeyondRange, warnings_of_inputs
from clepsydra.linear.equilibrium_mixtures import beyond_mixtures
from clepsydra.linear.equilibrium_reasons import (
    inputs_beyond,
    reasons_of_harm,
    reasons_outside_ranges,
    reasons_without_solution,
    undetermined,
    warnings_of_sensors,
)
from clepsydra.linear.equilibrium_request import EquilibriumRequest, Given, read_request
from clepsydra.linear.equilibrium_search import EquilibriumSearch, Iterate
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import shown
from clepsydra.process.process import Process

_DIGITS = 14
# Starts that are tried where the search from the initial levels fails: shares of the height.
OTHER_STARTS = (0.1, 0.9)
# All states at these shares of their ranges, then so many random mixtures, always the same.
_SHARES = (0.02, 0.2, 0.4, 0.6, 0.8, 0.98)
_MIXTURES = 6
# Two solutions nearer than this share of the range in every state are one.
_SAME = 1e-6


class NoEquilibrium(ClepsydraError):
    """There is no equilibrium, and why.

    Parameters
    ----------
    process : Process
        Its file, or its name where it has none, is the place in the message.
    reasons : sequence of str
        Sentences with the names of the signals, without the full stop.
    place : str, optional
        Where what was asked stands, if anywhere: file, line and table.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> print(NoEquilibrium(load_process("quadruple-tank"), ["tank_1.level accumulates"]))
    quadruple-tank: no equilibrium as asked: tank_1.level accumulates; ask for other inputs or \
outputs (in a process file the pumps' 'nominal', or [operating_point]), or change the plant.
    """

    def __init__(self, process: Process, reasons: Sequence[str], place: str = "") -> None:
        self.reasons, self.place = tuple(reasons), place or str(process.path or process.name)
        super().__init__(
            f"{self.place}: no equilibrium as asked: "
            f"{'; '.join(self.reasons)}; ask for other inputs or outputs (in a process file the "
            "pumps' 'nominal', or [operating_point]), or change the plant."
        )


def find_equilibrium(
    process: Process, inputs: Given = None, outputs: Given = None, disturbances: Given = None
) -> OperatingPoint:
    """Find the state in which nothing moves.

    Without `outputs` the inputs are given and f(x, u, d, p) = 0 is solved for the state. With
    `outputs` the inputs that are not given are found together with the state. With neither, the
    process's own nominal outputs are taken, or else the nominal values of its inputs.

    Newton's method with exact derivatives, damped, in the square root of each level above its
    floor, in which Torricelli's outflow is linear. Where it fails from every start, the motion
    is followed to its rest, or the asked outputs are approached in steps
    (`equilibrium_continuation`). Memories stay as they are at first.

    Parameters
    ----------
    inputs : mapping, optional
        Manipulated input to its value, SI; without `outputs`, an input that is not named keeps
        its nominal value, where the process has no nominal outputs.
    outputs : mapping, optional
        Measurement to the value asked for [its SI unit], as many as there are inputs not given.
    disturbances : mapping, optional
        Disturbance to its value, SI; nominal where not named.

    Returns
    -------
    OperatingPoint
        Exact to fourteen digits. A level that the given signals leave open keeps its initial value,
        with a warning; so does a sensor that would show a value beyond its range.

    Raises
    ------
    NoEquilibrium
        A state accumulates, an input would leave its range, a level would stand above its rim
        or below its floor, something would run dry or trip, the outputs cannot be set
        independently, or nothing was found.
    InputError
        The process is none, a name is unknown, a value is no number or out of range, or too
        much or too little is given.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> point = find_equilibrium(process, inputs={"pump_1": 3.0, "pump_2": 3.0})
    >>> round(100 * point.as_dict()["tank_1.level"], 4)
    12.263
    """
    require_type(
        process, Process, "process", "a Process", "read it with load_process(name or path)"
    )
    request = read_request(process, inputs, outputs, disturbances)
    search = EquilibriumSearch(process, request)
    solution = _first_found(search)
    state, manipulated = (_rounded(values) for values in search.values(solution.unknowns))
    refused = (
        reasons_outside_ranges(search, solution)
        or reasons_of_harm(process, state, manipulated, request.disturbances)
        if solution.solved
        else reasons_without_solution(search, solution)
    )
    if refused:
        of_file = inputs is None and outputs is None and process.nominal_outputs
        place = process.place("operating_point") if of_file else ""
        raise NoEquilibrium(process, beyond_mixtures(process, request) or refused, place)
    point = OperatingPoint.at(process, state, manipulated, request.disturbances)
    warnings = [
        Remark(
            f"{signal.name} stands on its floor", "the tank is empty and has no linear model there"
        )
        for signal, value in zip(process.state, state, strict=True)
        if signal.unit == "m" and value <= signal.low
    ]
    warnings += _warnings_at(point)
    free_names = undetermined(search, solution)
    if free_names:
        warnings.append(
            Remark(
                f"{' and '.join(free_names)} may take other values as well",
                "the given signals do not determine them, and they were left near their initial "
                "values",
                "give the reading of a sensor under [operating_point]",
            )
        )
    return replace(point, warnings=(*process.warnings, *warnings))


def inputs_beyond_at(
    point: OperatingPoint, outputs: Mapping[str, float], disturbances: np.ndarray
) -> list[BeyondRange]:
    """Return the inputs that would have to leave their ranges to hold outputs under loads.

    Parameters
    ----------
    point : OperatingPoint
        Where the search begins.
    outputs : mapping
        Measurement to its value [its SI unit], as many as there are inputs.
    disturbances : ndarray [k]

    Returns
    -------
    list of BeyondRange
        Empty as well where nothing was found that rests.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("equalisation-tank"))
    >>> (found,) = inputs_beyond_at(point, {"level": 0.9}, 3.0 * point.disturbances)

    0.921 m³/s of inflow, and the pump gives 0.5 m³/s:

    >>> found.signal.name, round(found.value, 3)
    ('outflow', 1.842)
    """
    process = point.process
    places = tuple(i for i, each in enumerate(process.measurements) if each.name in outputs)
    targets = np.array([outputs[process.measurements[place].name] for place in places])
    free = tuple(range(len(process.inputs)))
    request = EquilibriumRequest(point.inputs, free, disturbances, places, targets)
    search = EquilibriumSearch(process, request)
    solution = _first_found(search)
    return inputs_beyond(search, solution) if solution.solved else []


def _warnings_at(point: OperatingPoint) -> list[Remark]:
    """Return what leaves no room for control there, and what elements say of it."""
    return [
        *warnings_of_sensors(point.process, point.measurements),
        *warnings_of_inputs(point),
        *warnings_of_elements(point),
    ]


def warnings_of_elements(point: OperatingPoint) -> list[Remark]:
    """Return what each element finds unusual about itself at an operating point."""
    process = point.process
    values = {s.name: s.initial for s in (*process.parameters, *process.motion.memories)}
    values |= point.as_dict()
    return [remark for element in process.elements for remark in element.remarks(values)]


def _rounded(values: np.ndarray) -> np.ndarray:
    """Return values without the last digits, in which one processor differs from another."""
    return np.array([rounded(float(value), _DIGITS) for value in values])


def _first_found(search: EquilibriumSearch) -> Iterate:
    """Return the first solution with all levels on or above their floor, or the first attempt."""
    first = search.run(None)
    for share in (None, *OTHER_STARTS):
        attempt = first if share is None else search.run(share)
        if attempt.solved and not search.below_floor(attempt.unknowns).any():
            return attempt
    return _by_continuation(search) or first


def _by_continuation(search: EquilibriumSearch) -> Iterate | None:
    if search.request.free_inputs:
        return by_homotopy(search)
    if search.request.outputs:
        return None
    ways = (by_pseudo_transient(search, share) for share in (None, *OTHER_STARTS))
    return next((found for found in ways if found is not None), None)


def find_equilibria(
    process: Process, inputs: Given = None, outputs: Given = None, disturbances: Given = None
) -> list[OperatingPoint]:
    """Find the equilibria of a request, `find_equilibrium`'s first.

    Newton's method from all states low, high and in between, and from mixtures of these. That
    it finds no other is no proof that there is none. Where the given signals leave a level
    open, only the first is returned, since every level is one.

    Parameters
    ----------
    inputs, outputs, disturbances : mapping, optional
        As in `find_equilibrium`.

    Returns
    -------
    list of OperatingPoint
        Each within all ranges. Where there are several, each has a warning that names another.
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
        point = OperatingPoint.at(process, state, manipulated, first.disturbances)
        found.append(replace(point, warnings=(*process.warnings, *_warnings_at(point))))
    if len(found) == 1:
        return found
    return [
        replace(point, warnings=(*point.warnings, _another(point, found[0 if place else 1])))
        for place, point in enumerate(found)
    ]


def _same(
    search: EquilibriumSearch, state: np.ndarray, inputs: np.ndarray, known: OperatingPoint
) -> bool:
    there = search.unknowns_at(known.state, known.inputs)
    here = search.unknowns_at(state, inputs)
    return bool(np.all(np.abs(here - there) <= _SAME * np.maximum(1.0, np.abs(there))))


def _another(point: OperatingPoint, other: OperatingPoint) -> Remark:
    """Return the sentence on another equilibrium, with what differs most in it."""
    process = point.process
    here, there = point.as_dict(), other.as_dict()
    different = [
        f"{s.name} at {shown(s, there[s.name])} instead of {shown(s, here[s.name])}"
        for s in (*process.state, *process.inputs)
        if abs(there[s.name] - here[s.name]) > _SAME * (s.span if np.isfinite(s.span) else 1.0)
    ]
    return Remark(
        f"there is another equilibrium for the same signals, with {' and '.join(different[:3])}"
        f"{' and more' if len(different) > 3 else ''}",
        "which of them the process comes to depends on where it starts",
    )
