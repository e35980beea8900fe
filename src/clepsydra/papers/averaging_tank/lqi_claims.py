"""Section 4: what the document says of LQI control, by either flow and by either tuning."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, Weights, indices_of, lqi_run
from clepsydra.papers.averaging_tank.model import KMOL
from clepsydra.papers.averaging_tank.printed_tables import lower_cells, printed_indices
from clepsydra.papers.averaging_tank.step_run import settling
from clepsydra.papers.averaging_tank.symbols import balances
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row, Rows

#: Pairs of columns: the same tuning with either flow constant; optimal after by hand.
_BY_FLOW, _BY_TUNING = ((0, 2), (1, 3)), ((1, 0), (3, 2))


def run() -> Found:
    """Return the rows on what is said of LQI control."""
    return (*_which_flow(), *_indices(), _effort())


def _which_flow() -> Rows:
    """Judge what is said of constant outflow beside constant inflow."""
    settled = {o: [settling(lqi_run(column), o) for column in COLUMNS] for o in ("C", "V")}
    inlet = [_highest(column, "inflow.impurity") / KMOL for column in COLUMNS]
    told = [
        f"{tuned}: C settles in {settled['C'][out]:.2f} s against {settled['C'][other]:.2f} s, V "
        f"in {settled['V'][out]:.2f} s against {settled['V'][other]:.2f} s, C_in to "
        f"{inlet[out]:.1f} against {inlet[other]:.1f} kmol/m³"
        for tuned, (out, other) in zip(("by hand", "optimal"), _BY_FLOW, strict=True)
    ]
    yield PRINTED["section 4", "LQI, best with f_out constant"].remark("; ".join(told))
    yield _reason()
    ratios = [settled["V"][other] / settled["V"][out] for out, other in _BY_FLOW]
    yield PRINTED["section 4", "settling time of V, LQI"].remark(
        f"{ratios[1]:.2f} times optimal, {ratios[0]:.2f} times by hand"
    )


def _reason() -> Row:
    """Tell what the flows act on, and how both systems settle by one choice of weights."""
    of_c, _ = balances()
    direct, other, by_volume = (of_c.derivative(name) for name in ("f_in", "f_out", "V"))
    told = []
    for weights in COLUMNS:
        out, into = (lqi_run(weights._replace(constant=each)) for each in ("outflow", "inflow"))
        told.append(
            f"with {weights.place} C in {settling(out, 'C'):.2f} s against "
            f"{settling(into, 'C'):.2f} s, V in {settling(out, 'V'):.2f} s against "
            f"{settling(into, 'V'):.2f} s"
        )
    return PRINTED["section 4", "LQI, what the flows act on"].remark(
        f"derivatives of dC/dt: {direct} by f_in, {other} by f_out, {by_volume} by V; "
        f"settled with f_out constant against f_in constant: {'; '.join(told)}"
    )


def _indices() -> Rows:
    """Compare the indices by flow and by tuning."""
    computed = [indices_of(column) for column in COLUMNS]
    printed = [printed_indices("Table 7", column.title) for column in COLUMNS]
    by_flow, by_tuning = (
        [
            sum(len(lower_cells(each[one], each[other])) for one, other in pairs)
            for each in (computed, printed)
        ]
        for pairs in (_BY_FLOW, _BY_TUNING)
    )
    yield PRINTED["section 4", "LQI, which flow"].remark(
        f"{by_flow[0]} of 16 pairs computed and {by_flow[1]} of 16 printed, without ISEG"
    )
    yield PRINTED["section 4", "LQI, optimisation"].claimed(
        by_tuning == [16, 16], f"{by_tuning[0]} of 16 pairs computed and {by_tuning[1]} printed"
    )


def _highest(column: Weights, name: str) -> float:
    return float(lqi_run(column).values[name].max())


def _effort() -> Row:
    """Tell the largest inputs by hand and by the optimum."""
    flows = [max(_highest(column, name) for name in ("inflow", "outflow")) for column in COLUMNS]
    swings = [
        max(float(np.ptp(lqi_run(column).values[name])) for name in ("inflow", "outflow"))
        for column in COLUMNS
    ]
    inlet = [_highest(column, "inflow.impurity") / KMOL for column in COLUMNS]
    return PRINTED["section 4", "control effort, LQI"].remark(
        f"f_in to {flows[1]:.2f} against {flows[0]:.2f} m³/s by hand, C_in to {inlet[1]:.1f} "
        f"against {inlet[0]:.1f} kmol/m³; f_out, with f_in constant, to {flows[3]:.3f} against "
        f"{flows[2]:.3f} m³/s",
        by_optimum=swings[3],
        by_hand=swings[2],
    )
