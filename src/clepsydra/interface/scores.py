"""The scores of a run, printed with units and words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from clepsydra.base.errors import UnknownKey
from clepsydra.base.section import Section, Table
from clepsydra.base.suggestion import suggestion
from clepsydra.interface.shown import Answered
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key

if TYPE_CHECKING:
    from clepsydra.process.process import Process

#: What says most of a loop, in the order of a table.
_SHORT = ("iae", "rise_time", "overshoot", "settling_time", "return_time", "total_variation")


class Scores(Answered, dict[str, float]):
    """Score to its value, "iae[level_1]", in SI or the unit of its definition.

    Parameters
    ----------
    values : mapping
    process : Process
        Lends units.
    duration : float
        Of the run [s].
    """

    def __init__(self, values: Mapping[str, float], process: Process, duration: float) -> None:
        super().__init__(values)
        self._process, self._duration = process, duration

    def __missing__(self, name: str) -> float:
        """Refuse a name that is none of them.

        Raises
        ------
        UnknownKey
        """
        score = score_key(str(name)).score
        known = [each for each in self if score_key(each).score == score] or list(self)
        remedy = suggestion(name, known, f'write as in scores["{next(iter(known), "")}"]')
        raise UnknownKey("scores", str(name)[:60], f"one of {', '.join(known)}", remedy)

    def answer(self) -> Section:
        """Return all of them."""
        return self._table(tuple(SCORES))

    def short(self) -> Section:
        """Return a table of those that say most."""
        return self._table(_SHORT)

    def _table(self, keys: tuple[str, ...]) -> Section:
        from clepsydra.report.score_tables import score_text

        signals = list(dict.fromkeys(score_key(name).signal for name in self))
        rows = []
        for key in keys:
            cells = [
                " ".join(
                    score_text(
                        self._process, name, self[f"{key}[{name}]"], SCORES[key], self._duration
                    )
                ).strip()
                if f"{key}[{name}]" in self
                else ""
                for name in signals
            ]
            if any(cells):
                rows.append((key, *cells))
        used = [place for place in range(len(signals)) if any(row[place + 1] for row in rows)]
        head = ("score", *(signals[place] for place in used))
        body = tuple((row[0], *(row[place + 1] for place in used)) for row in rows)
        return Section("", (Table("Scores", head, body),))
