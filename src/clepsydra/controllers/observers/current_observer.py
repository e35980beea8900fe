"""The current observer: an estimate that uses the measurement of the same sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import called, truth
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.controllers.observers.structure import ObserverStructure
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_BEFORE, _HELD, _BESIDE = "a sample before", "held for a sample", "not as estimated"


def observer_parameters(
    structure: ObserverStructure, measured: Sequence[Signal], manipulated: Sequence[Signal]
) -> list[Signal]:
    """Return the numbers of the matrices transition, input_effect, observation and correction.

    Examples
    --------
    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> for parameter in observer_parameters(structure, [Signal("level", "V")], [Signal("pump")]):
    ...     print(parameter.name, parameter.unit)
    tank.level.transition.tank.level m/m
    tank.level.input_effect.pump m
    level.observation.tank.level V/m
    tank.level.correction.level m/V
    """
    estimated = structure.estimated
    return [
        *_numbers("transition", structure.transition, estimated, estimated, _BEFORE),
        *_numbers("input_effect", structure.moved, estimated, manipulated, _HELD),
        *_numbers("observation", structure.shown, measured, estimated, "at once"),
        *_numbers("correction", structure.corrected, estimated, measured, _BESIDE),
    ]


def observer_state(structure: ObserverStructure) -> list[Signal]:
    """Return estimates, the deviations from the operating point expected in the next sample.

    Examples
    --------
    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> [(state.name, state.unit) for state in observer_state(structure)]
    [('tank.level.estimate', 'm')]
    """
    return [
        Signal(
            path(signal, "estimate"),
            signal.unit,
            description=f"expected deviation of {signal.name} from the operating point",
        )
        for signal in structure.estimated
    ]


def corrected(
    symbols: Symbols,
    structure: ObserverStructure,
    measured: Sequence[Signal],
    deviations: Sequence[ca.SX],
    measurements_known: ca.SX,
) -> tuple[list[ca.SX], list[ca.SX]]:
    """Return x̂ + M (y − C x̂), the estimate with the measurements of this sample, and y − C x̂.

    Where a measurement is unusable there is no surprise, and the observer goes on with what the
    inputs do. It is the block observer_correction.

    Parameters
    ----------
    symbols : mapping
        Estimates, observation and correction.
    structure : ObserverStructure
    measured : sequence of Signal
    deviations : sequence of casadi.SX
        y, each measurement less its value at the operating point.
    measurements_known : casadi.SX
        Whether all are numbers from sound sensors.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 4.

    Examples
    --------
    2 m were expected, 0.5 m more are measured, and half of that is believed:

    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> numbers = {"tank.level.estimate": ca.DM(2), "level.observation.tank.level": ca.DM(1),
    ...            "tank.level.correction.level": ca.DM(0.5)}
    >>> found = corrected(numbers, structure, [Signal("level", "m")], [ca.DM(2.5)], ca.DM(1))
    >>> float(found[0][0]), float(found[1][0])
    (2.25, 0.5)
    """
    shown = _parts("deviation", measured, "less its value at the operating point")
    estimates = _parts("corrected", structure.estimated, "with the measurements of the sample")
    block = Block(
        "observer_correction",
        (
            *observer_state(structure),
            *shown,
            truth("known", "the measurements are numbers from sound sensors"),
            *_numbers("observation", structure.shown, measured, structure.estimated, "at once"),
            *_numbers("correction", structure.corrected, structure.estimated, measured, _BESIDE),
        ),
        (),
        (*estimates, *_parts("surprise", measured, "less what was expected")),
        lambda s: _correction(s, structure, measured),
        ("The estimate with the measurements: x + M (y - C x).",),
    )
    values = {signal.name: value for signal, value in zip(shown, deviations, strict=True)}
    given = {**symbols, **values, "known": measurements_known}
    found = list(called(block, "observer_correction", given).outputs.values())
    return found[: structure.size], found[structure.size :]


def _correction(s: Symbols, structure: ObserverStructure, measured: Sequence[Signal]) -> Equations:
    estimated = structure.estimated
    expected = [s[path(x, "estimate")] for x in estimated]
    surprise = []
    for y, used in zip(measured, structure.shown, strict=True):
        shown = _row(s, "observation", y, used, estimated, expected)
        surprise.append(ca.if_else(s["known"], s[path(y, "deviation")] - shown, 0))
    found = {
        path(x, "corrected"): value + _row(s, "correction", x, used, measured, surprise)
        for x, value, used in zip(estimated, expected, structure.corrected, strict=True)
    }
    errors = {path(y, "surprise"): e for y, e in zip(measured, surprise, strict=True)}
    return Equations({}, found | errors)


def predicted(
    symbols: Symbols,
    structure: ObserverStructure,
    manipulated: Sequence[Signal],
    estimate: Sequence[ca.SX],
    moves: Sequence[ca.SX],
) -> Mapping[str, ca.SX]:
    """Return the estimates of the next sample: Φ x̂ + Γ (u − u°).

    u is what was really given out, after mode, limits and hold, so that neither an operator's
    hand nor saturation misleads the observer. Φ and Γ are those of one sampling period. In a
    sample whose time step is unusable, or where numbers run over, the estimate stays. It is the
    block observer_prediction.

    Parameters
    ----------
    symbols : mapping
        Estimates, transition, input_effect and time_step.
    structure : ObserverStructure
    manipulated : sequence of Signal
    estimate : sequence of casadi.SX
        The corrected one.
    moves : sequence of casadi.SX
        u − u°, each input less its value at the operating point.

    Examples
    --------
    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> numbers = {"tank.level.estimate": ca.SX(2), "tank.level.transition.tank.level": ca.SX(0.5),
    ...            "tank.level.input_effect.pump": ca.SX(3), "time_step": ca.SX(1)}
    >>> found = predicted(numbers, structure, [Signal("pump", "V")], [ca.SX(4)], [ca.SX(0.1)])
    >>> float(ca.evalf(found["tank.level.estimate"]))
    2.3
    """
    estimated = structure.estimated
    before = _parts("corrected", estimated, "with the measurements of the sample")
    moved = _parts("move", manipulated, "less its value at the operating point")
    block = Block(
        "observer_prediction",
        (
            *before,
            *moved,
            Signal("time_step", "s"),
            *_numbers("transition", structure.transition, estimated, estimated, _BEFORE),
            *_numbers("input_effect", structure.moved, estimated, manipulated, _HELD),
        ),
        tuple(observer_state(structure)),
        (),
        lambda s: _prediction(s, structure, manipulated),
        ("The estimate of the next sample: Phi x + Gamma (u - u0), u as it was applied.",),
    )
    ports = [*before, *moved]
    values = {signal.name: v for signal, v in zip(ports, [*estimate, *moves], strict=True)}
    return called(block, "observer_prediction", {**symbols, **values}).next_state


def _prediction(
    s: Symbols, structure: ObserverStructure, manipulated: Sequence[Signal]
) -> Equations:
    goes_on, estimated = is_time_step(s["time_step"]), structure.estimated
    corrected = [s[path(x, "corrected")] for x in estimated]
    moves = [s[path(u, "move")] for u in manipulated]
    following = {}
    for j, (x, before) in enumerate(zip(estimated, corrected, strict=True)):
        value = _row(s, "transition", x, structure.transition[j], estimated, corrected)
        value = value + _row(s, "input_effect", x, structure.moved[j], manipulated, moves)
        usable = ca.logic_and(goes_on, ca.logic_and(is_number(value), is_number(before)))
        name = path(x, "estimate")
        following[name] = ca.if_else(usable, value, s[name])
    return Equations(following, {})


def _parts(part: str, signals: Sequence[Signal], when: str) -> list[Signal]:
    return [
        Signal(path(signal, part), signal.unit, description=f"{signal.name}, {when}")
        for signal in signals
    ]


def observer_values(
    structure: ObserverStructure,
    measured: Sequence[Signal],
    manipulated: Sequence[Signal],
    *matrices: np.ndarray,
) -> dict[str, float]:
    """Return the values of the parameters from the matrices Φ, Γ, C and M.

    Examples
    --------
    >>> one, level = np.eye(1), Signal("tank.level")
    >>> structure = ObserverStructure((level,), *(one != 0.0 for _ in range(4)))
    >>> found = observer_values(
    ...     structure, [Signal("level")], [Signal("pump")], 0.9 * one, one, one, 0.5 * one)
    >>> found["tank.level.transition.tank.level"]
    0.9
    """
    used = (structure.transition, structure.moved, structure.shown, structure.corrected)
    numbers = [
        float(matrix[j, k])
        for where, matrix in zip(used, matrices, strict=True)
        for j, k in np.argwhere(where)
    ]
    parameters = observer_parameters(structure, measured, manipulated)
    return {p.name: number for p, number in zip(parameters, numbers, strict=True)}


def _numbers(
    matrix: str, used: np.ndarray, rows: Sequence[Signal], columns: Sequence[Signal], when: str
) -> list[Signal]:
    return [
        signals.number_of(matrix, to, by, f"what {by.name} {when} does to {to.name}", digits=9)
        for to, by in ((rows[j], columns[k]) for j, k in np.argwhere(used))
    ]


def _row(
    symbols: Symbols,
    matrix: str,
    to: Signal,
    used: np.ndarray,
    by: Sequence[Signal],
    values: Sequence[ca.SX],
) -> ca.SX:
    """Return the sum of the numbers of one row of a matrix times the values."""
    total = ca.SX(0)
    for place, column in enumerate(np.flatnonzero(used).tolist()):
        product = symbols[effect(to, matrix, by[column])] * values[column]
        total = total + product if place else product
    return total
