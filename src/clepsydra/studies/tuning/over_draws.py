"""What controllers come to over drawn plants: the one that was tuned beside others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from clepsydra.process.process import Process


class OverDraws(NamedTuple):
    """What a controller comes to over drawn plants.

    Parameters
    ----------
    objective : float
        Its quantile; infinite where too many plants fail.
    scores : dict
        "score[signal]" to its own quantile, of each score of the objective.
    failed : int
        Plants on which a tank spills or runs dry, the plant is harmed, or the loop does not
        settle.
    failures : dict
        Each of these that happened, in words, and on how many plants.
    """

    objective: float
    scores: dict[str, float]
    failed: int
    failures: dict[str, int]


@dataclass(frozen=True, eq=False)
class TunedOverDraws:
    """What a tuning over drawn plants came to on them.

    Parameters
    ----------
    quantile : float
        The share of plants that are at least as good.
    plants : int
        How many count.
    left_out : dict
        Why others have no admissible steady state, and how many for each reason.
    seed : int
        Of the draws, which count from 1.
    tuned, start : OverDraws
    of_plant_alone : OverDraws or None
        Of the controller that is best for the plant itself, within the same limits; None where
        the tuning was stopped before there was one.
    process : Process
        Lends units to scores.
    duration : float
        Of each run [s].
    """

    quantile: float
    plants: int
    left_out: dict[str, int]
    seed: int
    tuned: OverDraws
    start: OverDraws
    of_plant_alone: OverDraws | None
    process: Process
    duration: float

    @property
    def share(self) -> str:
        """Which plants are at least as good, as a phrase: "95 % of 64 plants"."""
        return f"{100.0 * self.quantile:g} % of {self.plants} plants"
