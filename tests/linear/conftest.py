"""Johansson's quadruple tank, written by hand, and its closed forms in plain Python.

K. H. Johansson, IEEE Transactions on Control Systems Technology 8(3), 2000,
doi 10.1109/87.845876: equations (1), (2), (4) and section III.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from plain_process import plain_process

from clepsydra import Signal
from clepsydra.process.process import Process

# Lets the tests of this folder import its helpers by name.
sys.path.insert(0, str(Path(__file__).parent))

GRAVITY = 9.81


@dataclass(frozen=True)
class Johansson:
    """One phase: parameters in SI, the process, and what the paper's formulas give."""

    gamma: tuple[float, float]
    gain: tuple[float, float]
    voltage: tuple[float, float]
    area: tuple[float, ...] = (28e-4, 32e-4, 28e-4, 32e-4)
    outlet: tuple[float, ...] = (0.071e-4, 0.057e-4, 0.071e-4, 0.057e-4)
    sensor: float = 50.0

    def flows(self, voltage: tuple[float, float]) -> tuple[float, ...]:
        """Return what flows through each tank at steady state [m³/s]."""
        (g1, g2), (k1, k2), (v1, v2) = self.gamma, self.gain, voltage
        q3, q4 = (1 - g2) * k2 * v2, (1 - g1) * k1 * v1
        return g1 * k1 * v1 + q3, g2 * k2 * v2 + q4, q3, q4

    def levels(self, voltage: tuple[float, float]) -> np.ndarray:
        pairs = zip(self.flows(voltage), self.outlet, strict=True)
        return np.array([(q / a) ** 2 / (2 * GRAVITY) for q, a in pairs])

    def time_constants(self, levels: np.ndarray) -> np.ndarray:
        triples = zip(self.area, self.outlet, levels, strict=True)
        return np.array([A / a * math.sqrt(2 * h / GRAVITY) for A, a, h in triples])

    def matrices(self, levels: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return A, B and C of all four sensors, equation (4)."""
        A1, A2, A3, A4 = self.area
        (g1, g2), (k1, k2) = self.gamma, self.gain
        t1, t2, t3, t4 = self.time_constants(levels)
        A = np.array(
            [
                [-1 / t1, 0, A3 / (A1 * t3), 0],
                [0, -1 / t2, 0, A4 / (A2 * t4)],
                [0, 0, -1 / t3, 0],
                [0, 0, 0, -1 / t4],
            ]
        )
        B = np.array(
            [
                [g1 * k1 / A1, 0],
                [0, g2 * k2 / A2],
                [0, (1 - g2) * k2 / A3],
                [(1 - g1) * k1 / A4, 0],
            ]
        )
        return A, B, self.sensor * np.eye(4)

    def zeros(self, levels: np.ndarray) -> np.ndarray:
        """Return the roots of (1 + s T3)(1 + s T4) = (1 - γ1)(1 - γ2)/(γ1 γ2), rightmost first."""
        (g1, g2), (_, _, t3, t4) = self.gamma, self.time_constants(levels)
        a, b, c = t3 * t4, t3 + t4, 1 - (1 - g1) * (1 - g2) / (g1 * g2)
        root = math.sqrt(b * b - 4 * a * c)
        # The stable form: no cancellation in either root.
        large = (-b - root) / (2 * a)
        return np.array([c / (a * large), large])

    @property
    def relative_gain(self) -> float:
        g1, g2 = self.gamma
        return g1 * g2 / (g1 + g2 - 1)

    @property
    def process(self) -> Process:
        return quadruple_tank(self)


def quadruple_tank(plant: Johansson) -> Process:
    x, u, d = ca.SX.sym("x", 4), ca.SX.sym("u", 2), ca.SX.sym("d", 2)
    values = [*plant.area, *plant.outlet, *plant.gamma, *plant.gain, plant.sensor, GRAVITY]
    names = [f"tank_{i}.area" for i in range(1, 5)] + [f"outlet_{i}.area" for i in range(1, 5)]
    names += ["splitter_1.tank_1", "splitter_2.tank_2", "pump_1.gain", "pump_2.gain"]
    names += ["level.gain", "gravity"]
    p = ca.SX.sym("p", len(values))
    area, outlet, (g1, g2), (k1, k2) = p[:4], p[4:8], ca.vertsplit(p[8:10]), ca.vertsplit(p[10:12])
    q = [outlet[i] * ca.sqrt(2 * p[13] * ca.fmax(x[i], 0)) for i in range(4)]
    rates = ca.vertcat(
        (q[2] - q[0] + g1 * k1 * u[0] + d[0]) / area[0],
        (q[3] - q[1] + g2 * k2 * u[1] + d[1]) / area[1],
        ((1 - g2) * k2 * u[1] - q[2]) / area[2],
        ((1 - g1) * k1 * u[0] - q[3]) / area[3],
    )
    level = [Signal(f"tank_{i}.level", "m", "cm", 0, 0.2, 0.1) for i in range(1, 5)]
    return plain_process(
        name="quadruple-tank",
        title="Quadruple tank",
        source="Johansson 2000",
        state=tuple(level),
        inputs=tuple(Signal(f"pump_{i}", "V", "", 0, 10, plant.voltage[i - 1]) for i in (1, 2)),
        disturbances=tuple(Signal(f"inflow_{i}", "m^3/s", "", -1e-5, 1e-5) for i in (1, 2)),
        measurements=tuple(Signal(f"level_{i}", "V", "", 0, 10) for i in range(1, 5)),
        controlled=("level_1", "level_2"),
        parameters=tuple(Signal(n, initial=v) for n, v in zip(names, values, strict=True)),
        dynamics=ca.Function("dynamics", [x, u, d, p], [rates]),
        measure=ca.Function("measure", [x, p], [p[12] * x]),
        measured_state={f"level_{i}": f"tank_{i}.level" for i in range(1, 5)},
        elements=(),
        nominal_outputs={},
        sampling_period=1.0,
    )


MINIMUM = Johansson((0.70, 0.60), (3.33e-6, 3.35e-6), (3.0, 3.0))
NONMINIMUM = Johansson((0.43, 0.34), (3.14e-6, 3.29e-6), (3.15, 3.15))


@pytest.fixture(params=[MINIMUM, NONMINIMUM], ids=["minimum", "nonminimum"])
def johansson(request: pytest.FixtureRequest) -> Johansson:
    return request.param


@pytest.fixture
def minimum() -> Johansson:
    return MINIMUM


@pytest.fixture
def nonminimum() -> Johansson:
    return NONMINIMUM


@pytest.fixture
def make_process() -> Callable[..., Process]:
    """Build a process from a function of (x, u, d) that returns ẋ; levels are the outputs."""

    def build(
        rates: Callable[..., list],
        levels: int,
        pumps: int,
        measure: Callable[..., list] | None = None,
        inflows: int = 0,
        initial: float = 0.5,
    ) -> Process:
        x, u, d = ca.SX.sym("x", levels), ca.SX.sym("u", pumps), ca.SX.sym("d", inflows)
        p = ca.SX.sym("p", 0)
        shown = measure(x) if measure else [x[i] for i in range(levels)]
        names = [f"level_{i}" for i in range(1, len(shown) + 1)]
        return plain_process(
            name="plant",
            title="Plant",
            source="by hand",
            state=tuple(
                Signal(f"tank_{i}.level", "m", "", 0, 1, initial) for i in range(1, levels + 1)
            ),
            inputs=tuple(Signal(f"pump_{i}", "V", "", 0, 10, 5) for i in range(1, pumps + 1)),
            disturbances=tuple(
                Signal(f"inflow_{i}", "m^3/s", "", -1, 1) for i in range(1, inflows + 1)
            ),
            measurements=tuple(Signal(name, "m", "", -10, 10) for name in names),
            controlled=tuple(names[:pumps]),
            parameters=(),
            dynamics=ca.Function("dynamics", [x, u, d, p], [ca.vertcat(*rates(x, u, d))]),
            measure=ca.Function("measure", [x, p], [ca.vertcat(*shown)]),
            measured_state={},
            elements=(),
            nominal_outputs={},
            sampling_period=1.0,
        )

    return build


@pytest.fixture
def random_system() -> Callable[..., SimpleNamespace]:
    """Build A, B, C, D of a random stable system and its names, from a seed."""

    def build(seed: int, n: int, m: int, q: int, direct: bool = False) -> SimpleNamespace:
        numbers = np.random.default_rng(seed)
        A = numbers.standard_normal((n, n))
        A -= (np.linalg.eigvals(A).real.max() + 0.5) * np.eye(n)
        D = numbers.standard_normal((q, m)) if direct else np.zeros((q, m))
        B, C = numbers.standard_normal((n, m)), numbers.standard_normal((q, n))
        return SimpleNamespace(A=A, B=B, C=C, D=D)

    return build
