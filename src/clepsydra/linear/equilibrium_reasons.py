"""Why there is no equilibrium, in words and with the names of the signals."""

from __future__ import annotations

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.linear.equilibrium_inputs import BeyondRange, beyond_its_range, input_flow
from clepsydra.linear.equilibrium_search import RANK, EquilibriumSearch, Iterate
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import beyond_of_range, shown_apart
from clepsydra.process.process import Process

# A share of the range that rounding may add to a value at its limit.
AT_LIMIT = 1e-9
# A component of a null vector below this share of the largest plays no part.
_PART = 1e-6


def reasons_outside_ranges(search: EquilibriumSearch, solved: Iterate) -> tuple[str, ...]:
    """Return a sentence for each input outside its range and each level beyond rim or floor.

    Parameters
    ----------
    solved : Iterate
        Where all derivatives vanish.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium_request import read_request
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> both = dict.fromkeys(("pump_1", "pump_2"), 9.0)
    >>> search = EquilibriumSearch(process, read_request(process, both, None, None))
    >>> reasons_outside_ranges(search, search.run(None))[0]
    'tank_1.level would stand at 110.4 cm, above its rim at 20 cm'
    """
    process = search.process
    state, _ = search.values(solved.unknowns)
    beyond = inputs_beyond(search, solved)
    reasons = [beyond_its_range(each) for each in beyond]
    moved = [each.signal.name for each in beyond]
    for signal, value in zip(process.state, state, strict=True):
        if signal.owner in moved:  # an actuator follows its signal
            continue
        if value > signal.high + AT_LIMIT * abs(signal.high):
            where = "its rim" if signal.unit == "m" else "the top of its range,"
            height, limit = shown_apart(signal, value, signal.high)
            reasons.append(f"{signal.name} would stand at {height}, above {where} at {limit}")
        slack = AT_LIMIT * (signal.span if np.isfinite(signal.span) else abs(signal.low))
        if signal.unit != "m" and value < signal.low - slack:
            found, limit = shown_apart(signal, value, signal.low)
            reasons.append(f"{signal.name} would be {found}, below its range from {limit}")
    # An input that pumps backwards is the cause; the levels below the floor only follow.
    return tuple(reasons or _levels_below(search, solved.unknowns, solved))


def inputs_beyond(search: EquilibriumSearch, solved: Iterate) -> list[BeyondRange]:
    """Return the inputs that are outside their ranges.

    Parameters
    ----------
    solved : Iterate
        Where all derivatives vanish.
    """
    process = search.process
    state, inputs = search.values(solved.unknowns)
    point = OperatingPoint.at(process, state, inputs, search.request.disturbances)
    return [
        BeyondRange(signal, float(value), input_flow(point, signal))
        for signal, value in zip(process.inputs, inputs, strict=True)
        if _is_outside(signal, value)
    ]


def reasons_of_harm(
    process: Process, state: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray
) -> tuple[str, ...]:
    """Return a sentence for each event that would harm the plant at once, so that nothing rests.

    Parameters
    ----------
    state, inputs, disturbances : ndarray
        At which the equations rest with every memory as it is at first.
    """
    motion, p = process.motion, process.parameter_values
    if not any(event.harm for event in motion.events):
        return ()
    guards = motion.guards(*motion.at_rest(state, inputs, disturbances, p))
    return tuple(
        f"nothing would rest there, since {event.words}"
        for event, guard in zip(motion.events, np.array(guards).ravel(), strict=True)
        if event.harm and guard >= 0.0
    )


def reasons_without_solution(search: EquilibriumSearch, stuck: Iterate) -> tuple[str, ...]:
    """Return why the search ended without a solution.

    Parameters
    ----------
    stuck : Iterate
        Its last one.
    """
    if not stuck.finite:
        names = [
            name
            for name, slopes in zip(search.row_names, stuck.jacobian, strict=True)
            if not np.isfinite(slopes).all()
        ]
        return (f"the equations of {' and '.join(names)} have no finite derivative on the way",)
    reasons = _accumulation(search, stuck)
    if reasons:
        return reasons
    below = _levels_below(search, stuck.unknowns + stuck.newton_step(), stuck)
    if below:
        return tuple(below)
    worst = int(np.argmax(np.abs(stuck.residuals) / stuck.row_sizes))
    name = search.row_names[worst]
    return (
        f"the search did not converge; the largest remainder is {stuck.residuals[worst]:.3g} "
        f"(SI) in {name}: ask for another operating point",
    )


