"""The observer that runs the equations of a process, with the gain of a Kalman filter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.observers.observer import ModelObserver
from clepsydra.designs.kalman import kalman_gain, process_noise
from clepsydra.designs.states.observed_process import observed_process
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.process_equations import ProcessEquations


class FoundModelObserver(NamedTuple):
    """An observer and the numbers of its correction M [N, p]."""

    observer: ModelObserver
    correction: np.ndarray


def model_observer(
    model: LinearModel,
    equations: ProcessEquations,
    measurements: Sequence[str] | None,
    horizon: float,
) -> FoundModelObserver:
    """Return an observer of the states that act on the outputs.

    Parameters
    ----------
    equations : ProcessEquations
        Of the model.
    measurements : sequence of str or None
        As for `designs.states.observed_process.observed_process`.
    horizon : float
        About the time that a response takes [s].

    Raises
    ------
    InputError
        A measurement is unknown or named twice, or a controlled output is not among them.
    NotApplicable
        The measurements do not show a state that does not come to rest by itself.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> model = cl.load("quadruple-tank").linear
    >>> found = model_observer(model, process_equations(model), ["level_1", "level_2"], 30.0)
    >>> found.correction.shape
    (4, 2)
    """
    observed = observed_process(model, measurements)
    noise = process_noise(observed, horizon)
    correction = kalman_gain(observed.held, observed.shown, noise).gain
    # States that act on them away from the operating point only run along uncorrected.
    names = equations.acting_on([signal.name for signal in observed.estimated])
    uncorrected = np.zeros((len(names) - len(correction), correction.shape[1]))
    correction = np.vstack([correction, uncorrected])
    observer = ModelObserver(equations.of_states(names), observed.measurements, correction != 0.0)
    return FoundModelObserver(observer, correction)


def note_on_observer(observer: ModelObserver) -> str:
    """Return what the reader has to know of an observer.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> model = cl.load("three-tanks").linear
    >>> found = model_observer(model, process_equations(model), ["level_3"], 30.0)
    >>> note_on_observer(found.observer).partition("; ")[2]
    'its gain holds for a sampling period of 1 s and no other.'
    """
    names, process = ", ".join(observer.states), observer.equations.point.process
    return (
        f"An observer runs the equations of the process for {names}; its gain holds for a sampling "
        f"period of {process.sampling_period:g} s and no other."
    )
