"""One run of the case in python-control's nonlinear simulation.

A sampled controller cannot stand beside a continuous process in one python-control system, so
its users have two ways to the same answer: write process and controller together as one
discrete-time system whose update makes the RK4 step (`one_system`), or write each as a
discrete-time system and let `interconnect` join them (`joined_systems`).
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any

import numpy as np

from benchmarks.case import (
    GRAVITY,
    HIGH_LIMIT,
    LOW_LIMIT,
    NOMINAL,
    NOMINAL_VOLTAGE,
    SAMPLING_PERIOD,
    SENSOR_GAIN,
    Case,
    Solution,
)


def version() -> str:
    """Return python-control's version."""
    import control

    return str(control.__version__)


class _Equations:
    """The equations in plain Python numbers, the fastest form for four tanks in Python."""

    def __init__(self, case: Case) -> None:
        p = dict(zip(NOMINAL, case.parameters[:, 0].tolist(), strict=True))
        fall = sqrt(2 * GRAVITY)
        self.out = [fall * p[f"outlet_area_{t}"] / p[f"tank_area_{t}"] for t in (1, 2, 3, 4)]
        self.upper = [
            fall * p["outlet_area_3"] / p["tank_area_1"],
            fall * p["outlet_area_4"] / p["tank_area_2"],
        ]
        self.into = [
            p["split_1"] * p["pump_gain_1"] / p["tank_area_1"],
            p["split_2"] * p["pump_gain_2"] / p["tank_area_2"],
            (1 - p["split_2"]) * p["pump_gain_2"] / p["tank_area_3"],
            (1 - p["split_1"]) * p["pump_gain_1"] / p["tank_area_4"],
        ]
        self.loops = [
            (
                p[f"proportional_gain_{loop}"],
                p[f"proportional_gain_{loop}"] / p[f"integral_time_{loop}"],
                p[f"tracking_time_{loop}"],
            )
            for loop in (1, 2)
        ]

    def control(self, loop: int, level: float, integral: float, setpoint: float) -> Any:
        """Return error, unlimited and limited output [V]."""
        error = setpoint - SENSOR_GAIN * level
        unlimited = self.loops[loop][0] * error + integral
        return error, unlimited, min(max(unlimited, LOW_LIMIT), HIGH_LIMIT)

    def next_integral(
        self, loop: int, integral: float, error: float, unlimited: float, voltage: float
    ) -> float:
        """Return the integral [V] after the sample."""
        _, integral_gain, tracking_time = self.loops[loop]
        return integral + SAMPLING_PERIOD * (
            integral_gain * error + (voltage - unlimited) / tracking_time
        )

    def next_levels(
        self, h1: float, h2: float, h3: float, h4: float, u1: float, u2: float
    ) -> list[float]:
        """Return the levels [m] after one RK4 step."""
        (o1, o2, o3, o4), (g1, g2), (i1, i2, i3, i4) = self.out, self.upper, self.into
        q1, q2, q3, q4 = i1 * u1, i2 * u2, i3 * u2, i4 * u1

        def slope(h1: float, h2: float, h3: float, h4: float) -> tuple[float, float, float, float]:
            r3, r4 = sqrt(max(h3, 0.0)), sqrt(max(h4, 0.0))
            return (
                q1 - o1 * sqrt(max(h1, 0.0)) + g1 * r3,
                q2 - o2 * sqrt(max(h2, 0.0)) + g2 * r4,
                q3 - o3 * r3,
                q4 - o4 * r4,
            )

        half, sixth = SAMPLING_PERIOD / 2, SAMPLING_PERIOD / 6
        a1, a2, a3, a4 = slope(h1, h2, h3, h4)
        b1, b2, b3, b4 = slope(h1 + half * a1, h2 + half * a2, h3 + half * a3, h4 + half * a4)
        c1, c2, c3, c4 = slope(h1 + half * b1, h2 + half * b2, h3 + half * b3, h4 + half * b4)
        full = SAMPLING_PERIOD
        d1, d2, d3, d4 = slope(h1 + full * c1, h2 + full * c2, h3 + full * c3, h4 + full * c4)
        return [
            h1 + sixth * (a1 + 2 * (b1 + c1) + d1),
            h2 + sixth * (a2 + 2 * (b2 + c2) + d2),
            h3 + sixth * (a3 + 2 * (b3 + c3) + d3),
            h4 + sixth * (a4 + 2 * (b4 + c4) + d4),
        ]


