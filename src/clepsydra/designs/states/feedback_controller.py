"""State feedback with its precompensator, from measurements or from an estimate."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.measured_states import (
    all_states_are_measured,
    measurements_of_states,
    without_idle_states,
)
from clepsydra.designs.states.observed_process import ObservedProcess, observed_process
from clepsydra.designs.states.state_controllers import state_feedback_controller
from clepsydra.linear.linear_model import LinearModel

_NOTE_ON_OFFSET = (
    "It has no integral action: a load or an error of the model leaves an offset that stays."
)
_NOTE_ON_LOADS = (
    "The observer estimates a constant load at each input, which is taken off the input: a load "
    "leaves no offset."
)


def states_to_feed_back(
    model: LinearModel, measurements: Sequence[str] | None
) -> tuple[ObservedProcess, bool]:
    """Return the process by its relevant states, and whether sensors show them all.

    Parameters
    ----------
    measurements : sequence of str or None
        Naming them asks for an observer.

    Raises
    ------
    InputError
        A measurement is unknown or named twice, or a controlled output is not among them.
    NotApplicable
        A controlled output shows a state that another sensor shows, or dead times leave no
        sampled model of a moderate size.

    Examples
    --------
    >>> import clepsydra as cl
    >>> observed, measured = states_to_feed_back(cl.load("three-tanks").linear, None)
    >>> observed.measurements, measured
    (('level_1', 'level_2', 'level_3'), True)
    """
    relevant = without_idle_states(model)
    if measurements is None and all_states_are_measured(relevant):
        return observed_process(model, measurements_of_states(relevant)), True
    return observed_process(model, measurements), False


def feedback_controller(
    name: str,
    observed: ObservedProcess,
    feedback: np.ndarray,
    moves: np.ndarray,
    fading_time: float,
    estimation: Estimation | None,
) -> Controller:
    """Return the controller u = u° − F x + N (r − r°).

    Parameters
    ----------
    observed : ObservedProcess
        Without an estimation its measurements show every state.
    feedback : ndarray [m, N]
        F of the states.
    moves : ndarray [m]
        Largest acceptable moves, by which inputs share what one output needs.
    fading_time : float
        [s]
    estimation : Estimation or None
        Of the states and of a load at each input.

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently, or a number is outside of what a controller
        takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> seen = observed_process(cl.load("equalisation-tank").linear, None)
    >>> gain = np.array([[-0.5]])  # a higher level asks for more outflow
    >>> controller = feedback_controller("by hand", seen, gain, np.ones(1), 60.0, None)
    >>> found = controller.values
    >>> round(found["outflow.precompensator.level"], 9) == found["outflow.feedback.level"]
    True
    """
    model = observed.model
    ahead = precompensator(
        observed.held, observed.moved, observed.shown[observed.controlled], feedback, moves
    )
    if estimation is None:
        # The law sees measurements: F x = (F C⁻¹) y where y = C x.
        feedback = np.linalg.solve(observed.shown.T, feedback.T).T
        note = _NOTE_ON_OFFSET
    else:
        feedback = np.hstack([feedback, np.eye(len(feedback))])
        note = _NOTE_ON_LOADS
    controller = state_feedback_controller(
        name,
        model,
        observed.measurements,
        feedback,
        ahead,
        max(fading_time, observed.period),
        estimation,
    )
    return controller.described(controller.design, [note])


_SINGULAR = 1e-10


def precompensator(
    held: np.ndarray,
    moved: np.ndarray,
    controlled: np.ndarray,
    feedback: np.ndarray,
    moves: np.ndarray,
) -> np.ndarray:
    """Return N of u = −F x + N r with which y = r at rest.

    H = C (I − Φ + Γ F)⁻¹ Γ is the static gain of the loop from N r, so N = H⁻¹. With more
    inputs than outputs N is the smallest of those with H N = I, each input counted in its
    largest acceptable move.

    Parameters
    ----------
    held, moved, controlled : ndarray [N, N], [N, m], [q, N]
        Φ, Γ and C.
    feedback : ndarray [m, N]
        F, stabilising.
    moves : ndarray [m]
        Largest acceptable moves [input unit].

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently.

    Examples
    --------
    x⁺ = 0.5 x + u, y = 2 x and F = 0.25: at rest y = 2 N r / 0.75.

    >>> one = np.eye(1)
    >>> float(precompensator(0.5 * one, one, 2 * one, 0.25 * one, np.ones(1))[0, 0])
    0.375
    """
    closed = np.eye(len(held)) - held + moved @ feedback
    gain = (controlled @ np.linalg.solve(closed, moved)) * moves
    lengths = np.linalg.norm(gain, axis=1, keepdims=True)
    if not np.all(lengths > 0.0) or len(moves) < len(gain):
        raise NotApplicable("an output does not follow any input")
    if np.linalg.svd(gain / lengths, compute_uv=False)[-1] < _SINGULAR:
        raise NotApplicable(
            "the outputs cannot be held independently: there is a zero at the origin"
        )
    inverse: np.ndarray = moves[:, None] * np.linalg.pinv(gain / lengths) / lengths.T
    return inverse
