"""The quadratic programs that are solved: random ones, and those of a predictive controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

#: H, f, A and b of ½ xᵀ H x + fᵀ x where A x ≤ b.
Problem = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def random_problems(unknowns: int, rows: int, many: int) -> list[Problem]:
    """Return feasible ones: the condition of H is up to a million, a tenth of the rows tight."""
    random = np.random.default_rng((unknowns, rows))
    return [random_problem(random, unknowns, rows) for _ in range(many)]


def random_problem(random: np.random.Generator, n: int, m: int) -> Problem:
    """Return one: some of its rows meet in the middle of the rest."""
    turned, _ = np.linalg.qr(random.normal(size=(n, n)))
    curves = np.logspace(0, -random.uniform(0, 6), n)
    rows, inside = random.normal(size=(m, n)), random.normal(size=n)
    gaps = random.uniform(size=m) * (random.uniform(size=m) > 0.1)
    return turned @ np.diag(curves) @ turned.T, random.normal(size=n), rows, rows @ inside + gaps


@dataclass(frozen=True)
class TankControl:
    """Predictive control of the quadruple tank, 5 samples of 10 s ahead: 10 unknowns, 40 rows.

    In deviations from the operating point: levels [cm] within 6 of it in the two lower tanks,
    pump voltages [V] within 3. The cost is Σ |y − r|² + ½ |Δu|² over the samples ahead.

    References
    ----------
    K. H. Johansson, The quadruple-tank process, IEEE Transactions on Control Systems Technology
    8(3), 2000, equation (2) and table 1, minimum phase.
    """

    ahead: int = 5
    period: float = 10.0
    setpoint: tuple[float, float] = (4.0, -3.0)
    highest_level: float = 6.0
    highest_voltage: float = 3.0
    movement: float = 0.5

    @property
    def model(self) -> tuple[np.ndarray, np.ndarray]:
        """Return A and B of the levels at the next sample."""
        area, time = np.array([28.0, 32.0, 28.0, 32.0]), np.array([62.0, 90.0, 23.0, 30.0])
        gain, split = np.array([3.33, 3.35]), np.array([0.7, 0.6])
        slope = np.zeros((6, 6))
        slope[range(4), range(4)] = -1 / time
        slope[0, 2], slope[1, 3] = area[2] / (area[0] * time[2]), area[3] / (area[1] * time[3])
        slope[0, 4], slope[1, 5] = split * gain / area[:2]
        slope[2, 5], slope[3, 4] = (1 - split[::-1]) * gain[::-1] / area[2:]
        found = expm(self.period * slope)
        return found[:4, :4], found[:4, 4:]

    def problem(self, levels: np.ndarray, voltages: np.ndarray) -> Problem:
        """Return the program over all voltages ahead, from levels and the voltages that are on."""
        a, b = self.model
        size = 2 * self.ahead
        free, forced = [levels], [np.zeros((4, size))]
        for k in range(self.ahead):
            step = a @ forced[-1]
            step[:, 2 * k : 2 * k + 2] += b
            free.append(a @ free[-1])
            forced.append(step)
        outputs = np.vstack([each[:2] for each in forced[1:]])
        left = np.concatenate([each[:2] - self.setpoint for each in free[1:]])
        moves = np.eye(size) - np.eye(size, k=-2)
        first = np.concatenate([-voltages, np.zeros(size - 2)])
        hessian = 2 * (outputs.T @ outputs + self.movement * moves.T @ moves)
        linear = 2 * (outputs.T @ left + self.movement * moves.T @ first)
        level = np.concatenate([each[:2] for each in free[1:]])
        rows = np.vstack([np.eye(size), -np.eye(size), outputs, -outputs])
        bounds = np.concatenate(
            [
                np.full(2 * size, self.highest_voltage),
                self.highest_level - level,
                self.highest_level + level,
            ]
        )
        return hessian, linear, rows, bounds
