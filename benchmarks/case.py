"""The one problem that every way solves, and its plain NumPy solution to check them against.

Quadruple tank (Johansson 2000, doi 10.1109/87.845876, minimum phase), two sampled PI loops with
back-calculation, zero-order hold, one RK4 step a sample. In every sample k, for loop i:

    y = k_c h_i,  e = r - y,  v = K e + I,  u = min(max(v, 0), 10)
    IAE += |e| dt,  I += dt (K / T_i e + (u - v) / T_t)

and the levels go on by dt under u.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

SAMPLING_PERIOD = 1.0  # [s]
GRAVITY = 9.81  # [m/s^2]
SENSOR_GAIN = 50.0  # [V/m], 0.5 V/cm
LOW_LIMIT, HIGH_LIMIT = 0.0, 10.0  # [V]
STEP_SAMPLE = 100
NOMINAL_VOLTAGE = 3.0  # [V]
SETPOINT_STEPS = (2.5, 1.0)  # [V]; the first drives pump 1 into its upper limit
SPREAD = 0.05

#: One scenario's parameters, in the order in which every way receives them, SI.
NOMINAL: dict[str, float] = {
    "tank_area_1": 28e-4,
    "tank_area_2": 32e-4,
    "tank_area_3": 28e-4,
    "tank_area_4": 32e-4,
    "outlet_area_1": 0.071e-4,
    "outlet_area_2": 0.057e-4,
    "outlet_area_3": 0.071e-4,
    "outlet_area_4": 0.057e-4,
    "pump_gain_1": 3.33e-6,
    "pump_gain_2": 3.35e-6,
    "split_1": 0.70,
    "split_2": 0.60,
    "proportional_gain_1": 3.0,
    "proportional_gain_2": 2.7,
    "integral_time_1": 30.0,
    "integral_time_2": 40.0,
    "tracking_time_1": 30.0,
    "tracking_time_2": 40.0,
}

#: What scenarios have in common, unless each has its own, in SI.
INDIVIDUAL = (
    *(f"sensor_gain_{loop}" for loop in (1, 2)),
    *(f"initial_level_{tank}" for tank in (1, 2, 3, 4)),
    *(f"initial_integral_{loop}" for loop in (1, 2)),
)
#: What a batch returns for every scenario.
FINAL = (
    *(f"level_{tank}" for tank in (1, 2, 3, 4)),
    *(f"integral_{loop}" for loop in (1, 2)),
    *(f"integral_absolute_error_{loop}" for loop in (1, 2)),
)
#: What a single run records in every sample.
RECORDED = (*(f"level_{tank}" for tank in (1, 2, 3, 4)), "pump_1", "pump_2")


@dataclass(frozen=True)
class Case:
    """A batch of scenarios.

    Parameters
    ----------
    parameters : ndarray [18, scenarios]
        In the order of `NOMINAL`, SI.
    setpoints : ndarray [samples, 2]
        [V], shared by all scenarios.
    initial_levels : ndarray [4]
        [m], shared: the equilibrium of the nominal parameters.
    individual : ndarray [8, scenarios] or None
        In the order of `INDIVIDUAL`, where scenarios have sensors and a start of their own.
    """

    parameters: np.ndarray
    setpoints: np.ndarray
    initial_levels: np.ndarray
    individual: np.ndarray | None = None

    @property
    def scenarios(self) -> int:
        """Number of scenarios."""
        return self.parameters.shape[1]

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.setpoints)

    @property
    def scenario_steps(self) -> int:
        """Samples of all scenarios together."""
        return self.scenarios * self.samples

    def chosen(self, which: slice) -> Case:
        """Return some of the scenarios."""
        own = None if self.individual is None else self.individual[:, which]
        return replace(
            self,
            parameters=np.ascontiguousarray(self.parameters[:, which]),
            individual=None if own is None else np.ascontiguousarray(own),
        )

    def begin(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return sensor gains, levels and integrals of every scenario at the start."""
        if self.individual is not None:
            return self.individual[:2], self.individual[2:6], self.individual[6:]
        levels = np.tile(self.initial_levels[:, None], (1, self.scenarios))
        gains, integrals = (
            np.full((2, self.scenarios), value) for value in (SENSOR_GAIN, NOMINAL_VOLTAGE)
        )
        return gains, levels, integrals


@dataclass(frozen=True)
class Solution:
    """What a way found.

    Parameters
    ----------
    final : ndarray [8, scenarios]
        In the order of `FINAL`, after the last sample.
    recorded : ndarray [samples, 6] or None
        In the order of `RECORDED`, at the start of each sample; single runs only.
    """

    final: np.ndarray
    recorded: np.ndarray | None = None


