"""An observer's matrices, its quantities and how good it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.observers.linear_state import ObserverStructure
from clepsydra.designs.states.observed_process import ObservedProcess
from clepsydra.linear.linearise import operating_point_of


class Estimation(NamedTuple):
    """A current observer: x̂ + M (y − C x̂) now, Φ x̂ + Γ u for the next sample.

    Parameters
    ----------
    estimated : tuple of Signal [N]
    held, moved, shown, correction : ndarray [N, N], [N, m], [p, N], [N, p]
        Φ, Γ, C and M.

    Examples
    --------
    >>> one = np.eye(1)
    >>> found = Estimation((Signal("tank.level", "m"),), 0.9 * one, one, one, 0.5 * one)
    >>> found.error_poles
    array([0.45])
    """

    estimated: tuple[Signal, ...]
    held: np.ndarray
    moved: np.ndarray
    shown: np.ndarray
    correction: np.ndarray

    @property
    def error_poles(self) -> np.ndarray:
        """Eigenvalues of (I − M C) Φ, with which the error of the estimate dies away."""
        poles: np.ndarray = np.linalg.eigvals(self.held - self.correction @ self.shown @ self.held)
        return poles

    def structure(self) -> ObserverStructure:
        """Return where the matrices have numbers."""
        _, *matrices = self
        return ObserverStructure(self.estimated, *(matrix != 0.0 for matrix in matrices))

    def numbers(self) -> dict[str, np.ndarray]:
        """Return the numbers of the law's matrices, where they have any."""
        names, (_, *matrices) = ("transition", "input_effect", "observation", "correction"), self
        return {n: matrix[matrix != 0.0] for n, matrix in zip(names, matrices, strict=True)}

    @property
    def names(self) -> str:
        """What is estimated, for a reader."""
        return ", ".join(signal.name for signal in self.estimated)

    @classmethod
    def of(cls, process: ObservedProcess, correction: np.ndarray) -> Estimation:
        """Return the observer of a process with this M."""
        return cls(process.estimated, process.held, process.moved, process.shown, correction)


def with_loads(observed: ObservedProcess) -> ObservedProcess:
    """Return the process with a constant load at each input as a further state.

    x(k+1) = Φ x + Γ (u + d), d(k+1) = d. An observer that estimates d has no bias under a
    constant load, wherever it enters, and a feedback that takes d̂ off the input leaves no
    offset.

    References
    ----------
    G. Pannocchia and J. B. Rawlings, Disturbance models for offset-free model-predictive
    control, AIChE Journal 49(2), 2003, 426-437, doi 10.1002/aic.690490213.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.observed_process import observed_process
    >>> seen = observed_process(cl.load("wet-well").linear, None)
    >>> [signal.name for signal in with_loads(seen).estimated]
    ['well.level', 'duty.actual', 'duty.load']
    """
    process = operating_point_of(observed.model).process
    inputs = map(process.signal, observed.model.inputs)
    return with_integrators(observed, [as_load(signal) for signal in inputs], observed.moved)


def as_load(signal: Signal) -> Signal:
    """Return the constant load on what a signal moves, in its unit.

    Examples
    --------
    >>> as_load(Signal("pump", "V")).name
    'pump.load'
    """
    return replace(signal, name=path(signal, "load"))


def with_integrators(
    observed: ObservedProcess, signals: Sequence[Signal], moves: np.ndarray
) -> ObservedProcess:
    """Return the process with further states that stay as they are: d(k+1) = d.

    Parameters
    ----------
    signals : sequence of Signal [d]
        What they are.
    moves : ndarray [N, d]
        What each does to the process in a sample.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.observed_process import observed_process
    >>> seen = observed_process(cl.load("equalisation-tank").linear, None)
    >>> with_integrators(seen, [Signal("rain")], np.ones((1, 1))).held[:, -1]
    array([1., 1.])
    """
    (N, m), d = observed.moved.shape, len(signals)
    return replace(
        observed,
        estimated=(*observed.estimated, *signals),
        held=np.block([[observed.held, moves], [np.zeros((d, N)), np.eye(d)]]),
        moved=np.vstack([observed.moved, np.zeros((d, m))]),
        shown=np.hstack([observed.shown, np.zeros((len(observed.shown), d))]),
    )


def input_noise(estimation: Estimation, feedback: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Return the standard deviation of the inputs that the noise of the sensors makes.

    Parameters
    ----------
    estimation : Estimation
        States that the inputs do not move are left to the observer.
    feedback : ndarray [m, N]
        F of u = −F x̂.
    noise : ndarray [p, p]
        Covariance of the sensors' noise, white from sample to sample.

    Returns
    -------
    ndarray [m]
        [input unit]

    Examples
    --------
    x⁺ = x + u with u = −0.5 (x + v): the variance of x is 1/3 and that of u (1/3 + 1)/4.

    >>> one = np.eye(1)
    >>> whole = Estimation((Signal("tank.level", "m"),), one, one, one, one)
    >>> round(float(input_noise(whole, 0.5 * one, one)[0] ** 2), 6)
    0.333333
    """
    from scipy.linalg import block_diag, solve_discrete_lyapunov

    _, held, moved, shown, correction = estimation
    N = len(held)
    # Of the states x and the error e = x − x̂: x̂ + M (C (x − x̂) + v) = x − (I − M C) e + M v.
    kept = np.eye(N) - correction @ shown
    u_of_state, u_of_noise = np.hstack([-feedback, feedback @ kept]), -feedback @ correction
    A = block_diag(held, held @ kept)
    A[:N] += moved @ u_of_state
    B = np.vstack([moved @ u_of_noise, -held @ correction])
    free = np.any(moved != 0.0, axis=1) | np.any(np.abs(held - np.eye(N)) > 0.0, axis=1)
    kept_rows = np.concatenate([free, np.ones(N, bool)])
    # A constant load of the process itself is no part of the noise: it stands at zero.
    A, B = A[np.ix_(kept_rows, kept_rows)], B[kept_rows]
    u_of_state = u_of_state[:, kept_rows]
    P = solve_discrete_lyapunov(A, B @ noise @ B.T)
    variances = u_of_state @ P @ u_of_state.T + u_of_noise @ noise @ u_of_noise.T
    deviations: np.ndarray = np.sqrt(np.maximum(np.diag(variances), 0.0))
    return deviations
