"""A row of the table: what was measured before and after, and what was wanted of it."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.measure import Spread, Timings

BEFORE, AFTER = "before", "after"


@dataclass(frozen=True)
class Wanted:
    """A limit for what is measured after, or for its ratio to what was before.

    Parameters
    ----------
    limit : float
    ratio : bool
        Whether the ratio is judged.
    least : bool
        Whether it is the smallest that is wanted, not the largest.
    """

    limit: float
    ratio: bool = False
    least: bool = False

    def __str__(self) -> str:
        what = "ratio" if self.ratio else "after"
        return f"{what} at {'least' if self.least else 'most'} {self.limit:g}"

    def met(self, value: float) -> bool:
        """Return whether a value is what is wanted."""
        return value >= self.limit if self.least else value <= self.limit


@dataclass(frozen=True)
class Row:
    """Work, and how much of it there is.

    Parameters
    ----------
    work : str
        What is done, and in which unit it is given.
    before, after : Spread or None
        None where it was not measured.
    ratio : Spread or None
        After over before, each pair from the same round.
    wanted : Wanted or None
        None where it is only told.
    digits : int
        Of `before` and `after`.
    """

    work: str
    before: Spread | None
    after: Spread | None
    ratio: Spread | None
    wanted: Wanted | None
    digits: int = 2

    @classmethod
    def of(
        cls,
        work: str,
        sides: dict[str, list[float]],
        wanted: Wanted | None,
        digits: int = 2,
    ) -> Row:
        """Return the row of the values that each side has from the same rounds."""
        found = Timings({side: values for side, values in sides.items() if values})
        known = found.seconds
        ratio = found.ratio(AFTER, BEFORE) if {BEFORE, AFTER} <= known.keys() else None
        before, after = (found.of(side) if side in known else None for side in (BEFORE, AFTER))
        return cls(work, before, after, ratio, wanted, digits)

    def verdict(self) -> str:
        """Return whether what is wanted is met, "–" where that is not known."""
        judged = self.ratio if self.wanted and self.wanted.ratio else self.after
        if self.wanted is None or judged is None:
            return "–"
        return "yes" if self.wanted.met(judged.median) else "**no**"
