"""The current observer: an estimate that uses the measurement of the same sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
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
    """Return transition_j_k, input_effect_j_i, observation_j_k and correction_j_k.

    Examples
    --------
    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> for parameter in observer_parameters(structure, [Signal("level", "V")], [Signal("pump")]):
    ...     print(parameter.name, parameter.unit)
    transition_1_1 m/m
    input_effect_1_1 m
    observation_1_1 V/m
    correction_1_1 m/V
    """
    estimated = structure.estimated
    return [
        *_numbers("transition", structure.transition, estimated, estimated, _BEFORE),
        *_numbers("input_effect", structure.moved, estimated, manipulated, _HELD),
        *_numbers("observation", structure.shown, measured, estimated, "at once"),
        *_numbers("correction", structure.corrected, estimated, measured, _BESIDE),
    ]


def observer_state(structure: ObserverStructure) -> list[Signal]:
    """Return estimate_j, the deviation from the operating point expected in the next sample.

    Examples
    --------
    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> [(state.name, state.unit) for state in observer_state(structure)]
    [('estimate_1', 'm')]
    """
    return [
        Signal(
            f"estimate_{j}",
            signal.unit,
            description=f"expected deviation of {signal.name} from the operating point",
        )
        for j, signal in enumerate(structure.estimated, start=1)
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
        estimate_j, observation_j_k, correction_j_k.
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
    >>> numbers = dict(estimate_1=ca.DM(2), observation_1_1=ca.DM(1), correction_1_1=ca.DM(0.5))
    >>> found = corrected(numbers, structure, [Signal("level", "m")], [ca.DM(2.5)], ca.DM(1))
    >>> float(found[0][0]), float(found[1][0])
    (2.25, 0.5)
    """
    shown = _counted("deviation", measured, "less its value at the operating point")
    estimates = _counted("corrected", structure.estimated, "with the measurements of the sample")
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
        (*estimates, *_counted("surprise", measured, "less what was expected")),
        lambda s: _correction(s, structure, [s[signal.name] for signal in shown]),
        ("The estimate with the measurements: x + M (y - C x).",),
    )
    values = {signal.name: value for signal, value in zip(shown, deviations, strict=True)}
    given = {**symbols, **values, "known": measurements_known}
    found = list(called(block, "observer_correction", given).outputs.values())
    return found[: structure.size], found[structure.size :]


def _correction(s: Symbols, structure: ObserverStructure, deviations: Sequence[ca.SX]) -> Equations:
    expected = [s[f"estimate_{j}"] for j in range(1, structure.size + 1)]
    surprise = [
        ca.if_else(s["known"], value - _row(s, "observation", structure.shown, j, expected), 0)
        for j, value in enumerate(deviations)
    ]
    found = {
        f"corrected_{j + 1}": value + _row(s, "correction", structure.corrected, j, surprise)
        for j, value in enumerate(expected)
    }
    return Equations({}, found | {f"surprise_{j}": e for j, e in enumerate(surprise, start=1)})


def predicted(
    symbols: Symbols,
    structure: ObserverStructure,
    manipulated: Sequence[Signal],
    estimate: Sequence[ca.SX],
    moves: Sequence[ca.SX],
) -> Mapping[str, ca.SX]:
    """Return estimate_j of the next sample: Φ x̂ + Γ (u − u°).

    u is what was really given out, after mode, limits and hold, so that neither an operator's
    hand nor saturation misleads the observer. Φ and Γ are those of one sampling period. In a
    sample whose time step is unusable, or where numbers run over, the estimate stays. It is the
    block observer_prediction.

    Parameters
    ----------
    symbols : mapping
        estimate_j, transition_j_k, input_effect_j_i, time_step.
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
    >>> numbers = dict(estimate_1=ca.SX(2), transition_1_1=ca.SX(0.5), input_effect_1_1=ca.SX(3),
    ...                time_step=ca.SX(1))
    >>> found = predicted(numbers, structure, [Signal("pump", "V")], [ca.SX(4)], [ca.SX(0.1)])
    >>> float(ca.evalf(found["estimate_1"]))
    2.3
    """
    estimated = structure.estimated
    before = _counted("corrected", estimated, "with the measurements of the sample")
    moved = _counted("move", manipulated, "less its value at the operating point")
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
        lambda s: _prediction(s, structure, *([s[p.name] for p in ps] for ps in (before, moved))),
        ("The estimate of the next sample: Phi x + Gamma (u - u0), u as it was applied.",),
    )
    ports = [*before, *moved]
    values = {signal.name: v for signal, v in zip(ports, [*estimate, *moves], strict=True)}
    return called(block, "observer_prediction", {**symbols, **values}).next_state


def _prediction(
    s: Symbols,
    structure: ObserverStructure,
    corrected: Sequence[ca.SX],
    moves: Sequence[ca.SX],
) -> Equations:
    goes_on = is_time_step(s["time_step"])
    following = {}
    for j, before in enumerate(corrected):
        value = _row(s, "transition", structure.transition, j, corrected)
        value = value + _row(s, "input_effect", structure.moved, j, moves)
        usable = ca.logic_and(goes_on, ca.logic_and(is_number(value), is_number(before)))
        following[f"estimate_{j + 1}"] = ca.if_else(usable, value, s[f"estimate_{j + 1}"])
    return Equations(following, {})


def _counted(name: str, signals: Sequence[Signal], when: str) -> list[Signal]:
    return [
        Signal(f"{name}_{j}", signal.unit, description=f"{signal.name}, {when}")
        for j, signal in enumerate(signals, start=1)
    ]


def observer_values(
    structure: ObserverStructure,
    transition: np.ndarray,
    moved: np.ndarray,
    shown: np.ndarray,
    correction: np.ndarray,
) -> dict[str, float]:
    """Return the values of the parameters from the matrices Φ, Γ, C and M.

    Examples
    --------
    >>> one = np.eye(1)
    >>> structure = ObserverStructure((Signal("tank.level"),), *(one != 0.0 for _ in range(4)))
    >>> observer_values(structure, 0.9 * one, one, one, 0.5 * one)["transition_1_1"]
    0.9
    """
    matrices = {
        "transition": (structure.transition, transition),
        "input_effect": (structure.moved, moved),
        "observation": (structure.shown, shown),
        "correction": (structure.corrected, correction),
    }
    return {
        f"{name}_{j + 1}_{k + 1}": float(matrix[j, k])
        for name, (used, matrix) in matrices.items()
        for j, k in np.argwhere(used)
    }


def _numbers(
    name: str, used: np.ndarray, rows: Sequence[Signal], columns: Sequence[Signal], when: str
) -> list[Signal]:
    return [
        signals.coefficient(
            f"{name}_{j + 1}_{k + 1}",
            signals.ratio_of_units(rows[j].unit, columns[k].unit),
            f"what {columns[k].name} {when} does to {rows[j].name}",
        )
        for j, k in np.argwhere(used)
    ]


def _row(symbols: Symbols, name: str, used: np.ndarray, row: int, values: Sequence[ca.SX]) -> ca.SX:
    """Return the sum of the numbers of one row of a matrix times the values."""
    total = ca.SX(0)
    for place, column in enumerate(np.flatnonzero(used[row]).tolist()):
        product = symbols[f"{name}_{row + 1}_{column + 1}"] * values[column]
        total = total + product if place else product
    return total
