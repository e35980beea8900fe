"""The averaging tank of the first document by SciPy alone, in continuous time, for tests."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_are

#: Where it rests, C [kmol/m³] and V [m³], and how far both step.
REST, STEP = np.array([5.0, 2.0]), np.array([0.25, 0.1])
RANGES = ((0.0, 1.0), (0.0, 25.0))
#: Of settling, both usual ones [share of a step].
BANDS = (0.02, 0.05)
#: As good as none.
FREE = (-1e9, 1e9)
#: Errors, and the sums of them, to the flow that moves V and C_in before their limits.
Law = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[float, float]]


class Stepped(NamedTuple):
    """The step of both references."""

    time: np.ndarray
    outputs: np.ndarray  # C and V
    inputs: np.ndarray  # the flow that is moved, and C_in
    sums: dict[tuple[str, str], float]

    def settles(self, output: int, band: float = 0.02) -> float:
        """When an output stays within a share of its step."""
        outside = np.abs(self._share(output) - 1.0) > band
        return float(self.time[np.flatnonzero(outside)[-1]])

    def rises(self, output: int) -> float:
        """From when to when an output covers 10 to 90 % of its step."""
        share = self._share(output)
        return float(self.time[np.argmax(share >= 0.9)] - self.time[np.argmax(share >= 0.1)])

    def overshoots(self, output: int) -> float:
        """How far an output passes its reference [% of the step]."""
        return 100.0 * max(0.0, float(self._share(output).max()) - 1.0)

    def _share(self, output: int) -> np.ndarray:
        return (self.outputs[output] - REST[output]) / STEP[output]


def stepped(
    constant: str, law: Law, horizon: float = 4.0, ranges=RANGES, points: int = 20001
) -> Stepped:
    """Step both references under a law, with "f_out" or "f_in" constant."""

    def inputs(x):
        errors = REST + STEP - x[:2]
        moved = law(x[:2] - REST, errors, x[2:4])
        return [np.clip(each, *limits) for each, limits in zip(moved, ranges, strict=True)]

    def slope(t, x):
        flow, inlet = inputs(x)
        inflow, outflow = (flow, 0.2) if constant == "f_out" else (0.2, flow)
        errors = REST + STEP - x[:2]
        rates = inflow / x[1] * (inlet - x[0]), inflow - outflow
        return *rates, *errors, *np.abs(errors), *errors**2, *(t * np.abs(errors))

    time = np.linspace(0.0, horizon, points)
    start = [*REST, *np.zeros(8)]
    found = solve_ivp(
        slope, (0.0, horizon), start, "LSODA", time, rtol=1e-9, atol=1e-12, max_step=1e-3
    ).y
    names = [(index, output) for index in ("IE", "IAE", "ISE", "ITAE") for output in "CV"]
    sums = dict(zip(names, found[2:, -1], strict=True))
    return Stepped(time, found[:2], np.array([inputs(x) for x in found.T]).T, sums)


def pi_law(constant: str, gain_c: float, time_c: float, gain_v: float, time_v: float) -> Law:
    """PI control of C by C_in and of V by the flow, on deviations."""
    sign = 1.0 if constant == "f_out" else -1.0

    def law(deviations, errors, summed):
        flow = 0.2 + sign * gain_v * (errors[1] + summed[1] / time_v)
        return flow, 5.0 + gain_c * (errors[0] + summed[0] / time_c)

    return law


def lqi_law(constant: str, states, inputs) -> Law:
    """LQI by diagonal weights: deviations and minus the summed errors, fed back."""
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    A[0, 0], A[2, 0], A[3, 1], B[0, 1] = -0.1, 1.0, 1.0, 0.1
    B[1, 0] = 1.0 if constant == "f_out" else -1.0
    R = np.diag(inputs)
    gains = np.linalg.solve(R, B.T @ solve_continuous_are(A, B, np.diag(states), R))

    def law(deviations, errors, summed):
        moved = -gains @ [*deviations, *-summed]
        return 0.2 + moved[0], 5.0 + moved[1]

    return law
