"""Fit of a transfer function with dead time by its output error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.identification.structures import Responses, Structure

#: A longer record is averaged over blocks to about so many samples first.
_SAMPLES = 1000
_LAGS, _DELAYS = 9, 32
#: The second lag as shares of the first.
_SECOND = (0.1, 0.5)
_STARTS = 3
#: Lags are sought from this share of the sampling period to so many times the record.
_SHORTEST, _LONGEST = 0.2, 10.0
#: Dead times are sought up to this share of the record.
LATEST = 0.5
#: Lags that differ by less than this share are one.
_EQUAL = 0.02
_FEW, _TOLERANCE = 8, 1e-9
_EPSILON = float(np.finfo(float).eps)
#: The square of this step is nothing, so that a slope is exact to rounding.
_IMAGINARY = 1e-20j


def held_response(signal: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Return the response [N] to an input [N] of any system that is given by its step response.

    With u held from sample to sample, y(kT) = Σ Δu(j) S(kT − jT − θ): a convolution of the
    changes of u with the step response S [N], read off between the samples where the dead time θ
    is no multiple of T. Nothing is approximated. Before the record u stood at its first value.
    """
    from scipy.signal import fftconvolve

    changes = np.diff(signal, prepend=signal[:1])
    return np.asarray(fftconvolve(changes, step)[: len(signal)])


