"""A state feedback with precompensator around the linear model (2), and what it demands."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.loop_margins import LoopMargins, loop_margins
from clepsydra.papers.three_tanks.printed_model import printed_model

_LEVEL_3 = np.array([[0.0, 0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class FeedbackLoop:
    """u = N r - K x around a linear model, in continuous time.

    Parameters
    ----------
    label : str
    gain : ndarray [1, 3]
        K [m²/s].
    model : LinearModel, optional
        (2) if left out.

    Examples
    --------
    >>> loop = FeedbackLoop("idle", np.zeros((1, 3)))
    >>> round(loop.setpoint_gain, 8)
    0.00017509
    """

    label: str
    gain: np.ndarray
    model: LinearModel = field(default_factory=printed_model)

    @property
    def closed(self) -> np.ndarray:
        """A - B K [3, 3]."""
        return np.asarray(self.model.A - self.model.B @ self.gain)

    @property
    def setpoint_gain(self) -> float:
        """N, with which level 3 comes to rest at the setpoint [m²/s]."""
        return float(-1.0 / (_LEVEL_3 @ np.linalg.solve(self.closed, self.model.B))[0, 0])

    @cached_property
    def margins(self) -> LoopMargins:
        """Margins with the loop broken at the feed."""
        model = self.model
        states = tuple(model.states)
        return loop_margins(
            LinearModel(
                model.A, model.B, model.B[:, :0], self.gain, np.zeros((1, 1)), states,
                ("feed",), (), ("demand",),
            )
        )  # fmt: skip

    @property
    def vector_gain_margin(self) -> float:
        """20 log10 max\\|S\\| at the feed [dB]."""
        return 20.0 * math.log10(self.margins.sensitivity.peak)

    def step(self, size: float, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return deviations of the levels [n, 3] and of the feed [n] after a setpoint step."""
        from scipy.linalg import expm

        grid = time[1] - time[0]
        whole = np.zeros((4, 4))
        whole[:3, :3] = self.closed
        whole[:3, 3] = self.model.B[:, 0] * self.setpoint_gain * size
        move = expm(whole * grid)
        state = np.array([0.0, 0.0, 0.0, 1.0])
        states = np.empty((len(time), 3))
        for k in range(len(time)):
            states[k] = state[:3]
            state = move @ state
        feed = self.setpoint_gain * size - states @ self.gain[0]
        return states, feed

    def frequency_response(self, frequencies: np.ndarray) -> np.ndarray:
        """Return L at the feed, K (jω - A)⁻¹ B [n]."""
        model = self.model
        points = 1j * frequencies[:, None, None] * np.eye(3) - model.A
        return np.asarray(self.gain @ np.linalg.solve(points, model.B))[:, 0, 0]
