"""The areas of orifices, from levels at rest or from levels recorded while they move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.identification.pump_gains import IntervalEstimate, interval
from clepsydra.process.elements.orifice import Orifice
from clepsydra.process.process import Process

_WEAKEST = 1e-9


def orifice_areas_at_rest(
    process: Process, records: Sequence[Mapping[str, float]]
) -> dict[str, float]:
    """Return the areas with which a process rests at recorded levels.

    The balance of each tank is linear in the areas: what flows in by the pumps and out of the
    tanks above equals a √(2 g h). With more records than needed the areas are those of least
    squares of the rates of the levels.

    Parameters
    ----------
    process : Process
        With orifices, all of whose other parameters are known.
    records : sequence of mapping
        Every state and input by name to its value at rest [SI], "tank_1.level" and "pump_1";
        disturbances that are left out stand at their nominal values.

    Returns
    -------
    dict
        Orifice to its area [m²], "outlet_1".

    Raises
    ------
    InputError
        The process has no orifices, a record lacks a signal or has one that is no number, or
        the records leave an area open, as where its tank is empty.

    Examples
    --------
    Levels of a process at rest give its own areas back:

    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> found = orifice_areas_at_rest(process, [find_equilibrium(process).as_dict()])
    >>> round(1e4 * found["outlet_1"], 6)  # [cm²]
    0.071
    """
    place = "orifice areas at rest"
    names = _orifices(process, place)
    if not records:
        raise InputError(f"{place}, records", "none", "at least one", "give the levels")
    columns = (
        _columns(process, record, 1, f"{place}, record {number}")
        for number, record in enumerate(records, 1)
    )
    without, by_area = _Balances(process, names).at(*map(np.hstack, zip(*columns, strict=True)))
    known = -without.T.reshape(-1)
    effects = by_area.reshape(-1, len(names))
    _check_seen(effects, names, place)
    found = np.linalg.lstsq(effects, known, rcond=None)[0]
    return dict(zip(names, (float(area) for area in found), strict=True))


def orifice_areas(
    process: Process, time: ArrayLike, record: Mapping[str, ArrayLike]
) -> dict[str, IntervalEstimate]:
    """Return the areas that explain recorded levels while they move, with their intervals.

    What each tank gains in a sample is its balance over it, by the trapezoidal rule between the
    two levels and with the inputs held. Least squares over all tanks and samples; the intervals
    allow noise that differs from tank to tank and hits several at once, as that of a pump does
    which feeds two (White's covariance, clustered by sample).

    The noise must be of the flows. Noise of the level sensors counts twice, with both signs, in
    neighbouring samples, and widens the intervals; take fewer samples where it is large.

    Parameters
    ----------
    process : Process
        With orifices, all of whose other parameters are known.
    time : array_like [n]
        [s], rising.
    record : mapping
        Every state and input by name to its values [n] [SI]; inputs are held from each time to
        the next. Disturbances that are left out stand at their nominal values.

    Returns
    -------
    dict
        Orifice to its area [m²].

    Raises
    ------
    InputError
        The process has no orifices, the record lacks a signal, has gaps or a wrong length, is
        too short, time does not rise, or the record leaves an area open.

    References
    ----------
    H. White, A heteroskedasticity-consistent covariance matrix estimator and a direct test for
    heteroskedasticity, Econometrica 48(4), 1980, 817-838, doi 10.2307/1912934.

    Examples
    --------
    >>> import clepsydra as cl
    >>> steps = [cl.step("pump_1", to="3.5 V", at="10 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, steps, duration="5 min")
    >>> found = orifice_areas(run.process, run.time, run.values)
    >>> round(1e4 * found["outlet_1"].value, 4)  # [cm²]
    0.071
    """
    place = "orifice areas"
    names = _orifices(process, place)
    clock = np.asarray(time, float).ravel()
    if not (len(clock) >= 2 and np.all(np.isfinite(clock)) and np.all(np.diff(clock) > 0.0)):
        raise InputError(f"{place}, time", "no rising times", "rising times", "sort by time")
    state, inputs, disturbances = _columns(process, record, len(clock), place)
    balances, steps = _Balances(process, names), np.diff(clock)
    held = (inputs[:, :-1], disturbances[:, :-1])
    starts, ends = balances.at(state[:, :-1], *held), balances.at(state[:, 1:], *held)
    without, by_area = ((s + e) / 2.0 for s, e in zip(starts, ends, strict=True))
    gained = np.diff(state, axis=1) - steps * without
    effects = steps[:, None, None] * by_area
    flat = effects.reshape(-1, len(names))
    freedom = flat.shape[0] - len(names)
    if freedom < 1:
        raise InputError(f"{place}, time", f"{len(clock)} times", "more times", "record for longer")
    _check_seen(flat, names, place)
    inverse = np.linalg.inv(flat.T @ flat)
    areas = inverse @ flat.T @ gained.T.reshape(-1)
    left = gained.T - effects @ areas
    scores = np.einsum("kil,ki->kl", effects, left)
    samples = len(steps)
    covariance = inverse @ (scores.T @ scores) @ inverse * samples / max(samples - 1, 1)
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return {
        name: interval(float(area), float(error), max(samples - 1, 1))
        for name, area, error in zip(names, areas, errors, strict=True)
    }


class _Balances:
    """The rates of the states without any orifice, and what each area adds to them."""

    def __init__(self, process: Process, names: list[str]) -> None:
        groups = (process.state, process.inputs, process.disturbances, process.parameters)
        x, u, d, p = (ca.SX.sym(n, len(g)) for n, g in zip("xudp", groups, strict=True))
        rates = process.dynamics(x, u, d, p)
        places = [[s.name for s in process.parameters].index(f"{name}.area") for name in names]
        by_area = ca.jacobian(rates, p)[:, places]
        values = process.parameter_values
        values[places] = 0.0
        self._shape = (len(process.state), len(names))
        self._values = values
        self._function = ca.Function("balances", [x, u, d, p], [rates, ca.vec(ca.densify(by_area))])

    def at(
        self, state: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the rates [n, k] and the effects of the areas [k, n, l] of k columns."""
        count = state.shape[1]
        values = np.repeat(self._values[:, None], count, axis=1)
        rates, by_area = self._function.map(count)(state, inputs, disturbances, values)
        n, orifices = self._shape
        effects = np.array(by_area).reshape(orifices, n, count, order="C")
        return np.array(rates), effects.transpose(2, 1, 0)


def _orifices(process: Process, place: str) -> list[str]:
    names = [element.name for element in process.elements if isinstance(element, Orifice)]
    if not names:
        raise InputError(place, process.name, "a process with orifices", "choose another process")
    return names


def _columns(
    process: Process, record: Mapping[str, ArrayLike], times: int, place: str
) -> Iterator[np.ndarray]:
    """Return states, inputs and disturbances of a record [signals, times]."""
    for group in (process.state, process.inputs, process.disturbances):
        rows = np.empty((len(group), times))
        for row, signal in zip(rows, group, strict=True):
            if signal.name not in record and signal in process.disturbances:
                row[:] = signal.initial
                continue
            values = np.asarray(record.get(signal.name, []), float).ravel()
            if len(values) != times or not np.all(np.isfinite(values)):
                raise InputError(
                    f"{place}, {signal.name}",
                    f"{len(values)} values, {int(np.sum(~np.isfinite(values)))} of them no numbers",
                    f"one number [{signal.unit}] for each time, {times} in all",
                    "give every state and input, and leave out the rows with gaps",
                )
            row[:] = values
        yield rows


def _check_seen(effects: np.ndarray, names: list[str], place: str) -> None:
    sizes = np.linalg.norm(effects, axis=0)
    scaled = effects / np.where(sizes > 0.0, sizes, 1.0)
    seen = np.linalg.svd(scaled, compute_uv=False)
    if np.any(sizes == 0.0) or len(seen) < len(names) or seen[-1] < _WEAKEST:
        hidden = [name for name, size in zip(names, sizes, strict=True) if size == 0.0]
        raise InputError(
            place,
            f"no flow through {', '.join(hidden)}" if hidden else "too few different levels",
            "levels at which water runs through every orifice",
            "fill the tanks, or give more records",
        )
