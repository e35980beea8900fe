"""The controllers of Table 7: gains by the weights of (97a) to (101a), and their runs."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.states.state_controllers import lqi_controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.run import Run
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.model import KMOL, numbers
from clepsydra.papers.averaging_tank.step_run import (
    HORIZON,
    PERIOD,
    STEPS,
    indices,
    model_of,
    step_run,
)
from clepsydra.papers.averaging_tank.symbols import Variant, constant_flow


class Weights(NamedTuple):
    """A column of Table 7: where it is printed, what is constant, diagonals of Q and R."""

    place: str
    constant: Variant
    tuned: str
    states: tuple[float, float, float, float]
    inputs: tuple[float, ...]

    @property
    def title(self) -> str:
        """As Table 7 has it."""
        return f"{constant_flow(self.constant)}, {self.tuned}"

    def with_third(self, q3: float) -> Weights:
        """Return them with another Q3."""
        q1, q2, _, q4 = self.states
        return self._replace(states=(q1, q2, q3, q4))


def _printed(place: str, constant: Variant, tuned: str) -> Weights:
    q1, q2, q3, q4, r1, r2 = PRINTED.numbers(place, "Q1", "Q2", "Q3", "Q4", "R1", "R2")
    return Weights(place, constant, tuned, (q1, q2, q3, q4), (r1, r2))


PRINTED_Q3 = _printed("(101a)", "inflow", "optimal")
#: The last with the Q3 that its column of Table 7 needs.
COLUMNS = (
    _printed("(97a)", "outflow", "by hand"),
    _printed("(100a)", "outflow", "optimal"),
    _printed("(98a)", "inflow", "by hand"),
    PRINTED_Q3.with_third(10.92),
)


@cache
def gains(weights: Weights) -> np.ndarray:
    """Return [F Fi] [2, 4], inputs flow and C_in, states C, V and their integrals, in kmol.

    Examples
    --------
    >>> (gains(COLUMNS[0])[1].round(4) + 0.0).tolist()
    [13.8661, 0.0, 10.0, 0.0]
    """
    return weighed(weights, *numbers(weights.constant))


def weighed(weights: Weights, A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Return [F Fi] [m, 4] of a model with m inputs, by the Riccati equation of (87)."""
    from scipy.linalg import solve_continuous_are

    whole = np.block([[A, np.zeros((2, 2))], [np.eye(2), np.zeros((2, 2))]])
    moved = np.vstack([B, np.zeros_like(B)])
    R = np.diag(weights.inputs)
    cost = solve_continuous_are(whole, moved, np.diag(weights.states), R)
    return np.asarray(np.linalg.solve(R, moved.T @ cost))


def in_moles(found: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F and Fi of [F Fi] in mol, as the process has it."""
    scale = np.array([[1.0], [KMOL]]) / np.array([KMOL, 1.0])
    return scale * found[:, :2], scale * found[:, 2:]


def lqi_of(weights: Weights, model: LinearModel, summed: float = 0.0) -> Controller:
    """Return the document's controller by some weights, without anti-windup.

    Its sum for the integral ends at the error before the present one, which enters it for a time
    `summed` [s]: for a sampling period where it belongs to the sum.
    """
    found = gains(weights)
    found = np.hstack([found[:, :2] + summed * found[:, 2:], found[:, 2:]])
    return lqi_controller(
        f"LQI, {weights.tuned}",
        model,
        ("concentration", "volume"),
        *in_moles(found),
        [1.0, 1.0],
        "none",
    )


@cache
def lqi_run(weights: Weights, period: float = PERIOD, horizon: float = HORIZON) -> Run:
    """Return the document's step under the gains of some weights."""
    model = model_of(weights.constant, period)
    return step_run(lqi_of(weights, model), model, (STEPS["C"], STEPS["V"]), horizon)


@cache
def indices_of(weights: Weights) -> dict[tuple[str, str], float]:
    """Return IE, IAE, ISE and ITAE of C and V, in kmol/m³ and m³."""
    return indices(lqi_run(weights))
