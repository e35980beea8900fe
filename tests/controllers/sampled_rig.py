"""A law in increments on a sampled model, scan by scan, and its gains by pole placement."""

from collections import deque
from typing import NamedTuple

import numpy as np
from law_function import function_of
from scipy.linalg import convolution_matrix

from clepsydra.program.delay_ring import DelayRing


class Placed(NamedTuple):
    """P (1 − z^-1) u = r0 w − Q y, which gives A (1 − z^-1) P + B Q = D."""

    P: np.ndarray
    Q: np.ndarray
    feedforward: float
    D: np.ndarray

    @property
    def values(self):
        """The parameters of the law: P divided by p0, and Q in differences of the measurement."""
        differences = -np.cumsum(self.Q[:0:-1])[::-1]
        gains = {"level.reference_gain": self.feedforward}
        gains |= {f"level.measurement_gain.{j}": g for j, g in enumerate(differences, start=1)}
        gains |= {f"level.increment_gain.{j}": p for j, p in enumerate(self.P[1:], start=1)}
        scaled = {name: gain / self.P[0] for name, gain in gains.items()}
        return {name: float(gain) for name, gain in scaled.items()}


def placed(model, poles, penalty=1.0, *, predicted=False):
    """The poles of the quadratic criterion A* q A + B* B, and further ones.

    Parameters
    ----------
    model : SampledModel
    poles : sequence of float
    penalty : float
        q
    predicted : bool
        For what a predictor shows: B(1) z^-1 in the place of B.
    """
    A, B = np.array(model.A, float), np.array(model.B, float)
    length = max(len(A), len(B))
    A_, B_ = (np.pad(each, (0, length - len(each))) for each in (A, B))
    criterion = penalty * np.convolve(A_, A_[::-1]) + np.convolve(B_, B_[::-1])
    roots = np.roots(np.trim_zeros(criterion))
    D = np.poly([*roots[np.abs(roots) < 1.0], *poles]).real
    B = np.array([0.0, B.sum()]) if predicted else np.concatenate([np.zeros(model.delay), B])
    steadied = np.convolve(A, [1.0, -1.0])
    of_p = max(len(B) - 1, len(D) - len(steadied) + 1)
    size = len(steadied) + of_p - 1
    of_q = size - of_p
    columns = [convolution_matrix(steadied, of_p), convolution_matrix(B, of_q)]
    columns = [np.pad(each, ((0, size - len(each)), (0, 0))) for each in columns]
    found = np.linalg.solve(np.hstack(columns), np.pad(D, (0, size - len(D))))
    return Placed(found[:of_p], found[of_p:], D.sum() / B.sum(), D)


class Rig:
    """One loop of a law, its signals far from zero: y° = 5, u° = 3.

    Parameters
    ----------
    law, values
    model : SampledModel or None
        Of the process; None where the test gives the measurements.
    """

    def __init__(self, law, values, model=None, *, load=0.0):
        self.law, self.model, self.load = law, model, load
        self.values = {"pump.low_limit": -1e6, "pump.high_limit": 1e6, **values}
        self.state = {entry.name: 0.0 for entry in law.state}
        self.state |= {n: 5.0 for n in self.state if ".past_value" in n or ".past_setpoint" in n}
        self.state["pump.last_output"] = 3.0
        self.rings = {
            entry.name: deque([0.0] * entry.length)
            for entry in law.state
            if isinstance(entry, DelayRing)
        }
        self.given = {"sp": 5.0, "pv": 5.0, "good": 1.0, "mode": 1.0,
                          "manual": 3.0, "tracking": 3.0, "time_step": 1.0}  # fmt: skip
        self.u, self.y, self.status = [], [], 0

    def scan(self, **given):
        """One sample; returns the output."""
        self.given |= given
        if self.model is not None:
            self.given["pv"] = 5.0 + self.deviation()
        now = {**self.state, **{name: ring[0] for name, ring in self.rings.items()}}
        following, outputs, _ = function_of(self.law)(
            [now[entry.name] for entry in self.law.state],
            [self.given[signal.part] for signal in self.law.inputs],
            [self.values[signal.name] for signal in self.law.parameters],
        )
        for entry, value in zip(self.law.state, following, strict=True):
            if entry.name in self.rings:
                self.rings[entry.name].popleft()
                self.rings[entry.name].append(value)
            else:
                self.state[entry.name] = value
        self.y.append(self.given["pv"])
        self.u.append(outputs[0])
        self.status = int(outputs[1])
        return self.u[-1]

    def deviation(self):
        """y(k) − y°, by the difference equation."""
        m, k = self.model, len(self.y)
        value = 0.0
        for i, a in enumerate(m.denominator, start=1):
            value -= a * (self.y[k - i] - 5.0) if k >= i else 0.0
        for j, b in enumerate(m.numerator, start=1):
            past = k - j - m.delay
            value += b * ((self.u[past] - 3.0 if past >= 0 else 0.0) + self.load)
        return value

    def run(self, samples, **given):
        """Some samples; returns the measurements since the beginning."""
        for _ in range(samples):
            self.scan(**given)
        return np.array(self.y)
