"""A state feedback with precompensator around the linear model (2), and what it demands."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from clepsydra.linear.frequency_peak import largest_gain
from clepsydra.linear.linear_model import LinearModel
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row, Rows, joined
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.printed_model import printed_model

#: Of the printed poles: what the two digits of their pair leave open, and no more.
NEAR = 0.02
_LEVEL_3 = np.array([[0.0, 0.0, 1.0]])


def from_rest(A: np.ndarray, entry: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Return the states [samples, n] of dx/dt = A x + entry from zero, A stable."""
    poles, modes = np.linalg.eig(A)
    rest = np.linalg.solve(A, -entry)
    shares = np.linalg.solve(modes, rest)
    return rest - ((np.exp(np.outer(time, poles)) * shares) @ modes.T).real


#: A real pole and the upper one of a pair [1/s].
Poles = tuple[float, complex]


def poles_of(closed: np.ndarray) -> Poles:
    """Return the real pole of a closed loop [3, 3] and the upper one of its pair [1/s]."""
    values = np.linalg.eigvals(closed)
    (real,) = values[np.abs(values.imag) < 1e-9].real
    (upper,) = values[values.imag > 1e-9]
    return float(real), complex(upper)


def in_words(poles: Poles) -> str:
    """Return poles as they are printed.

    Examples
    --------
    >>> in_words((-40.0, -5.0 + 5.0j))
    '−40 and −5 ± j5'
    """
    real, upper = poles
    return f"{real:.3g} and {upper.real:.3g} ± j{upper.imag:.3g}".replace("-", "−")


def pole_distance(poles: Poles, wanted: Poles) -> float:
    """Return the largest distance of a pole from where it should be, over the size of that."""
    return max(abs(one / other - 1.0) for one, other in zip(poles, wanted, strict=True))


