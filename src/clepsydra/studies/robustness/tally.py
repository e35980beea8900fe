"""What came of many draws together, merged from parts in any order."""

from __future__ import annotations

import base64
import binascii
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.studies.robustness.distribution import KEPT, Distribution
from clepsydra.studies.robustness.drawn_scores import DrawnScores, Happening
from clepsydra.studies.robustness.shares import Share, share_of


@dataclass(frozen=True, eq=False)
class Tally:
    """Counts and distributions of what came of draws; the same bits in any order of merging.

    Attributes
    ----------
    draws : int
    scores : dict
        Score to its distribution over the whole run and in each event; None where no draw has it.
    happened : dict
        How often each thing happened.
    first : dict
        The lowest number of a draw in which it happened, of what did.
    reasons : dict
        Why draws have no admissible steady state, and how many.
    substeps : int
        Integration steps in a sampling period, at most.

    Examples
    --------
    >>> none = np.array([-1, -1])
    >>> one, other = (
    ...     Tally.of(DrawnScores(n, {"iae[y]": n[None] * 1.0}, {Happening.DRY: n > 3}, none, (), n))
    ...     for n in (np.array([1, 2]), np.array([3, 4])))
    >>> both = other.merged(one)
    >>> both.share(Happening.DRY).count, both.scores["iae[y]"][0].quantile(0.5).value
    (1, 2.0)
    """

    draws: int
    scores: dict[str, tuple[Distribution | None, ...]]
    happened: dict[Happening, int]
    first: dict[Happening, int]
    reasons: dict[str, int]
    substeps: int

    @classmethod
    def of(cls, drawn: DrawnScores, kept: int = KEPT) -> Tally:
        """Return what came of some draws together.

        Parameters
        ----------
        kept : int
            Scores that are kept as they are, see `Distribution`.
        """
        numbers = drawn.numbers
        counted = np.bincount(drawn.reason[drawn.reason >= 0], minlength=len(drawn.reasons))
        return cls(
            draws=len(numbers),
            scores={
                name: tuple(_distribution(row, numbers, kept) for row in rows)
                for name, rows in drawn.scores.items()
            },
            happened={what: int(truths.sum()) for what, truths in drawn.happened.items()},
            first={
                what: int(numbers[truths].min())
                for what, truths in drawn.happened.items()
                if truths.any()
            },
            reasons={
                words: count
                for words, count in zip(drawn.reasons, counted.tolist(), strict=True)
                if count
            },
            substeps=int(drawn.substeps.max(initial=0)),
        )

    def merged(self, *others: Tally) -> Tally:
        """Return what came of all their draws; merge many at once, not one by one."""
        every = (self, *others)
        first = dict[Happening, int]()
        for each in every:
            for what, number in each.first.items():
                first[what] = min(number, first.get(what, number))
        reasons = sum((Counter(each.reasons) for each in every), Counter[str]())
        return Tally(
            draws=sum(each.draws for each in every),
            scores={
                name: tuple(
                    _merged([each.scores[name][place] for each in every])
                    for place in range(len(rows))
                )
                for name, rows in self.scores.items()
            },
            happened={w: sum(each.happened[w] for each in every) for w in self.happened},
            first=first,
            reasons=dict(sorted(reasons.items())),
            substeps=max(each.substeps for each in every),
        )

    def share(self, what: Happening) -> Share:
        """Return the share of draws in which something happened, of those that were simulated.

        Of draws without an admissible steady state it is of all.
        """
        infeasible = self.happened.get(Happening.INFEASIBLE, 0)
        of = self.draws - (0 if what is Happening.INFEASIBLE else infeasible)
        return share_of(self.happened[what], of)

    def as_dict(self) -> dict[str, Any]:
        """Return it as values for JSON, to go on from."""
        return {
            "draws": self.draws,
            "scores": {
                name: [each and base64.b64encode(each.as_bytes()).decode() for each in rows]
                for name, rows in self.scores.items()
            },
            "happened": {what.name: count for what, count in self.happened.items()},
            "first": {what.name: number for what, number in self.first.items()},
            "reasons": self.reasons,
            "substeps": self.substeps,
        }

    @classmethod
    def from_dict(cls, said: Mapping[str, Any]) -> Tally:
        """Return one that was written.

        Raises
        ------
        InputError
            It is damaged, or was never one.
        """
        try:
            return cls(
                draws=int(said["draws"]),
                scores={
                    str(name): tuple(
                        each and Distribution.from_bytes(base64.b64decode(each, validate=True))
                        for each in rows
                    )
                    for name, rows in said["scores"].items()
                },
                happened={Happening[what]: int(n) for what, n in said["happened"].items()},
                first={Happening[what]: int(n) for what, n in said["first"].items()},
                reasons={str(words): int(count) for words, count in said["reasons"].items()},
                substeps=int(said["substeps"]),
            )
        except (KeyError, TypeError, ValueError, AttributeError, binascii.Error):
            raise InputError(
                "saved draws", Finding("something else"), "what an interrupted run wrote",
                "delete the file to begin again",
            ) from None  # fmt: skip


def _distribution(row: np.ndarray, numbers: np.ndarray, kept: int) -> Distribution | None:
    """Return the distribution of those draws that have a score."""
    known = ~np.isnan(row)
    return Distribution.of(row[known], numbers[known], kept) if known.any() else None


def _merged(parts: list[Distribution | None]) -> Distribution | None:
    known = [each for each in parts if each is not None]
    return known[0].merged(*known[1:]) if known else None