def undetermined(search: EquilibriumSearch, solved: Iterate) -> list[str]:
    """Return the states and free inputs that may take other values in the same equilibrium."""
    _, right = _null_spaces(search, solved)
    return _taking_part(search.unknown_names, right)


def warnings_of_sensors(process: Process, measured: np.ndarray) -> list[Remark]:
    """Return a sentence for each sensor that would show a value beyond its range.

    Parameters
    ----------
    measured : ndarray [q]
        What the sensors read, before any limit.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> warnings_of_sensors(load_process("quadruple-tank"), np.array([6.0, 11.0, 1.0, 1.0]))
    ['level_2 would read 11 V, outside its range from 0 V to 10 V: it cannot be controlled there.']
    """
    return [
        Remark(
            f"{signal.name} would read {beyond_of_range(signal, value)}",
            "it cannot be controlled there",
        )
        for signal, value in zip(process.measurements, measured, strict=True)
        if _is_outside(signal, value)
    ]


def _is_outside(signal: Signal, value: float) -> bool:
    """Return whether a value is beyond its range by more than rounding."""
    slack = AT_LIMIT * (signal.span if np.isfinite(signal.span) else 0.0)
    return not signal.low - slack <= value <= signal.high + slack


def _accumulation(search: EquilibriumSearch, stuck: Iterate) -> tuple[str, ...]:
    """Return what no choice of the unknowns can bring to zero, or nothing if there is none."""
    process, request = search.process, search.request
    left, right = _null_spaces(search, stuck)
    if not np.any(np.abs(left.T @ stuck.residuals) > np.abs(left.T) @ stuck.rounding):
        return ()
    states = len(process.state)
    free = search.unknown_names[states:]
    if _taking_part(free, right[states:]):
        asked = search.row_names[states:]
        outputs = _taking_part(asked, left[states:]) or asked
        return (
            f"{' and '.join(outputs)} cannot take the asked "
            f"{'values' if len(outputs) > 1 else 'value'}: {' and '.join(free)} cannot set the "
            "asked outputs independently",
        )
    levels = _taking_part(search.row_names[:states], right[:states])
    if not levels:
        return ()
    if len(levels) > 1:
        return (
            f"{' and '.join(levels)} accumulate together: no flow changes when they rise "
            "together, so nothing balances what flows into them",
        )
    end = ""
    if not request.outputs:
        # ẋ in the long run lies along the direction that no equation feels.
        along = right * search.state_slopes(stuck.unknowns)[:, None]
        rates = along @ np.linalg.lstsq(left.T @ along, left.T @ stuck.residuals, rcond=None)[0]
        signal, rate = next(
            (signal, rate)
            for signal, rate in zip(process.state, rates, strict=True)
            if signal.name == levels[0]
        )
        way = "rises" if rate > 0.0 else "falls"
        end = f"; in the long run it {way} by {abs(rate):.3g} {signal.unit}/s"
    return (
        f"{levels[0]} accumulates: no flow changes with it, so nothing balances what flows in and "
        f"out{end}",
    )


def _null_spaces(search: EquilibriumSearch, iterate: Iterate) -> tuple[np.ndarray, np.ndarray]:
    """Return the balances that no unknown changes and the unknowns that no balance feels.

    As columns, in SI by rows (left) and scaled (right). Empty tanks are left out of the latter:
    nothing feels them because they are empty.
    """
    sizes = iterate.row_sizes
    columns, values, rows = np.linalg.svd(iterate.jacobian / sizes[:, None])
    rank = int(np.sum(values > RANK * max(float(values.max(initial=0.0)), 1.0)))
    left, right = columns[:, rank:] / sizes[:, None], rows[rank:].T
    state, _ = search.values(iterate.unknowns)
    floors = [signal.low for signal in search.process.state]
    empty = np.concatenate([state <= floors, np.zeros(len(search.request.free_inputs), bool)])
    return left, np.where(empty[:, None], 0.0, right)


def _taking_part(names: list[str], vectors: np.ndarray) -> list[str]:
    largest = np.abs(vectors).max(axis=1, initial=0.0)
    return [name for name, size in zip(names, largest, strict=True) if size > _PART]


def _levels_below(search: EquilibriumSearch, unknowns: np.ndarray, last: Iterate) -> list[str]:
    states = len(search.process.state)
    below = search.below_floor(unknowns)[:states]
    rises = (last.residuals > last.rounding)[:states]
    falls = "would have to fall below its floor: more is drawn from it than flows in"
    rise = "finds no rest: where the search ended, more flows in than out"
    return [
        f"{signal.name} {rise if is_rising else falls}"
        for signal, is_below, is_rising in zip(search.process.state, below, rises, strict=True)
        if is_below
    ]
