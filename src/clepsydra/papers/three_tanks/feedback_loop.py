"""A state feedback with precompensator around the linear model (2), and what it demands."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.loop_margins import LoopMargins, loop_margins
from clepsydra.papers.comparison import compared
from clepsydra.papers.figure import Curve
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row
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
        return self._margins(self.model.A, self.gain)

    def _margins(self, A: np.ndarray, gain: np.ndarray) -> LoopMargins:
        B, states = self.model.B, tuple(self.model.states)
        return loop_margins(
            LinearModel(
                A, B, B[:, :0], gain, np.zeros((1, 1)), states, ("feed",), (), ("demand",)
            )
        )  # fmt: skip

    @property
    def vector_gain_margin(self) -> float:
        """20 log10 max\\|S\\| at the feed [dB]."""
        return 20.0 * math.log10(self.margins.sensitivity.peak)

    @cached_property
    def vector_gain_margins_at_levels(self) -> list[float]:
        """20 log10 max\\|S\\| with the loop opened at one level, closed at the others [dB]."""
        return [
            20.0 * math.log10(self._margins(A, gain).sensitivity.peak)
            for A, gain in self._opened_at_levels()
        ]

    def _opened_at_levels(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return A with the feedback of the other levels closed, and the gain of one, of each."""
        alone = [np.where(np.arange(3) == place, self.gain, 0.0) for place in range(3)]
        return [(self.model.A - self.model.B @ (self.gain - gain), gain) for gain in alone]

    @property
    def sensitivity_at_phase_crossings(self) -> list[float]:
        """20 log10 \\|S\\| where the phase of L is -180° at the feed [dB]."""
        return self._at_phase_crossings(self.model.A)

    @property
    def sensitivity_at_phase_crossings_of_levels(self) -> list[float]:
        """The same with the loop opened at one level, closed at the others [dB]."""
        return [size for A, _ in self._opened_at_levels() for size in self._at_phase_crossings(A)]

    def _at_phase_crossings(self, A: np.ndarray) -> list[float]:
        """With S = O / C, open over closed polynomial, L is real where S is: a quadratic in ω²."""
        opened, closed = (
            [np.array([-each[1], each[3]]), np.array([-1.0, each[2]])]  # real part, imaginary / ω
            for each in (np.poly(A), np.poly(self.closed))
        )
        crossed = np.polymul(opened[1], closed[0]) - np.polymul(opened[0], closed[1])
        squares = np.sort([root.real for root in np.roots(crossed) if abs(root.imag) < 1e-9])
        sizes = [np.polyval(opened[0], x) / np.polyval(closed[0], x) for x in squares if x > 0.0]
        # L = 1/S - 1 is below zero where S is below zero or above one, rounding at ω → ∞ apart.
        return [20.0 * math.log10(abs(size)) for size in sizes if not 0.0 <= size <= 1.0 + 1e-9]

    def margin_row(self, printed: Printed) -> Row:
        """Compare its vector gain margin with a printed one.

        The reason says what it is at other places, and by (6), which takes \\|S\\| where the phase
        is -180°.
        """
        assert math.isinf(self.margins.gain_margin_up or 0.0)
        level = max(self.vector_gain_margins_at_levels)
        crossed = max(
            *self.sensitivity_at_phase_crossings, *self.sensitivity_at_phase_crossings_of_levels
        )
        words = (
            "Where the loop is opened is not said. 20 log10 max|S|, the document's S∞, at the "
            f"feed; at a level it is at most {level:.2f} dB, and where the phase is -180°, as in "
            f"(6) of the vector gain margin, at most {crossed:.2f} dB."
        )
        return compared(printed, self.vector_gain_margin, unprinted=words)

    @property
    def closed_gain_margin(self) -> float:
        """Gain margin of the closed loop from setpoint to level 3, as of an open one [dB].

        It has no zeros: a₀ / (s³ + a₂ s² + a₁ s + a₀), which turns by 180° at √a₁.
        """
        _, second, first, last = np.poly(self.closed).real
        return 20.0 * math.log10((second * first - last) / last)

    @property
    def closed_bandwidth(self) -> float:
        """Frequency to which the closed loop from setpoint to level 3 is above -3 dB [rad/s]."""
        polynomial = np.poly(self.closed).real
        frequencies = np.logspace(-1.0, 4.0, 20000)
        size = np.abs(polynomial[-1] / np.polyval(polynomial, 1j * frequencies))
        return float(frequencies[size > math.sqrt(0.5)][-1])

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

    def closed_response(self, frequencies: np.ndarray) -> np.ndarray:
        """Return the closed loop from setpoint to level 3 [n]."""
        points = 1j * frequencies[:, None, None] * np.eye(3) - self.closed
        level = np.linalg.solve(points, self.model.B)[:, 2, 0]
        return np.asarray(level * self.setpoint_gain)

    def step_without_precompensator(self, time: np.ndarray) -> Curve:
        """Return level 3 over a setpoint step that is fed in as it is."""
        return Curve(self.label, time, self.step(1.0, time)[0][:, 2] / self.setpoint_gain)

    def frequency_response(self, frequencies: np.ndarray) -> np.ndarray:
        """Return L at the feed, K (jω - A)⁻¹ B [n]."""
        model = self.model
        points = 1j * frequencies[:, None, None] * np.eye(3) - model.A
        return np.asarray(self.gain @ np.linalg.solve(points, model.B))[:, 0, 0]
