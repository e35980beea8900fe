"""The balance of a run: what entered, left and stayed, against what it should be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.process.balance import DELAYED, ENTERED, LEFT
from clepsydra.process.process import Process


@dataclass(frozen=True)
class Balance:
    """Conservation of the liquid or of a component over a run.

    Parameters
    ----------
    name : str
        "liquid" or a component.
    unit : str
        SI unit of the amounts.
    entered, left, gained : float
        Through the boundary of the plant, and more in its tanks and delays than at first.

    Examples
    --------
    >>> Balance("liquid", "m^3", entered=2.0, left=1.5, gained=0.5).error
    0.0
    """

    name: str
    unit: str
    entered: float
    left: float
    gained: float

    @property
    def error(self) -> float:
        """What does not close, relative to the throughput [1]."""
        missing = self.entered - self.left - self.gained
        throughput = max(abs(self.entered), abs(self.left), abs(self.gained))
        return abs(missing) / throughput if throughput else 0.0


def balances(
    process: Process,
    first: np.ndarray,
    last: np.ndarray,
    totals: Mapping[str, float],
) -> tuple[Balance, ...]:
    """Return the balances of a run.

    Parameters
    ----------
    process : Process
    first, last : ndarray [n]
        Contents at the start and the end.
    totals : mapping
        The totals "balance.entered.liquid" and so on at the end, those of a run from 0.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> entered = {"balance.entered.liquid": 2.8e-4, "balance.left.liquid": 0.0}
    >>> levels = np.array([0.1, 0.0, 0.0, 0.0])  # tank 1 has an area of 28 cm²
    >>> round(balances(process, 0 * levels, levels, entered)[0].error, 12)
    0.0
    """
    motion, parameters = process.motion, process.parameter_values
    units = {signal.name: signal.unit for signal in motion.totals}
    before, after = (np.array(motion.stored(c, parameters)).ravel() for c in (first, last))
    return tuple(
        Balance(
            name,
            units[f"{ENTERED}.{name}"],
            float(totals[f"{ENTERED}.{name}"]),
            float(totals[f"{LEFT}.{name}"]),
            float(after[place] - before[place]) + totals.get(f"{DELAYED}.{name}", 0.0),
        )
        for place, name in enumerate(motion.stored_names)
    )