def _start(case: Case) -> np.ndarray:
    return np.concatenate([case.initial_levels, [NOMINAL_VOLTAGE] * 2, [0.0] * 2])


def _last_sample(update: Callable[..., Any], case: Case, states: np.ndarray) -> np.ndarray:
    # A response ends with the state at the start of its last sample; the benchmark's answer is
    # one sample later.
    return np.array(update(0.0, states[:, -1], case.setpoints[-1], None))[:, None]


def one_system(case: Case) -> Callable[[], Solution]:
    """Return a call that simulates process and controllers written as one discrete system."""
    import control

    equations = _Equations(case)

    def update(t: float, x: np.ndarray, r: np.ndarray, params: Any) -> list[float]:
        h1, h2, h3, h4, integral_1, integral_2, absolute_1, absolute_2 = x.tolist()
        r1, r2 = r.tolist()
        e1, v1, u1 = equations.control(0, h1, integral_1, r1)
        e2, v2, u2 = equations.control(1, h2, integral_2, r2)
        return [
            *equations.next_levels(h1, h2, h3, h4, u1, u2),
            equations.next_integral(0, integral_1, e1, v1, u1),
            equations.next_integral(1, integral_2, e2, v2, u2),
            absolute_1 + SAMPLING_PERIOD * abs(e1),
            absolute_2 + SAMPLING_PERIOD * abs(e2),
        ]

    def output(t: float, x: np.ndarray, r: np.ndarray, params: Any) -> list[float]:
        h1, h2, h3, h4, integral_1, integral_2, _, _ = x.tolist()
        r1, r2 = r.tolist()
        u1 = equations.control(0, h1, integral_1, r1)[2]
        u2 = equations.control(1, h2, integral_2, r2)[2]
        return [h1, h2, h3, h4, u1, u2]

    system = control.NonlinearIOSystem(
        update, output, inputs=2, outputs=6, states=8, dt=SAMPLING_PERIOD
    )
    time = np.arange(case.samples) * SAMPLING_PERIOD

    def run() -> Solution:
        response = control.input_output_response(
            system, time, case.setpoints.T, _start(case), return_states=True
        )
        return Solution(_last_sample(update, case, response.states), response.outputs.T)

    return run


def joined_systems(case: Case) -> Callable[[], Solution]:
    """Return a call that simulates a tank system and a controller system, interconnected."""
    import control

    equations = _Equations(case)

    def tanks(t: float, x: np.ndarray, u: np.ndarray, params: Any) -> list[float]:
        return equations.next_levels(*x.tolist(), *u.tolist())

    def controllers(t: float, x: np.ndarray, u: np.ndarray, params: Any) -> list[float]:
        integrals, absolutes, setpoints, levels = x[:2], x[2:], u[:2], u[2:]
        following, errors = [], []
        for loop in (0, 1):
            e, v, voltage = equations.control(
                loop, float(levels[loop]), float(integrals[loop]), float(setpoints[loop])
            )
            following.append(equations.next_integral(loop, float(integrals[loop]), e, v, voltage))
            errors.append(float(absolutes[loop]) + SAMPLING_PERIOD * abs(e))
        return following + errors

    def voltages(t: float, x: np.ndarray, u: np.ndarray, params: Any) -> list[float]:
        return [
            equations.control(loop, float(u[2 + loop]), float(x[loop]), float(u[loop]))[2]
            for loop in (0, 1)
        ]

    process = control.NonlinearIOSystem(
        tanks,
        lambda t, x, u, params: x,
        name="tanks",
        inputs=["u1", "u2"],
        outputs=["h1", "h2", "h3", "h4"],
        states=4,
        dt=SAMPLING_PERIOD,
    )
    controller = control.NonlinearIOSystem(
        controllers,
        voltages,
        name="controllers",
        inputs=["r1", "r2", "h1", "h2"],
        outputs=["u1", "u2"],
        states=4,
        dt=SAMPLING_PERIOD,
    )
    joined = control.interconnect(
        [process, controller],
        inputs=["r1", "r2"],
        outputs=["h1", "h2", "h3", "h4", "u1", "u2"],
        dt=SAMPLING_PERIOD,
    )
    time = np.arange(case.samples) * SAMPLING_PERIOD

    def run() -> Solution:
        response = control.input_output_response(
            joined, time, case.setpoints.T, _start(case), return_states=True
        )
        final = _last_sample(joined.updfcn, case, response.states)
        return Solution(final, response.outputs.T)

    return run
