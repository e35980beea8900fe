"""The Kalman filter of a sampled process, from its noise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.control_authority import control_authorities
from clepsydra.designs.request import in_shown_unit
from clepsydra.designs.sampled.sampled_cost import sampled_cost
from clepsydra.designs.states.observed_process import ObservedProcess
from clepsydra.designs.states.riccati import optimal_regulator
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process.process import Process

#: Standard deviation of the noise of a sensor where the process gives none, a share of its range.
NOISE_SHARE = 0.005
#: How much of an input's authority it is unsure of.
INPUT_SHARE = 0.1


class KalmanGain(NamedTuple):
    """x̂ + M (y − C x̂), the covariance before it, and the eigenvalues of the estimate's error.

    Parameters
    ----------
    gain : ndarray [N, p]
        M, of the current observer.
    covariance : ndarray [N, N]
        Of what was expected, before the measurement.
    eigenvalues : ndarray [N], complex
        Of (I − M C) Φ.
    """

    gain: np.ndarray
    covariance: np.ndarray
    eigenvalues: np.ndarray


class Noise(NamedTuple):
    """Covariances of what moves a process between samples, and of what disturbs its sensors.

    Parameters
    ----------
    process : ndarray [N, N]
        W of x(k+1) = Φ x + Γ u + w(k).
    measurement : ndarray [p, p]
        V of y(k) = C x + v(k).
    words : str
        Where they come from.
    """

    process: np.ndarray
    measurement: np.ndarray
    words: str


def kalman_gain(held: np.ndarray, shown: np.ndarray, noise: Noise) -> KalmanGain:
    """Return the stationary Kalman gain of a sampled process.

    P = Φ P Φᵀ + W − Φ P Cᵀ (C P Cᵀ + V)⁻¹ C P Φᵀ and M = P Cᵀ (C P Cᵀ + V)⁻¹, the dual of
    the linear-quadratic regulator.

    Parameters
    ----------
    held, shown : ndarray [N, N], [p, N]
        Φ and C.

    Raises
    ------
    NotApplicable
        The measurements do not show a mode that does not decay by itself, or nothing is noisy
        that would keep the filter awake on one.

    References
    ----------
    R. E. Kalman, A new approach to linear filtering and prediction problems, Journal of Basic
    Engineering 82(1), 1960, 35-45, doi 10.1115/1.3662552.

    Examples
    --------
    x⁺ = x + w, y = x + v with W = V = 1: P is 1 + 0.618, M = P/(P + 1).

    >>> one = np.eye(1)
    >>> found = kalman_gain(one, one, Noise(one, one, ""))
    >>> round(float(found.covariance[0, 0]), 6), round(float(found.gain[0, 0]), 6)
    (1.618034, 0.618034)
    """
    W, V = noise.process, noise.measurement
    # In units of the noise, as a Riccati solver likes it.
    deviations = np.sqrt(np.diag(V))
    C = shown / deviations[:, None]
    scaled = V / np.outer(deviations, deviations)
    sizes = _sizes(held, W)
    dual = (held * sizes / sizes[:, None]).T, (C * sizes).T
    none = np.zeros((len(held), len(shown)))
    try:
        found = optimal_regulator(*dual, W / np.outer(sizes, sizes), none, scaled)
    except NotApplicable as refusal:
        raise NotApplicable(
            "the measurements do not show a state that does not come to rest by itself, or no "
            "noise moves it; measure more"
        ) from refusal
    P = sizes[:, None] * found.cost * sizes
    # The dual regulator's gain is that of Φ P Cᵀ (…)⁻¹; the current observer takes no Φ.
    innovation = C @ P @ C.T + scaled
    gain = np.linalg.solve(innovation, C @ P).T / deviations
    return KalmanGain(gain, P, found.eigenvalues)


def process_noise(observed: ObservedProcess, horizon: float) -> Noise:
    """Return the noise of a process from its load steps, its inputs and its sensors.

    A load of which the process gives a typical step d̄ is white noise that, summed up over the
    horizon T, moves as far as such a step that lasts so long: its intensity is d̄² T. So is each
    input, by a tenth of its authority (the distance to the nearer limit): no pump gives what it
    is told, and an observer that trusts its model less makes the loop more robust (Doyle and
    Stein). A sensor has the noise that the process gives, or half a percent of its range.

    Parameters
    ----------
    horizon : float
        T, about the time that a response takes [s].

    References
    ----------
    J. C. Doyle and G. Stein, Robustness with observers, IEEE Transactions on Automatic Control,
    1979.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.observed_process import observed_process
    >>> seen = observed_process(cl.load("quadruple-tank").linear, None)
    >>> noise = process_noise(seen, 30.0)
    >>> [round(float(value), 6) for value in np.sqrt(np.diag(noise.measurement))]  # of 10 V
    [0.05, 0.05]
    """
    model, period = observed.model, observed.period
    process = operating_point_of(model).process
    steps = load_steps(model)
    loads = np.array([steps.get(name, 0.0) for name in model.disturbances])
    variances = input_variances(observed)
    n, N = len(model.states), len(observed.held)
    W = np.zeros((N, N))
    by_loads = model.E @ np.diag(loads**2 * horizon) @ model.E.T
    if model.delays is None:
        by_inputs = model.B @ np.diag(variances * horizon) @ model.B.T
        W[:n, :n] = _accumulated(model.A, by_loads + by_inputs, period)
    else:
        # Noise of an input is held over a sample like the input, so that it is on its way too.
        W[:n, :n] = _accumulated(model.A, by_loads, period)
        W += observed.moved @ np.diag(variances * horizon / period) @ observed.moved.T
    deviations = sensor_noise(process, observed.measurements)
    words = ", ".join(
        f"{name} {in_shown_unit(process.signal(name), value)}"
        for name, value in zip(observed.measurements, deviations, strict=True)
    )
    return Noise(W, np.diag(deviations**2), f"sensor noise {words}")


def with_wandering(noise: Noise, variances: np.ndarray, period: float, horizon: float) -> Noise:
    """Return the noise of a process with integrators behind its states, which wander.

    Parameters
    ----------
    variances : ndarray [d]
        Of how far each has wandered after the horizon.
    period, horizon : float
        [s]

    Examples
    --------
    >>> one = np.eye(1)
    >>> with_wandering(Noise(one, one, ""), np.array([4.0]), 1.0, 8.0).process.diagonal()
    array([1. , 0.5])
    """
    n, d = len(noise.process), len(variances)
    W = np.zeros((n + d, n + d))
    W[:n, :n] = noise.process
    W[n:, n:] = np.diag(variances * period / horizon)
    return noise._replace(process=W)


def sensor_noise(process: Process, measurements: Sequence[str]) -> np.ndarray:
    """Return the standard deviations of the noise of sensors [their units].

    Raises
    ------
    NotApplicable
        One has neither noise nor a finite range.

    Examples
    --------
    >>> import clepsydra as cl
    >>> sensor_noise(cl.load("quadruple-tank").process, ["level_1"]).round(6)  # [V]
    array([0.05])
    """
    found = np.array(
        [process.noise.get(name, NOISE_SHARE * process.signal(name).span) for name in measurements]
    )
    sound = np.isfinite(found) & (found > 0.0)
    if not np.all(sound):
        name = measurements[int(np.argmin(sound))]
        raise NotApplicable(f"{name} has neither noise nor a finite range; give it one")
    return found


def load_steps(model: LinearModel) -> dict[str, float]:
    """Return the largest typical step of those disturbances of a model that have one.

    Examples
    --------
    >>> import clepsydra as cl
    >>> load_steps(cl.load("three-tanks").linear)  # [m³/s]
    {'inflow_3': 1e-05}
    """
    return {
        name: max(sizes, key=abs)
        for element in operating_point_of(model).process.elements
        for name, sizes in element.load_steps().items()
        if name in model.disturbances
    }


def input_variances(observed: ObservedProcess) -> np.ndarray:
    """Return how unsure each input is of itself: the square of a tenth of its authority.

    Examples
    --------
    The pumps of the quadruple tank stand at 3 V of 10 V:

    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.observed_process import observed_process
    >>> seen = observed_process(cl.load("quadruple-tank").linear, None)
    >>> input_variances(seen).round(9)
    array([0.09, 0.09])
    """
    model = observed.model
    authorities = control_authorities(operating_point_of(model), model.inputs)
    return np.square(INPUT_SHARE * authorities)


def _accumulated(A: np.ndarray, intensity: np.ndarray, period: float) -> np.ndarray:
    """Return ∫ e^(A t) S e^(Aᵀ t) dt over a period."""
    return sampled_cost(A.T, np.zeros((len(A), 1)), intensity, np.zeros((1, 1)), period).Q


def _sizes(held: np.ndarray, W: np.ndarray) -> np.ndarray:
    """Return by how much the noise moves each state within a few samples, never zero."""
    moved = np.abs(held) @ np.sqrt(np.diag(W)) + np.sqrt(np.diag(W))
    smallest = 1e-6 * float(moved.max(initial=0.0))
    return np.where(moved > smallest, moved, max(smallest, np.finfo(float).tiny ** 0.25))
