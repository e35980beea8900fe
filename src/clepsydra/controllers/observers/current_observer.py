"""The current observer: an estimate that uses the measurement of the same sample."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.controllers.observers.structure import ObserverStructure
from clepsydra.program.step_law import Symbols


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
        *_numbers("transition", structure.transition, estimated, estimated, "a sample before"),
        *_numbers("input_effect", structure.moved, estimated, manipulated, "held for a sample"),
        *_numbers("observation", structure.shown, measured, estimated, "at once"),
        *_numbers("correction", structure.corrected, estimated, measured, "not as estimated"),
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


def surprises(
    symbols: Symbols,
    structure: ObserverStructure,
    deviations: Sequence[ca.SX],
    measurements_known: ca.SX,
) -> list[ca.SX]:
    """Return y − C x̂: what the measurements of this sample show that was not expected.

    Where a measurement is unusable there is none, and the observer goes on with what the
    inputs do.

    Parameters
    ----------
    symbols : mapping
        estimate_j, observation_j_k.
    structure : ObserverStructure
    deviations : sequence of casadi.SX
        y, each measurement less its value at the operating point.
    measurements_known : casadi.SX
        Whether all are numbers from sound sensors.

    Examples
    --------
    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> numbers = dict(estimate_1=ca.DM(2), observation_1_1=ca.DM(50))
    >>> float(surprises(numbers, structure, [ca.DM(110)], ca.DM(1))[0])
    10.0
    """
    expected = [symbols[f"estimate_{j}"] for j in range(1, structure.size + 1)]
    return [
        ca.if_else(
            measurements_known,
            deviation - _row(symbols, "observation", structure.shown, j, expected),
            0,
        )
        for j, deviation in enumerate(deviations)
    ]


def corrected_estimate(
    symbols: Symbols, structure: ObserverStructure, surprise: Sequence[ca.SX]
) -> list[ca.SX]:
    """Return x̂ + M (y − C x̂): the estimate with the measurement of this sample.

    Parameters
    ----------
    symbols : mapping
        estimate_j, correction_j_k.
    structure : ObserverStructure
    surprise : sequence of casadi.SX
        y − C x̂

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, chapter 4.

    Examples
    --------
    2 m were expected, 0.5 m more are measured, and half of that is believed:

    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> numbers = dict(estimate_1=ca.DM(2), correction_1_1=ca.DM(0.5))
    >>> float(corrected_estimate(numbers, structure, [ca.DM(0.5)])[0])
    2.25
    """
    return [
        symbols[f"estimate_{j + 1}"] + _row(symbols, "correction", structure.corrected, j, surprise)
        for j in range(structure.size)
    ]


def expected_next(
    symbols: Symbols,
    structure: ObserverStructure,
    corrected: Sequence[ca.SX],
    moves: Sequence[ca.SX],
) -> dict[str, ca.SX]:
    """Return estimate_j of the next sample: Φ x̂ + Γ (u − u°).

    u is what was really given out, after mode, limits and hold, so that neither an operator's
    hand nor saturation misleads the observer. Φ and Γ are those of one sampling period. In a
    sample whose time step is unusable, or where numbers run over, the estimate stays.

    Parameters
    ----------
    symbols : mapping
        estimate_j, transition_j_k, input_effect_j_i, time_step.
    structure : ObserverStructure
    corrected : sequence of casadi.SX
        The corrected estimate.
    moves : sequence of casadi.SX
        u − u°, each input less its value at the operating point.

    Examples
    --------
    >>> yes = np.ones((1, 1), bool)
    >>> structure = ObserverStructure((Signal("tank.level", "m"),), yes, yes, yes, yes)
    >>> numbers = dict(estimate_1=ca.SX(2), transition_1_1=ca.SX(0.5), input_effect_1_1=ca.SX(3),
    ...                time_step=ca.SX(1))
    >>> float(ca.evalf(expected_next(numbers, structure, [ca.SX(4)], [ca.SX(0.1)])["estimate_1"]))
    2.3
    """
    goes_on = is_time_step(symbols["time_step"])
    following = {}
    for j, before in enumerate(corrected):
        value = _row(symbols, "transition", structure.transition, j, corrected)
        value = value + _row(symbols, "input_effect", structure.moved, j, moves)
        kept = symbols[f"estimate_{j + 1}"]
        usable = ca.logic_and(goes_on, ca.logic_and(is_number(value), is_number(before)))
        following[f"estimate_{j + 1}"] = ca.if_else(usable, value, kept)
    return following


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
