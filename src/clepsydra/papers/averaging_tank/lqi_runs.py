"""The controllers of Table 7: gains by the weights of (97a) to (101a), and their runs."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from clepsydra.designs.states.state_controllers import lqi_controller
from clepsydra.loop.run import Run
from clepsydra.papers.averaging_tank.model import KMOL, numbers
from clepsydra.papers.averaging_tank.step_run import (
    HORIZON,
    PERIOD,
    STEPS,
    indices,
    model_of,
    step_run,
)
from clepsydra.papers.averaging_tank.symbols import Variant


class Weights(NamedTuple):
    """A column of Table 7: where it is printed, what is constant, diagonals of Q and R."""

    place: str
    constant: Variant
    tuned: str
    states: tuple[float, float, float, float]
    inputs: tuple[float, float]

    @property
    def title(self) -> str:
        """As Table 7 has it."""
        return f"f_{'out' if self.constant == 'outflow' else 'in'} constant, {self.tuned}"


#: The last with the Q3 that its column of Table 7 needs.
COLUMNS = (
    Weights("(97a)", "outflow", "by hand", (2.0, 3.0, 10.0, 10.0), (1.0, 0.1)),
    Weights("(100a)", "outflow", "optimal", (1e-6, 0.1309, 12.04, 10.88), (1e-6, 1e-6)),
    Weights("(98a)", "inflow", "by hand", (3.0, 1.0, 10.0, 3.0), (2.0, 0.1)),
    Weights("(101a)", "inflow", "optimal", (1e-6, 0.3995, 10.92, 4.528), (0.0113, 1e-6)),
)
PRINTED_Q3 = COLUMNS[3]._replace(states=(1e-6, 0.3995, 0.1092, 4.528))


@cache
def gains(weights: Weights) -> np.ndarray:
    """Return [F Fi] [2, 4], inputs flow and C_in, states C, V and their integrals, in kmol.

    Examples
    --------
    >>> (gains(COLUMNS[0])[1].round(4) + 0.0).tolist()
    [13.8661, 0.0, 10.0, 0.0]
    """
    from scipy.linalg import solve_continuous_are

    A, B = numbers(weights.constant)
    whole = np.block([[A, np.zeros((2, 2))], [np.eye(2), np.zeros((2, 2))]])
    moved = np.vstack([B, np.zeros((2, 2))])
    R = np.diag(weights.inputs)
    cost = solve_continuous_are(whole, moved, np.diag(weights.states), R)
    return np.asarray(np.linalg.solve(R, moved.T @ cost))


@cache
def lqi_run(weights: Weights, period: float = PERIOD, horizon: float = HORIZON) -> Run:
    """Return the document's step under the gains of some weights, without anti-windup."""
    model = model_of(weights.constant, period)
    to_input, from_output = np.array([1.0, KMOL]), np.array([KMOL, 1.0])
    scaled = gains(weights).reshape(2, 2, 2) * to_input[:, None, None] / from_output
    controller = lqi_controller(
        f"LQI, {weights.tuned}", model, ("concentration", "volume"), scaled[:, 0], scaled[:, 1],
        [1.0, 1.0], "none",
    )  # fmt: skip
    return step_run(controller, model, (STEPS["C"], STEPS["V"]), horizon)


@cache
def indices_of(weights: Weights) -> dict[tuple[str, str], float]:
    """Return IE, IAE, ISE and ITAE of C and V, in kmol/m³ and m³."""
    return indices(lqi_run(weights))
