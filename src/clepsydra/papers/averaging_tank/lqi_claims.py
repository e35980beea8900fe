"""Section 4: what the document says of LQI control, by either flow and by either tuning."""

from __future__ import annotations

from functools import partial

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, Weights, indices_of, lqi_run
from clepsydra.papers.averaging_tank.model import KMOL
from clepsydra.papers.averaging_tank.printed_tables import lower_cells, printed_indices
from clepsydra.papers.averaging_tank.step_run import settling, settling_words
from clepsydra.papers.averaging_tank.symbols import balances
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.settling_bands import BANDS

#: Pairs of columns: the same tuning with either flow constant; optimal after by hand.
_BY_FLOW, _BY_TUNING = ((0, 2), (1, 3)), ((1, 0), (3, 2))


def run() -> Found:
    """Return the rows on what is said of LQI control."""
    return (*_which_flow(), *_indices(), _effort())


def _which_flow() -> Rows:
    """Judge what is said of constant outflow beside constant inflow."""
    settles = [partial(settling, lqi_run(column)) for column in COLUMNS]
    inlet = [_highest(column, "inflow.impurity") / KMOL for column in COLUMNS]
    told = [
        f"{tuned}: C settles in {settling_words('C', settles[out], settles[other])}, V in "
        f"{settling_words('V', settles[out], settles[other])}, C_in to {inlet[out]:.2f} against "
        f"{inlet[other]:.2f} kmol/m³"
        for tuned, (out, other) in zip(("by hand", "optimal"), _BY_FLOW, strict=True)
    ]
    yield PRINTED["section 4", "LQI, best with f_out constant"].remark("; ".join(told))
    yield _reason()
    told = []
    for band in BANDS:
        of_v = [each("V", band) for each in settles]
        by_hand, optimal = (of_v[other] / of_v[out] for out, other in _BY_FLOW)
        told.append(
            f"{optimal:.2f} times optimal and {by_hand:.2f} times by hand to within "
            f"{100 * band:g} %"
        )
    yield PRINTED["section 4", "settling time of V, LQI"].remark("; ".join(told))


def _reason() -> Row:
    """Tell what the flows act on, and how both systems settle by one choice of weights."""
    of_c, _ = balances()
    direct, other, by_volume = (of_c.derivative(name) for name in ("f_in", "f_out", "V"))
    told = []
    for weights in COLUMNS:
        both = [
            partial(settling, lqi_run(weights._replace(constant=each)))
            for each in ("outflow", "inflow")
        ]
        told.append(
            f"with {weights.place} C in {settling_words('C', *both)}, V in "
            f"{settling_words('V', *both)}"
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
