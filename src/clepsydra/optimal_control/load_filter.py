"""The extended Kalman filter of a process and of an unknown load on each of its inputs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

from clepsydra.base.pickled_fields import PickledFields
from clepsydra.engine.runge_kutta import runge_kutta
from clepsydra.optimal_control.acting_model import ActingModel


class Estimate(NamedTuple):
    """What is known of contents and loads, and how surely.

    Parameters
    ----------
    values : ndarray [n + m]
        Contents, scaled, then loads, shares of the ranges of the inputs.
    covariance : ndarray [n + m, n + m]
    """

    values: np.ndarray
    covariance: np.ndarray


@dataclass(frozen=True, eq=False)
class LoadFilter(PickledFields):
    """x̂ and l̂ moved on by ẋ = f(x, u + l), l̇ = 0, and then corrected by y(x).

    Each sample, with Φ the slope of a Runge-Kutta solution over it and H that of the readings::

        P ← Φ P Φᵀ + W,   x̂ ← x̂ + P Hᵀ (H P Hᵀ + V)⁻¹ (y − h(x̂)),   P ← (I − P Hᵀ (…)⁻¹ H) P

    A load that is estimated leaves no offset at rest, whatever its size.

    A. H. Jazwinski, Stochastic Processes and Filtering Theory, Academic Press 1970, chapter 8;
    G. Pannocchia and J. B. Rawlings, AIChE Journal 49, 2003, doi 10.1002/aic.690490213.

    Parameters
    ----------
    model : ActingModel
        Its outputs are what is measured.
    period : float
        Sampling period [s].
    substeps : int
        Steps of the Runge-Kutta method in a sample.
    loads : ndarray [m] of bool
        The inputs on which a load is estimated; it stays zero on the others.
    """

    model: ActingModel
    period: float
    substeps: int
    loads: np.ndarray

    @cached_property
    def moved_on(self) -> ca.Function:
        """(x and l, u, Δt) → x and l after a sample, its slopes by x and l, and by u."""
        model = self.model
        contents, inputs = len(model.rest), len(model.moved)
        whole, u = ca.SX.sym("xl", contents + inputs), ca.SX.sym("u", inputs)
        x, load, time = whole[:contents], whole[contents:], ca.SX.sym("t")
        end = runge_kutta(model.rates, self.substeps)(time, x, u, load)
        after = ca.vertcat(end, load)
        slopes = ca.jacobian(after, whole), ca.jacobian(after, u)
        return ca.Function("moved_on", [whole, u, time], [after, *map(ca.densify, slopes)])

    @cached_property
    def shown(self) -> ca.Function:
        """x and l → what the outputs show, over their sizes, and its slope."""
        model = self.model
        whole = ca.SX.sym("xl", len(model.rest) + len(model.moved))
        read = model.errors(whole[: len(model.rest)], np.zeros(len(model.plant.outputs)))
        return ca.Function("shown", [whole], [read, ca.densify(ca.jacobian(read, whole))])

    @cached_property
    def at_rest(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Φ, Γ and H where the plant rests."""
        rest = self.rest
        _, held, moved = self.moved_on(rest, self.model.inputs_at_rest, self.period)
        return np.array(held), np.array(moved), np.array(self.shown(rest)[1])

    @property
    def rest(self) -> np.ndarray:
        """Contents and loads where the plant rests."""
        return np.append(self.model.rest, np.zeros(len(self.model.moved)))

    def noise(self, unsure: np.ndarray, wander: np.ndarray, time: float) -> np.ndarray:
        """Return W of inputs that are unsure by so much, and of loads that wander so far.

        Each input is white noise that, summed up over the time, moves the process as far as an
        error of its size which lasts so long; each load goes as far as it wanders within it.

        Parameters
        ----------
        unsure, wander : ndarray [m]
            Shares of the ranges.
        time : float
            [s]
        """
        _, moved, _ = self.at_rest
        contents = len(self.model.rest)
        by_inputs = moved * unsure
        found = by_inputs @ by_inputs.T * (time / self.period)
        loads = np.where(self.loads, np.square(wander), 0.0) * (self.period / time)
        found[contents:, contents:] = np.diag(loads)
        return found

    def following(
        self, before: Estimate, applied: np.ndarray, noise: np.ndarray, time: float
    ) -> Estimate:
        """Return what is expected after a sample under the inputs that were applied."""
        after, slope, _ = map(np.array, self.moved_on(before.values, applied, time))
        covariance = slope @ before.covariance @ slope.T + noise
        return Estimate(self._inside(after.ravel()), covariance)

    def corrected(self, expected: Estimate, read: np.ndarray, sensors: np.ndarray) -> Estimate:
        """Return what is known after a measurement.

        Parameters
        ----------
        read, sensors : ndarray [q]
            What the outputs show, and the standard deviations of their noise, over their sizes.
        """
        P = expected.covariance
        reading, H = map(np.array, self.shown(expected.values))
        spread = P @ H.T
        gain = np.linalg.solve(H @ spread + np.diag(sensors**2), spread.T).T
        values = expected.values + gain @ (read - reading.ravel())
        covariance = P - gain @ spread.T
        return Estimate(self._inside(values), (covariance + covariance.T) / 2.0)

    def _inside(self, values: np.ndarray) -> np.ndarray:
        low, high = self.model.bounds
        contents = len(low)
        return np.append(np.clip(values[:contents], low, high), values[contents:])
