"""Large steps of the first document's tank under gains that change with it, by NumPy alone."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_continuous_are, solve_discrete_are

REST = np.array([[5.0], [2.0]])  # C [kmol/m³] and V [m³]
FLOW, INLET = 0.2, 5.0  # [m³/s], [kmol/m³]
STEPS = ((2.5, 0), (-2.5, 0), (0, 1), (0, -1), (2.5, 1), (-2.5, 1), (2.5, -1), (-2.5, -1), (3, 2))
VOLUMES = np.array([0.5, 1.0, 2.0, 3.0, 4.0, 5.0])
#: K_pC, T_iC, K_pV and T_iV by hand, (80) and (82); diagonals of Q and R, (97a) and (98a).
PI = {"f_out": (50.0, 1.0, 8.0, 2.0), "f_in": (50.0, 10.0, 5.0, 30.0)}
WEIGHTS = {
    "f_out": ((2.0, 3.0, 10.0, 10.0), (1.0, 0.1)),
    "f_in": ((3.0, 1.0, 10.0, 3.0), (2.0, 0.1)),
}
PERIOD, HORIZON, FOLLOWS = 0.01, 30.0, 10.0  # [s]
#: C and V [2, n], the inputs as they are followed [2, n], to gains of deviation and integral
#: [n, 2, 2] each.
Gains = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class Law(NamedTuple):
    """What is fed back by gains, and whether it is the error: PI control, and LQI the state."""

    gains: Gains
    feeds_error: bool


def _sign(constant: str) -> float:
    return 1.0 if constant == "f_out" else -1.0


def scheduled_pi(constant: str) -> Law:
    gain_c, time_c, gain_v, time_v = PI[constant]

    def gains(outputs, inputs):
        proportional = np.zeros((outputs.shape[1], 2, 2))
        proportional[:, 0, 1] = _sign(constant) * gain_v
        proportional[:, 1, 0] = gain_c * np.clip(outputs[1], VOLUMES[0], VOLUMES[-1]) / 2.0
        return proportional, proportional / np.array([time_c, time_v])

    return Law(gains, feeds_error=True)


def scheduled_lqi(constant: str) -> Law:
    states, weights = WEIGHTS[constant]
    R, table = np.diag(weights), []
    for volume in VOLUMES:
        A, B = np.zeros((4, 4)), np.zeros((4, 2))
        A[0, 0], A[2, 0], A[3, 1] = -FLOW / volume, 1.0, 1.0
        B[0, 1], B[1, 0] = FLOW / volume, _sign(constant)
        table.append(np.linalg.solve(R, B.T @ solve_continuous_are(A, B, np.diag(states), R)))

    def gains(outputs, inputs):
        found = [
            [np.interp(outputs[1], VOLUMES, [each[i, j] for each in table]) for j in range(4)]
            for i in range(2)
        ]
        found = np.moveaxis(np.array(found), 2, 0)
        return found[:, :, :2], found[:, :, 2:]

    return Law(gains, feeds_error=False)


def recomputed_lqi(constant: str, lanes: int = 2 * len(STEPS)) -> Law:
    """One step of the Riccati difference equation a sample, on the model where the tank is."""
    states, weights = WEIGHTS[constant]
    Q, R = np.diag(states) * PERIOD, np.diag(weights) * PERIOD

    def model(outputs, inputs):
        of_c, of_v = outputs[0], np.maximum(outputs[1], 0.02)
        flow = inputs[0] if constant == "f_out" else np.full(lanes, FLOW)
        A, B = np.zeros((lanes, 4, 4)), np.zeros((lanes, 4, 2))
        A[:, 0, 0], A[:, 0, 1] = -flow / of_v, -flow * (inputs[1] - of_c) / of_v**2
        A[:, 2, 0] = A[:, 3, 1] = 1.0
        B[:, 0, 1], B[:, 1, 0] = flow / of_v, _sign(constant)
        if constant == "f_out":
            B[:, 0, 0] = (inputs[1] - of_c) / of_v
        held = PERIOD * np.eye(4) + PERIOD**2 / 2.0 * A + PERIOD**3 / 6.0 * A @ A
        return np.eye(4) + A @ held, held @ B

    start = np.tile([[FLOW], [INLET]], lanes)
    A, B = model(np.tile(REST, lanes), start)
    cost = [np.tile(solve_discrete_are(A[0], B[0], Q, R), (lanes, 1, 1))]

    def gains(outputs, inputs):
        A, B = model(outputs, inputs)
        moved = B.transpose(0, 2, 1) @ cost[0]
        K = np.linalg.solve(R + moved @ B, moved @ A)
        P = Q + A.transpose(0, 2, 1) @ cost[0] @ (A - B @ K)
        cost[0] = 0.5 * (P + P.transpose(0, 2, 1))
        return K[:, :, :2], K[:, :, 2:]

    return Law(gains, feeds_error=False)


def costs(
    constant: str, law: Law, sizes: Sequence[tuple[float, float]], velocity: bool
) -> np.ndarray:
    """∫ |e| dt over the size of each step, the mean of C and V where both step.

    In velocity form a new gain alone does not move an input; in position form it does. Errors are
    fed back under PI control, deviations from rest under LQI, which a step does not move.
    """
    steps = np.array(sizes, float).T
    lanes = steps.shape[1]
    outputs, summed = np.tile(REST, lanes), np.zeros((2, lanes))
    followed, errors = np.tile([[FLOW], [INLET]], lanes), []
    taken, before, fed = np.zeros((2, lanes)), None, np.zeros((2, lanes))
    for _ in range(round(HORIZON / PERIOD) + 1):
        error = REST + steps - outputs
        errors.append(np.abs(error))
        direct, integral = law.gains(outputs, followed)
        now = error if law.feeds_error else REST - outputs
        # The sum takes up what the changed gain alone would do: to the last error, or the state.
        if velocity and before is not None:
            at = fed if law.feeds_error else now
            taken = taken - np.einsum("lij,jl->il", direct - before, at)
        before, fed = direct, now
        sums = taken if velocity else np.einsum("lij,jl->il", integral, summed)
        moved = np.array([[FLOW], [INLET]]) + np.einsum("lij,jl->il", direct, fed) + sums
        flow, inlet = np.clip(moved[0], 0.0, 1.0), np.clip(moved[1], 0.0, 25.0)
        taken = taken + PERIOD * np.einsum("lij,jl->il", integral, error)
        summed = summed + PERIOD * error
        followed = followed + (np.array([flow, inlet]) - followed) * PERIOD / FOLLOWS
        rest = np.full(lanes, FLOW)
        into, out = (flow, rest) if constant == "f_out" else (rest, flow)
        outputs = _held(outputs, into, out, inlet)
    area = np.trapezoid(np.array(errors), dx=PERIOD, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nanmean(np.where(steps != 0.0, area / np.abs(steps), np.nan), axis=0)


def ratios(constant: str, law: Law, velocity: bool) -> np.ndarray:
    """What each of `STEPS` costs beside 0.25 kmol/m³ and 0.1 m³ in its directions."""
    small = [(0.25 * np.sign(of_c), 0.1 * np.sign(of_v)) for of_c, of_v in STEPS]
    found = costs(constant, law, [*STEPS, *small], velocity)
    return found[: len(STEPS)] / found[len(STEPS) :]


def _held(outputs, into, out, inlet, parts: int = 4):
    """C and V after a sample with held inputs, by Runge and Kutta."""
    of_c, of_v = outputs
    h = PERIOD / parts
    for _ in range(parts):
        ends = of_v + h * (into - out)
        rate = np.where((ends < 1e-6) | (ends > 6.0), 0.0, into - out)

        def slope(c, v):
            return into * (inlet - c) / v

        first = slope(of_c, of_v)
        second = slope(of_c + h / 2.0 * first, of_v + h / 2.0 * rate)
        third = slope(of_c + h / 2.0 * second, of_v + h / 2.0 * rate)
        last = slope(of_c + h * third, of_v + h * rate)
        of_c = of_c + h / 6.0 * (first + 2.0 * second + 2.0 * third + last)
        of_v = of_v + h * rate
    return np.array([of_c, of_v])
