"""A sentence for the reader whose parts are known, so that a page may show less of it."""

from __future__ import annotations

from typing import Self


class Remark(str):
    """What is seen, what it means, and what to do, as text: "seen: means; remedy."

    Parameters
    ----------
    seen, means, remedy : str
        Without a full stop.

    Examples
    --------
    >>> said = Remark("pump_1 winds up", "its integral has no anti-windup", "choose another form")
    >>> print(said, said.brief, said.advice, sep="\\n")
    pump_1 winds up: its integral has no anti-windup; choose another form.
    pump_1 winds up.
    pump_1 winds up; choose another form.
    """

    seen: str
    means: str
    remedy: str

    def __new__(cls, seen: str, means: str = "", remedy: str = "") -> Self:
        """Join the parts."""
        ending = f"; {remedy}." if remedy else "."
        said = super().__new__(cls, (f"{seen}: {means}" if means else seen) + ending)
        said.seen, said.means, said.remedy = seen, means, remedy
        return said

    def __getnewargs__(self) -> tuple[str, ...]:  # type: ignore[override]
        """Return what a copy is made of, in place of the text that any other string is made of."""
        return self.seen, self.means, self.remedy

    @property
    def brief(self) -> str:
        """What is seen."""
        return f"{self.seen}."

    @property
    def advice(self) -> str:
        """What is seen, with what to do."""
        return f"{self.seen}; {self.remedy}." if self.remedy else self.brief