def fit_starts(
    structure: Structure,
    signal: np.ndarray,
    output: np.ndarray,
    period: float,
    low: np.ndarray,
    high: np.ndarray,
) -> list[np.ndarray]:
    """Return starts for a search over ln lags and θ/T between bounds, the most promising first.

    The error is computed on a grid of lags and dead times; the starts are the lowest places that
    are lower than their neighbours in dead time.
    """
    block = max(1, len(signal) // _SAMPLES)
    count = len(signal) // block
    coarse = block * period
    u, y = (each[: count * block].reshape(count, block).mean(axis=1) for each in (signal, output))
    time = coarse * np.arange(count)
    delays = _delays(high[-1] / block, count)
    # The grid's dead times are whole samples: a late response is the prompt one, shifted.
    before = np.arange(count)[:, None] - delays
    found: list[tuple[float, int, np.ndarray]] = []
    for number, lags in enumerate(_lag_sets(structure, low, high)):
        responses = structure.responses(time, time, lags)
        prompt = held_response(u, responses.step)
        free, _ = np.linalg.qr(responses.free)
        forced = np.where(before >= 0, prompt[before], 0.0)
        forced -= free @ (free.T @ forced)
        left = y - free @ (free.T @ y)
        sizes = np.maximum(np.sum(forced**2, axis=0), 1e-300)
        costs = left @ left - (left @ forced) ** 2 / sizes
        bounded = np.concatenate(([np.inf], costs, [np.inf]))
        valleys = np.flatnonzero((costs <= bounded[:-2]) & (costs <= bounded[2:]))
        for at in valleys.tolist():
            start = np.append(np.log(lags), delays[at] * block)
            found.append((float(costs[at]), number, start))
    found.sort(key=lambda each: each[:2])
    starts: list[np.ndarray] = []
    for _, _, start in found:
        near = [abs(start[-1] - other[-1]) <= 0.1 * max(start[-1], 2.0) for other in starts]
        if not any(near):
            starts.append(start)
        if len(starts) == _STARTS:
            break
    return starts


def _lag_sets(structure: Structure, low: np.ndarray, high: np.ndarray) -> list[np.ndarray]:
    if structure.lags == 0:
        return [np.zeros(0)]
    # A lag beyond the record integrates, one below the sampling period answers at once.
    first = np.exp(np.linspace(low[0] + np.log(5.0), high[0] - np.log(5.0), _LAGS))
    if structure.lags == 1:
        return [np.array([lag]) for lag in first]
    return [np.array([lag, share * lag]) for lag in first for share in _SECOND]


def _delays(latest: float, count: int) -> np.ndarray:
    """Return dead times [samples], close where they are short, and evenly spread over the rest."""
    short = np.arange(_DELAYS // 2)
    spread = np.linspace(0.0, latest, min(_DELAYS, count // 2))
    grown = np.geomspace(1.0, max(latest, 1.0), _DELAYS // 2)
    every = np.concatenate([short, spread, grown])
    return np.unique(np.rint(every[every <= latest])).astype(int)


@dataclass(frozen=True, eq=False)
class OutputErrorFit:
    """The model y = K G(θ, lags) u + free response whose simulation leaves the least error."""

    structure: Structure
    gain: float  # [output unit / input unit], of an integrating structure by second
    lags: np.ndarray  # falling [s]
    delay: float  # θ [s]
    free: np.ndarray  # amounts of the free responses
    residuals: np.ndarray  # [N]
    jacobian: np.ndarray  # [N, p] by gain, free amounts, logarithms of the lags, and θ
    period: float
    at_bound: bool  # whether a time ran into the longest or shortest that is sought
    rounding: float  # how far the arithmetic may be off in a simulated sample

    @property
    def has_equal_lags(self) -> bool:
        """Whether the search ended where two lags are one, as half of such records let it."""
        lags = self.lags
        return len(lags) == 2 and bool(lags[0] <= (1.0 + _EQUAL) * lags[1])

    def simulated(self, signal: np.ndarray) -> np.ndarray:
        """Return the output [M] for an input that begins as the fitted one, of any length."""
        time = self.period * np.arange(len(signal))
        found = _late(self.structure, time, self.lags, self.delay)
        return np.asarray(self.gain * held_response(signal, found.step) + found.free @ self.free)


def fit_output_error(
    structure: Structure, signal: np.ndarray, output: np.ndarray, period: float
) -> OutputErrorFit:
    """Fit a structure to a record by nonlinear least squares of the simulated output.

    Gain, rest and initial motion are linear in the output and solved for exactly within each
    step (variable projection, with Kaufman's Jacobian), so that lags and dead time are all that
    is searched: by SciPy's trust-region reflective method from the best places of a grid, since
    the error has a minimum between any two samples of dead time. The dead time is any number;
    the discretisation is exact. The input before the record is taken to have stood at its first
    value; whatever moved the output before is in the free response, which is all where the input
    stands still. The period is in s.

    References
    ----------
    L. Ljung, System Identification, 2nd ed., 1999, section 4.2 (output error).
    G. Golub and V. Pereyra, Inverse Problems 19(2), 2003, R1-R26, doi 10.1088/0266-5611/19/2/201.

    Examples
    --------
    A tank with a gain of 2, a lag of 12 s and 2.7 s of dead time, sampled each second:

    >>> from clepsydra.identification.structures import FOPDT
    >>> u = np.repeat([0.0, 1.0, -1.0, 0.5], 25)
    >>> since = np.maximum(np.arange(100.0) - 2.7, 0.0)
    >>> y = held_response(u, 2.0 * (1.0 - np.exp(-since / 12.0)))
    >>> fit = fit_output_error(FOPDT, u, y, 1.0)
    >>> [round(float(each), 6) for each in (fit.gain, fit.lags[0], fit.delay)]
    [2.0, 12.0, 2.7]
    """
    from scipy.optimize import least_squares

    problem = _Problem(structure, signal, output, period)
    low, high = problem.bounds

    def search(start: np.ndarray, most: int | None = None) -> Any:
        return least_squares(
            problem.residuals,
            np.clip(start, low + 1e-6 * (high - low), high - 1e-6 * (high - low)),
            jac=problem.slopes, bounds=(low, high), max_nfev=most,
            ftol=_TOLERANCE, xtol=_TOLERANCE, gtol=_EPSILON,
        )  # fmt: skip

    # A few steps tell the valleys apart; the lowest is followed to its end.
    starts = fit_starts(structure, signal, output, period, low, high)
    if not np.ptp(signal):
        starts = starts[:1]  # they differ in dead time only, which means nothing here
    best = min((search(start, _FEW) for start in starts), key=lambda found: float(found.cost))
    return problem.fit(best.x if best.success else search(best.x).x)


def _late(structure: Structure, time: np.ndarray, lags: np.ndarray, delay: complex) -> Responses:
    """Return the responses of a structure after a dead time [s]."""
    since = time - delay
    return structure.responses(np.where(since.real > 0.0, since, 0.0), time, lags)


class _Problem:
    """The search over ln lags and θ/T, the linear amounts eliminated."""

    def __init__(
        self, structure: Structure, signal: np.ndarray, output: np.ndarray, period: float
    ) -> None:
        self.structure, self.period = structure, period
        self.signal, self.output = signal, output
        self.time = period * np.arange(len(signal))
        # Residuals are brought to the size of one, so that the search knows a gradient of zero.
        self.scale = 2.0 ** -np.round(np.log2(np.ptp(output)))
        longest = float(self.time[-1])
        lags = structure.lags
        self.bounds = (
            np.append(np.full(lags, np.log(_SHORTEST * period)), 0.0),
            np.append(np.full(lags, np.log(_LONGEST * longest)), LATEST * len(signal)),
        )
        self._at: np.ndarray | None = None

    def residuals(self, x: np.ndarray) -> np.ndarray:
        self._solve(x)
        return np.asarray(self.scale * self._residuals)

    def slopes(self, x: np.ndarray) -> np.ndarray:
        self._solve(x)
        return self.scale * self._project(self._moved(x))

    def fit(self, x: np.ndarray) -> OutputErrorFit:
        self._solve(x)
        lags = self.structure.lags
        order = np.argsort(-x[:lags], kind="stable")
        moved = self._moved(x)
        jacobian = np.concatenate(
            [self._columns, moved[:, order], moved[:, lags:] / self.period], axis=1
        )
        low, high = self.bounds
        near = 1e-4
        stuck = (x[:lags] < low[:lags] + near) | (x[:lags] > high[:lags] - near)
        return OutputErrorFit(
            structure=self.structure,
            gain=float(self._amounts[0]),
            lags=np.exp(x[:lags])[order],
            delay=float(x[lags] * self.period),
            free=self._amounts[1:],
            residuals=-self._residuals,
            jacobian=jacobian,
            period=self.period,
            at_bound=bool(np.any(stuck) or x[lags] > high[lags] - near),
            # Sums of as many terms as there are samples.
            rounding=len(self.output)
            * _EPSILON
            * float(np.max(np.abs(self._columns) @ np.abs(self._amounts))),
        )

    def _solve(self, x: np.ndarray) -> None:
        """Find the linear amounts at x, and what is left."""
        if self._at is not None and np.array_equal(self._at, x):
            return
        found = self._responses(x)
        forced = held_response(self.signal, found.step)
        self._columns = np.concatenate([forced[:, None], found.free], axis=1)
        sizes = np.linalg.norm(self._columns, axis=0)
        there = sizes > 0.0  # an input that has not moved, or whose dead time has not passed
        self._basis, triangle = np.linalg.qr(self._columns[:, there] / sizes[there])
        aim = self._basis.T @ self.output
        self._amounts = np.zeros(len(sizes))
        self._amounts[there] = np.linalg.lstsq(triangle, aim, rcond=None)[0] / sizes[there]
        self._residuals = self._columns @ self._amounts - self.output
        self._at = x.copy()

    def _responses(self, x: np.ndarray) -> Responses:
        return _late(self.structure, self.time, np.exp(x[:-1]), x[-1] * self.period)

    def _moved(self, x: np.ndarray) -> np.ndarray:
        """Return how the output moves with ln lags and θ/T at fixed amounts [N, lags + 1]."""
        moved = []
        for place in range(len(x)):
            found = self._responses(x + _IMAGINARY * (np.arange(len(x)) == place))
            forced = held_response(self.signal, found.step.imag)
            moved.append(self._amounts[0] * forced + found.free.imag @ self._amounts[1:])
        return np.stack(moved, axis=1) / _IMAGINARY.imag

    def _project(self, columns: np.ndarray) -> np.ndarray:
        return np.asarray(columns - self._basis @ (self._basis.T @ columns))
