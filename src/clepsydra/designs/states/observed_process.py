"""A process as an observer sees it: sampled, with what is measured and what must be estimated."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.observers.linear_state import MOST_ESTIMATES
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.sampled.sampled_process import sampled_process, sampled_states
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.designs.states.measured_states import (
    all_states_are_measured,
    with_outputs,
    without_idle_states,
)
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

#: An effect this small, as a share of the ranges within a sample, is rounding.
_NOTHING = 1e-14


@dataclass(frozen=True, eq=False)
class ObservedProcess:
    """x(k+1) = Φ x + Γ u, y = C x in deviations from the operating point.

    Parameters
    ----------
    model : LinearModel
        Continuous, with the relevant states and the controlled outputs.
    period : float
        [s]
    measurements : tuple of str [p]
        What corrects the estimate; the controlled outputs are among them.
    estimated : tuple of Signal [N]
        The states; with dead time also what is on its way.
    held, moved, shown : ndarray [N, N], [N, m], [p, N]
        Φ, Γ and C.

    Examples
    --------
    >>> import clepsydra as cl
    >>> seen = observed_process(cl.load("eight-tanks").linear, None)
    >>> len(seen.estimated), seen.measurements, seen.controlled
    (8, ('level_8',), [0])
    """

    model: LinearModel
    period: float
    measurements: tuple[str, ...]
    estimated: tuple[Signal, ...]
    held: np.ndarray
    moved: np.ndarray
    shown: np.ndarray

    @property
    def controlled(self) -> list[int]:
        """For each controlled output the place of its measurement."""
        return [self.measurements.index(name) for name in self.model.outputs]

    @property
    def sizes(self) -> np.ndarray:
        """The ranges of what is estimated, one where they are open."""
        return _sizes(self.estimated)


def observed_process(model: LinearModel, measurements: Sequence[str] | None) -> ObservedProcess:
    """Return the process as an observer of these measurements sees it.

    Parameters
    ----------
    measurements : sequence of str or None
        None for the controlled outputs alone where sensors show every state, since then a
        controller without an observer has use for the others; else for all sensors that show
        a state which acts on the controlled outputs.

    Raises
    ------
    InputError
        A measurement is unknown or named twice, or a controlled output is not among them.
    NotApplicable
        Dead times leave no sampled model of a moderate size.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> observed_process(model, None).measurements
    ('level_1', 'level_2')
    """
    period = check_sampling_period(model)
    signal = operating_point_of(model).process.signal
    chosen = _chosen(model, measurements)
    seen = without_idle_states(with_outputs(model, chosen))
    held, moved, shown = sampled_process(seen, period)
    if len(held) > MOST_ESTIMATES:
        raise NotApplicable(
            f"{len(held)} quantities would have to be estimated, and a law takes at most "
            f"{MOST_ESTIMATES}; with dead time a longer sampling period makes them fewer"
        )
    estimated = tuple(_aged(signal(name), age) for name, age in sampled_states(seen, period))
    sizes, moves = _sizes(estimated), _sizes([signal(name) for name in model.inputs])
    held = _without_rounding(held, sizes, sizes)
    moved = _without_rounding(moved, sizes, moves)
    controlled = seen.select(outputs=model.outputs)
    return ObservedProcess(controlled, period, chosen, estimated, held, moved, shown)


def _chosen(model: LinearModel, measurements: Sequence[str] | None) -> tuple[str, ...]:
    process, relevant = operating_point_of(model).process, without_idle_states(model)
    if measurements is None:
        if all_states_are_measured(relevant):
            return model.outputs
        shown = [name for name, at in process.measured_state.items() if at in relevant.states]
        return (*model.outputs, *(name for name in shown if name not in model.outputs))
    place, known = "measurements", [signal.name for signal in process.measurements]
    listed = isinstance(measurements, (list, tuple))
    if not listed or any(name not in known for name in measurements):
        raise InputError(place, measurements, f"some of {', '.join(known)}", "correct the names")
    if len(set(measurements)) < len(measurements):
        raise InputError(place, list(measurements), "each name once", "name each once")
    missing = [name for name in model.outputs if name not in measurements]
    if missing:
        expected, remedy = "the controlled measurements among them", f"add {', '.join(missing)}"
        raise InputError(place, list(measurements), expected, remedy)
    return tuple(measurements)


def _aged(signal: Signal, age: float) -> Signal:
    """Return the signal, named by how long ago it was."""
    if age == 0.0:
        return signal
    return dataclasses.replace(signal, name=path(signal, re.sub(r"\W+", "_", f"{age:g}_s_before")))


def _without_rounding(matrix: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    share = np.abs(matrix) * columns / rows[:, None]
    return np.where(share > _NOTHING, matrix, 0.0)


def _sizes(signals: Sequence[Signal]) -> np.ndarray:
    """Return the ranges of signals, one where they are open."""
    spans = np.array([signal.span for signal in signals])
    return np.where(np.isfinite(spans) & (spans > 0.0), spans, 1.0)