def equilibrium() -> np.ndarray:
    """Return the levels [m] at the nominal voltages, in closed form."""
    p = NOMINAL
    flow_1, flow_2 = (p[f"pump_gain_{pump}"] * NOMINAL_VOLTAGE for pump in (1, 2))
    through = (
        p["split_1"] * flow_1 + (1 - p["split_2"]) * flow_2,
        p["split_2"] * flow_2 + (1 - p["split_1"]) * flow_1,
        (1 - p["split_2"]) * flow_2,
        (1 - p["split_1"]) * flow_1,
    )
    outlets = (p[f"outlet_area_{tank}"] for tank in (1, 2, 3, 4))
    return np.array(
        [
            (flow / outlet) ** 2 / (2 * GRAVITY)
            for flow, outlet in zip(through, outlets, strict=True)
        ]
    )


def make_case(scenarios: int, samples: int, seed: int = 20240229) -> Case:
    """Return a batch whose scenarios each have their own parameters, within 5 % of nominal.

    A single scenario has the nominal parameters.
    """
    nominal = np.array(list(NOMINAL.values()))[:, None]
    if scenarios == 1:
        parameters = nominal
    else:
        generator = np.random.Generator(np.random.PCG64(seed))
        parameters = nominal * generator.uniform(1 - SPREAD, 1 + SPREAD, (len(NOMINAL), scenarios))
    levels = equilibrium()
    setpoints = np.tile(SENSOR_GAIN * levels[:2], (samples, 1))
    setpoints[STEP_SAMPLE:] += SETPOINT_STEPS
    return Case(np.ascontiguousarray(parameters), setpoints, levels)


def solve(case: Case, noise: np.ndarray | None = None) -> Solution:
    """Solve a case with NumPy, all scenarios side by side, as the equations are printed.

    The noise [V] [samples, 2, scenarios] is added to what the controllers see, not to the errors
    that are summed.
    """
    p = dict(zip(NOMINAL, case.parameters, strict=True))
    tank_area = np.array([p[f"tank_area_{tank}"] for tank in (1, 2, 3, 4)])
    outlet_area = np.array([p[f"outlet_area_{tank}"] for tank in (1, 2, 3, 4)])

    def slope(levels: np.ndarray, voltages: np.ndarray) -> np.ndarray:
        out = outlet_area * np.sqrt(2 * GRAVITY * np.maximum(levels, 0.0))
        flow_1, flow_2 = p["pump_gain_1"] * voltages[0], p["pump_gain_2"] * voltages[1]
        into = np.array(
            [
                p["split_1"] * flow_1 + out[2],
                p["split_2"] * flow_2 + out[3],
                (1 - p["split_2"]) * flow_2,
                (1 - p["split_1"]) * flow_1,
            ]
        )
        return (into - out) / tank_area

    gain, integral_time, tracking_time = (
        np.array([p[f"{name}_{loop}"] for loop in (1, 2)])
        for name in ("proportional_gain", "integral_time", "tracking_time")
    )
    dt = SAMPLING_PERIOD
    sensor_gain, levels, integral = case.begin()
    absolute_error = np.zeros((2, case.scenarios))
    recorded = np.empty((case.samples, len(RECORDED)))
    for sample, setpoint in enumerate(case.setpoints):
        true_error = setpoint[:, None] - sensor_gain * levels[:2]
        error = true_error if noise is None else true_error - noise[sample]
        unlimited = gain * error + integral
        voltages = np.clip(unlimited, LOW_LIMIT, HIGH_LIMIT)
        recorded[sample] = [*levels[:, 0], *voltages[:, 0]]
        absolute_error += np.abs(true_error) * dt
        integral = integral + dt * (
            gain / integral_time * error + (voltages - unlimited) / tracking_time
        )
        k1 = slope(levels, voltages)
        k2 = slope(levels + dt / 2 * k1, voltages)
        k3 = slope(levels + dt / 2 * k2, voltages)
        k4 = slope(levels + dt * k3, voltages)
        levels = levels + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    final = np.concatenate([levels, integral, absolute_error])
    return Solution(final, recorded if case.scenarios == 1 else None)


def largest_difference(found: Solution, expected: Solution) -> float:
    """Return the largest relative difference, each signal by its own largest magnitude."""
    pairs = [(found.final, expected.final)]
    if found.recorded is not None and expected.recorded is not None:
        pairs.append((found.recorded.T, expected.recorded.T))
    return max(float(np.max(np.abs(a - b).max(axis=1) / np.abs(b).max(axis=1))) for a, b in pairs)