@dataclass(frozen=True, eq=False)
class FeedbackLoop:
    """u = N r - K x around a linear model, (2) if left out, in continuous time."""

    label: str
    gain: np.ndarray  # K [1, 3] [m²/s]
    model: LinearModel = field(default_factory=printed_model)

    @property
    def closed(self) -> np.ndarray:
        """A - B K [3, 3]."""
        return np.asarray(self.model.A - self.model.B @ self.gain)

    @property
    def poles(self) -> tuple[float, complex]:
        """The real pole and the upper one of the pair [1/s]."""
        return poles_of(self.closed)

    @property
    def poles_in_words(self) -> str:
        """As they are printed: "−40.0 and −5.00 ± j5.00"."""
        return in_words(self.poles)

    def gain_rows(self, place: str, exact: FeedbackLoop, real: float, upper: complex) -> Rows:
        """Compare its gains with those of a table; `exact` has those of (2) before rounding.

        Two of them make other poles than those beside them, since three gains were printed under
        one factor. Two more move a pole, but have as many digits as their column.
        """
        of, names = self.label.removeprefix("poles "), ("K1", "K2", "K3")
        printed = [PRINTED[place, f"{name}, {of}"] for name in names]
        gains = np.array([[line.value for line in printed]])
        factor = 10.0 ** math.floor(math.log10(gains.max()))
        shares = " ".join(f"{each:.4f}" for each in self.gain[0] / factor)
        as_printed = replace(self, gain=gains)
        off = as_printed.distance_from(real, upper)
        for i, line in enumerate(printed):
            right = float(self.gain[0, i])
            mended = replace(self, gain=np.where(np.arange(3) == i, right, gains))
            near = mended.distance_from(real, upper)
            words = (
                "from the rates of (2) in three decimals and B = 64.94; with the other printed "
                f"gains it makes the poles {mended.poles_in_words}, within {100.0 * near:.1f} % of "
                f"those printed beside it, and {line.text} makes {as_printed.poles_in_words}, up "
                f"to {100.0 * off:.0f} % off; it rounds to {line.text}, but in fewer digits than "
                f"its column, as MATLAB shows a vector under one factor, {factor:.0f} [{shares}]"
            )
            decides = near < NEAR < off
            row = line.compared(right, right_if=[(words, decides)], exact=exact.gain[0, i])
            if decides and row.verdict == "reproduced":
                passes = (
                    f"In two digits, as K1 of other rows: as printed it makes the poles "
                    f"{as_printed.poles_in_words}, up to {100.0 * off:.0f} % from those beside it, "
                    "which its last digit leaves open."
                )
                row = replace(row, reason=joined(row.reason, passes))
            yield row

    def distance_from(self, real: float, upper: complex) -> float:
        """Largest distance of a pole from where it should be, over the size of that."""
        return pole_distance(self.poles, (real, upper))

    @property
    def setpoint_gain(self) -> float:
        """N, with which level 3 comes to rest at the setpoint [m²/s]."""
        return float(-1.0 / (_LEVEL_3 @ np.linalg.solve(self.closed, self.model.B))[0, 0])

    @cached_property
    def sensitivity_peaks(self) -> list[float]:
        r"""max\|S\| with the loop opened at the feed and at each level, closed at the others."""
        model = self.model
        return [
            largest_gain(self.closed, model.B, -gain, np.eye(1)).peak for _, gain in self._opened()
        ]

    @property
    def vector_gain_margins(self) -> list[float]:
        r"""20 log10 max\|S\| with the loop opened at the feed and at each level [dB]."""
        return [20.0 * math.log10(each) for each in self.sensitivity_peaks]

    def _opened(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return A with the other feedback closed, and the gain of what is opened, of each."""
        levels = [np.where(np.arange(3) == place, self.gain, 0.0) for place in range(3)]
        return [(self.model.A - self.model.B @ (self.gain - k), k) for k in (self.gain, *levels)]

    @property
    def sensitivity_at_phase_crossings(self) -> list[list[float]]:
        r"""20 log10 \|S\| where the phase of L is -180°, opened at the feed and levels [dB]."""
        return [self._at_phase_crossings(A) for A, _ in self._opened()]

    @property
    def largest_crossing(self) -> float:
        """The largest of them [dB]."""
        return max(each for sizes in self.sensitivity_at_phase_crossings for each in sizes)

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
        """Compare its vector gain margin with a printed one."""
        at_feed, *at_levels = self.vector_gain_margins
        words = (
            "Where the loop is opened is not said. 20 log10 max|S|, the document's S∞, at the "
            f"feed, on (2) before rounding; at a level it is at most {max(at_levels):.2f} dB, and "
            "where the phase is -180°, as in the second equation (6), at most "
            f"{self.largest_crossing:.2f} dB."
        )
        return printed.compared(at_feed, unprinted=words)

    @property
    def phase_margin(self) -> float:
        """With the loop opened at the feed [degrees]."""
        import control

        _, phase, *_ = control.stability_margins(
            control.ss(self.model.A, self.model.B, self.gain, 0.0)
        )
        return float(phase)

    @property
    def closed_gain_margin(self) -> float:
        """Gain margin that is read off the magnitude of the closed loop, as in Fig. 11 [dB]."""
        _, second, first, last = np.poly(self.closed).real
        return 20.0 * math.log10((second * first - last) / last)

    @property
    def closed_bandwidth(self) -> float:
        """Frequency at which the closed loop has lost 3 dB [rad/s]."""
        frequencies = np.logspace(-1.0, 4.0, 20000)
        sizes = np.abs(self.closed_response(frequencies))
        return float(frequencies[sizes > math.sqrt(0.5)][-1])

    def step(self, size: float, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return levels [n, 3] and feed [n] after a setpoint step at the start, from rest."""
        demand = self.setpoint_gain * size
        states = from_rest(self.closed, self.model.B[:, 0] * demand, time)
        return states, demand - states @ self.gain[0]

    def closed_response(self, frequencies: np.ndarray) -> np.ndarray:
        """Return level 3 by the setpoint at frequencies [rad/s]."""
        return self.setpoint_gain * self._response(self.closed, _LEVEL_3, frequencies)

    def frequency_response(self, frequencies: np.ndarray) -> np.ndarray:
        """Return L at frequencies [rad/s], the loop broken at the feed."""
        return self._response(self.model.A, self.gain, frequencies)

    def _response(self, A: np.ndarray, C: np.ndarray, frequencies: np.ndarray) -> np.ndarray:
        points = 1j * frequencies[:, None, None] * np.eye(3) - A
        return np.asarray(C @ np.linalg.solve(points, self.model.B))[:, 0, 0]

    def step_without_precompensator(self, time: np.ndarray) -> np.ndarray:
        """Return level 3 over a setpoint step that is fed in as it is."""
        return np.asarray(self.step(1.0, time)[0][:, 2] / self.setpoint_gain)
