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

    brief: str
    advice: str

    def __new__(cls, seen: str, means: str = "", remedy: str = "") -> Self:
        """Join the parts; `brief` is what is seen, `advice` with what to do."""
        ending = f"; {remedy}." if remedy else "."
        said = super().__new__(cls, (f"{seen}: {means}" if means else seen) + ending)
        said.brief, said.advice = f"{seen}.", seen + ending
        return said
