"""What each plant of this folder is held against: textbook loops, SciPy, and differences.

Nothing here comes from Clepsydra; the physics of a plant stands in its test.
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

#: State and what acts on it -> rates.
Rates = Callable[..., np.ndarray]


class PI:
    """A PI loop in shares of the ranges, back-calculation with T_t = T_i; a step a sample."""

    def __init__(self, gain: float, integral_time: float, period: float, at_rest: float) -> None:
        self.gain, self.share, self.integral = gain, period / integral_time, at_rest

    def __call__(self, setpoint: float, reading: float, held_at: float | None = None) -> float:
        """Return what is applied, of which an interlock may hold the value."""
        error = setpoint - reading
        if held_at is not None:
            self.integral = held_at - self.gain * error
            return held_at
        asked = self.gain * error + self.integral
        applied = min(max(asked, 0.0), 1.0)
        self.integral += self.share * (self.gain * error + applied - asked)
        return applied


def advanced(rates: Rates, state: np.ndarray, acting: tuple, period: float) -> np.ndarray:
    """Return the state a sample later."""
    found = solve_ivp(
        lambda time, now: rates(now, *acting, time), (0.0, period), state,
        method="DOP853", rtol=1e-10, atol=1e-13,
    )  # fmt: skip
    return found.y[:, -1]


def slopes(function: Callable[[np.ndarray], np.ndarray], at: np.ndarray) -> np.ndarray:
    """Return the Jacobian by central differences, six digits of it."""
    columns = []
    for place, value in enumerate(at):
        step = np.zeros(len(at))
        step[place] = 1e-5 * max(abs(value), 1e-2)
        columns.append((function(at + step) - function(at - step)) / (2 * step[place]))
    return np.array(columns).T


def model(rates: Rates, shown: Callable, state: np.ndarray, inputs: np.ndarray):
    """Return static gain and time constants, largest first, of rates and of what is measured."""

    def both(at: np.ndarray) -> np.ndarray:
        now, moved = at[: len(state)], at[len(state) :]
        return np.concatenate([rates(now, moved), shown(now, moved)])

    found = slopes(both, np.concatenate([state, inputs]))
    n = len(state)
    A, B, C, D = found[:n, :n], found[:n, n:], found[n:, :n], found[n:, n:]
    return D - C @ np.linalg.solve(A, B), np.sort(-1 / np.linalg.eigvals(A).real)[::-1]
