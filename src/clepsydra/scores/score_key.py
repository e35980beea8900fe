"""The name of a score in results and files, "iae[level_1]"."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

from clepsydra.scores.score import SCORES, Score

_WRITTEN = re.compile(r"([^\[\]]+)\[([^\[\]]+)\]")


class ScoreKey(NamedTuple):
    """A score of one signal, or of all of them.

    Parameters
    ----------
    score : str
        The key of a `Score`.
    signal : str
        Empty for all signals that have the score.
    """

    score: str
    signal: str = ""

    def __str__(self) -> str:
        """Return it as it stands in results and files."""
        return f"{self.score}[{self.signal}]" if self.signal else self.score

    @property
    def declared(self) -> Score:
        """The score as it is declared."""
        return SCORES[self.score]

    @property
    def title(self) -> str:
        """What a table calls it, "IAE of level_1"."""
        return self.declared.title + (f" of {self.signal}" if self.signal else "")


@lru_cache(maxsize=1024)
def score_key(written: str) -> ScoreKey:
    """Return the score and the signal of a name; text of another form is no score's name.

    Examples
    --------
    >>> score_key("iae[level_1]")
    ScoreKey(score='iae', signal='level_1')
    >>> score_key("iae"), score_key("iae[level_1").score in SCORES
    (ScoreKey(score='iae', signal=''), False)
    """
    found = _WRITTEN.fullmatch(written)
    return ScoreKey(*found.groups()) if found else ScoreKey(written)


def by_signal(scores: Mapping[str, float], score: str) -> dict[str, float]:
    """Return one score of each signal."""
    keys = {score_key(name): value for name, value in scores.items()}
    return {key.signal: value for key, value in keys.items() if key.score == score}
