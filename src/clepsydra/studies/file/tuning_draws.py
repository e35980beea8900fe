"""The keys of a tuning over drawn plants: how many, and the share of them that counts."""

from __future__ import annotations

from typing import Any

import numpy as np

from clepsydra.process.declared import part
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.tuning.draws import MOST_DRAWS, QUANTILE

_COUNT = f"a whole number from 1 to {MOST_DRAWS:,}"
_SHARE = "a share of the drawn plants above 0 and below 1"


def draws_key() -> Any:
    """Return the field that holds the number of drawn plants; None where none are drawn."""
    return part(
        lambda table, key, known: _draws(table),
        default=None,
        description="how many plants are drawn from the uncertainty of the process; what is tuned "
        "for is then what most of them keep, and limits are those of the plant itself",
        type="integer",
        minimum=1,
        maximum=MOST_DRAWS,
    )


def quantile_key() -> Any:
    """Return the field that holds the share of drawn plants that are to be at least as good."""
    return part(
        lambda table, key, known: _quantile(table),
        default=QUANTILE,
        description=f"the share of drawn plants that counts [1], {100.0 * QUANTILE:g} % if left "
        "out; on no more than the others may a tank spill or run dry, or the loop not settle",
        type=["string", "number"],
        exclusiveMinimum=0.0,
        maximum=1.0,
    )


def _draws(table: TableReader) -> int | None:
    if not table.has("draws"):
        return None
    written: Any = table.raw("draws")
    whole = isinstance(written, (int, np.integer)) and not isinstance(written, bool)
    if not whole or not 1 <= written <= MOST_DRAWS:
        raise table.wrong("draws", _COUNT, "64 will do for a quantile of 95 %")
    return int(written)


def _quantile(table: TableReader) -> float:
    if not table.has("quantile"):
        return QUANTILE
    remedy = 'write as in 0.95 or "95 %"'
    if not table.has("draws"):
        raise table.wrong("quantile", "draws beside it", "write draws = 64, or leave quantile out")
    found = table.quantity("quantile", "1", _SHARE, remedy)
    if not 0.0 < found < 1.0:
        raise table.wrong("quantile", _SHARE, remedy)
    return found
