"""Section 3.2: whether the weights (100a) and (101a) are optimal for what they are called so for.

The weights beside them are ours: near ones, Q2 and Q3 moved by 3 %, and farther ones, a smaller Q2,
a Q3 about twice as large, and with (100a) a tenth more of Q4. What the optimisation by the other
indices gave is not printed.
"""

from __future__ import annotations

from functools import cache, partial
from typing import NamedTuple

from clepsydra.loop.run import Run
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, Weights, lqi_run
from clepsydra.papers.averaging_tank.printed_tables import KEYS, Indices, lower_cells
from clepsydra.papers.averaging_tank.step_run import (
    indices,
    settling,
    settling_words,
    smooth_iseg,
    step_of,
)
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row
from clepsydra.scores.step_response import overshoot

_OUTPUTS = ("C", "V")
#: So short that (100a), whose loop of V has a pole at -362 1/s, is not another under a hold [s].
_PERIOD, _HORIZON = 2e-5, 4.0
_LITTLE = 0.03


class Beside(NamedTuple):
    """Printed weights, the index that they are optimal for, and others that (99) allows."""

    printed: Weights
    criterion: str
    other: Weights

    @property
    def near(self) -> Weights:
        """With less of Q2 and more of Q3 by a little, far more than printed digits leave open."""
        _, q2, q3, q4 = self.printed.states
        return _with(self.printed, (1.0 - _LITTLE) * q2, (1.0 + _LITTLE) * q3, q4)


def _with(column: Weights, q2: float, q3: float, q4: float) -> Weights:
    return column._replace(states=(column.states[0], q2, q3, q4))


BESIDE = (
    Beside(COLUMNS[1], "ITAE", _with(COLUMNS[1], 0.118, 24.0, 12.0)),
    Beside(COLUMNS[3], "ISE", _with(COLUMNS[3], 0.2, 20.0, 4.528)),
)


def run() -> Found:
    """Return the rows on the optimal weights."""
    return (_which_index(), *(_optimal(each) for each in BESIDE))


@cache
def of_weights(weights: Weights) -> tuple[Run, Indices]:
    """Return the document's step under some weights, and its indices, of IE the size."""
    found = lqi_run(weights, _PERIOD, _HORIZON)
    return found, {key: abs(value) for key, value in indices(found).items()}


def _which_index() -> Row:
    """Compare all indices, settling and overshoot with those of other weights."""
    told = []
    for each in BESIDE:
        (ours, lower), (theirs, printed) = of_weights(each.other), of_weights(each.printed)
        cells = len(lower_cells(lower, printed))
        squared = ", ".join(
            f"{o} {smooth_iseg(ours, o):.4f} against {smooth_iseg(theirs, o):.4f}" for o in _OUTPUTS
        )
        settled = ", ".join(
            f"{o} settles in "
            f"{settling_words(o, partial(settling, ours), partial(settling, theirs))}"
            for o in _OUTPUTS
        )
        over = ", ".join(
            f"{o} {overshoot(*step_of(ours, o)):.2f} % against "
            f"{overshoot(*step_of(theirs, o)):.2f} %"
            for o in _OUTPUTS
        )
        told.append(
            f"{each.printed.title}: other weights have {cells} of {len(KEYS)} indices beside ISEG "
            f"lower, ISEG of {squared}, {settled}, overshoot {over}"
        )
    return PRINTED["section 3.2", "LQI, which index"].remark("; ".join(told))


def _optimal(beside: Beside) -> Row:
    """Judge that printed weights are optimal for an index by what other weights make of it."""
    printed = of_weights(beside.printed)[1]
    told, is_lower = [], True
    for words, weights in (("near", beside.near), ("farther", beside.other)):
        ours = of_weights(weights)[1]
        keys = [(beside.criterion, o) for o in _OUTPUTS]
        is_lower = is_lower and all(ours[key] < printed[key] for key in keys)
        cells = (f"of {o} {ours[i, o]:.3e} against {printed[i, o]:.3e}" for i, o in keys)
        told.append(f"{beside.criterion} by {words} weights {', '.join(cells)}")
    return PRINTED[beside.printed.place, "optimal weights"].claimed(not is_lower, "; ".join(told))
