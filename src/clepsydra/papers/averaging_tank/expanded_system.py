"""Section 3.2: which inputs LQI may have, and when the expanded system is controllable."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_continuous_are

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, Weights, weighed
from clepsydra.papers.averaging_tank.model import numbers
from clepsydra.papers.averaging_tank.step_run import MEASURED
from clepsydra.papers.averaging_tank.symbols import VARIANTS, balances, constant_flow, plant
from clepsydra.papers.document import Found
from clepsydra.papers.printed_table import entries
from clepsydra.papers.rational_function import symbols
from clepsydra.papers.row import Row, Rows

#: Two states and the integrals of two errors.
_WHOLE = 4


def run() -> Found:
    """Return the rows on inputs and controllability."""
    return (*_inputs(), _conditions(), *_controllability())


def _rank(A: np.ndarray, B: np.ndarray) -> int:
    """Return the rank of [A B; C 0], whose outputs are the states."""
    return int(np.linalg.matrix_rank(np.block([[A, B], [np.eye(len(A)), np.zeros_like(B)]])))


def _rank_of_expanded(A: np.ndarray, B: np.ndarray, C: np.ndarray) -> int:
    """Return the rank of the controllability matrix with the integrals of the outputs."""
    none = np.zeros((len(C), len(C)))
    whole = np.block([[A, np.zeros((len(A), len(C)))], [C, none]])
    reached = [np.vstack([B, np.zeros((len(C), B.shape[1]))])]
    for _ in range(len(whole) - 1):
        reached.append(whole @ reached[-1])
    return int(np.linalg.matrix_rank(np.hstack(reached)))


def _rank_of_primary(A: np.ndarray, B: np.ndarray) -> int:
    return int(np.linalg.matrix_rank(np.hstack([B, A @ B])))


def _every_input() -> tuple[np.ndarray, np.ndarray]:
    """Return A, and B with the columns f_in, f_out and C_in."""
    (A, by_inflow), (_, by_outflow) = (numbers(variant) for variant in VARIANTS)
    return A, np.column_stack([by_inflow[:, 0], by_outflow[:, 0], by_inflow[:, 1]])


def _primary_pole(A: np.ndarray, B: np.ndarray, weights: Weights) -> float:
    """Return the rightmost pole [1/s] of the LQR of the primary system, by the weights of it."""
    R = np.diag(weights.inputs)
    cost = solve_continuous_are(A, B, np.diag(weights.states[:2]), R)
    return float(np.linalg.eigvals(A - B @ np.linalg.solve(R, B.T @ cost)).real.max())


def _inputs() -> Rows:
    """Judge the number of inputs, and what a constant C_in would leave."""
    A, B = _every_input()
    flow, inlet = COLUMNS[0].inputs
    weights = COLUMNS[0]._replace(inputs=(flow, flow, inlet))
    F = weighed(weights, A, B)
    closed = np.block([[A - B @ F[:, :2], -B @ F[:, 2:]], [np.eye(2), np.zeros((2, 2))]])
    right, rank = float(np.linalg.eigvals(closed).real.max()), _rank(A, B)
    primary, rank_of_two = _primary_pole(A, B, weights), _rank_of_primary(A, B)
    yield PRINTED["section 3.2", "number of inputs"].claimed(
        not (rank == _WHOLE and rank_of_two == 2 and max(right, primary) < 0.0),
        f"with f_in, f_out and C_in rank {rank} of {_WHOLE}, and all poles of the LQR left of "
        f"{right:.2f} 1/s; without the integrals, with two states, rank {rank_of_two} of 2, and "
        f"left of {primary:.2f} 1/s",
    )
    of_primary = _rank_of_primary(A, B[:, :2])
    (C,) = symbols("C")
    slope = balances()[0].with_values({"C_in": C})
    yield PRINTED["section 3.2", "constant C_in"].claimed(
        of_primary < 2 and slope == 0,
        f"with f_in and f_out rank {of_primary} of 2; dC/dt = {slope} at C = C_in0",
    )


def _conditions() -> Row:
    """Judge the two conditions as necessary ones, and as sufficient ones."""
    A, B = _every_input()
    without = {"f_in alone": B[:, :1], "C_in alone": B[:, 2:], "C_in constant": B[:, :2]}
    ranks = ", ".join(
        f"{_rank_of_expanded(A, some, np.eye(2))} with {name}" for name, some in without.items()
    )
    A, B, C = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.array([[0.0, 1.0]])
    primary, rank = _rank_of_primary(A, B), _rank_of_expanded(A, B, C)
    return PRINTED["section 3.2", "conditions of controllability"].remark(
        f"necessary: the expanded system has rank, of {_WHOLE}, {ranks}; sufficient: "
        f"x1' = x2, x2' = u with the output x2 meets both, rank {primary} of 2, and "
        f"its expanded system has rank {rank} of 3"
    )


def _controllability() -> Rows:
    variants = tuple(zip(("(94)", "(96)"), VARIANTS, strict=True))
    for place, variant in variants:
        found = plant(variant)
        yield from PRINTED.formulas(place, entries("M", np.hstack([found.B, found.A @ found.B])))
    A, B = numbers("outflow")
    flat = (
        "A of (32) and (34), the primary system of the sentence, has a row of zeros",
        not A[1].any(),
    )
    rank, whole = int(np.linalg.matrix_rank(A)), np.vstack([np.hstack([A, 0.0 * A]), np.eye(2, 4)])
    expanded = (
        "A_roz of (92) has rank 2, but the sentence is on the primary system, whose M_CK is [B AB]",
        np.linalg.matrix_rank(whole) == 2,
    )
    line = PRINTED["(94), (96)", "rank of A"]
    yield line.compared(float(rank), right_if=[flat, expanded])
    yield PRINTED["(94), (96)", "rank(u)"].compared(B.shape[1])
    yield PRINTED["(94), (96)", "rank(y)"].compared(len(MEASURED))
    for place, variant in variants:
        A, B = numbers(variant)
        yield from PRINTED.compared(place, {"rank of M": _rank_of_primary(A, B)})
    ranks = {constant_flow(variant): _rank(*numbers(variant)) for variant in VARIANTS}
    yield PRINTED["(94), (96)", "the expanded system"].claimed(
        set(ranks.values()) == {_WHOLE},
        ", ".join(f"rank {rank} of {_WHOLE} with {flow}" for flow, rank in ranks.items()),
    )
