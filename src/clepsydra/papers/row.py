"""A row of the audit: one printed number or claim beside what Clepsydra computes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

Verdict = Literal[
    "reproduced", "misprint", "not reproducible", "claim holds", "claim fails",
    "consistent", "damaged text", "remark",
]  # fmt: skip
#: Those that judge the document, and are counted.
COUNTED: tuple[Verdict, ...] = (
    "reproduced", "misprint", "not reproducible", "claim holds", "claim fails",
)  # fmt: skip
#: All: a consistent row proves nothing, damaged text is not the author's, a remark hangs on what
#: the document leaves open.
VERDICTS: tuple[Verdict, ...] = (*COUNTED, "consistent", "damaged text", "remark")


@dataclass(frozen=True)
class Row:
    """One printed number or claim, what was computed, and what follows.

    Parameters
    ----------
    place : str
        Where it stands in the document: "Table 7", "(100b)", "section 4".
    name : str
        What it is: "IAE of C, constant outflow, by hand".
    printed : float or str
        As printed; a claim or a formula in words.
    computed : float or str
        In the unit of the print.
    unit : str
    difference : float or None
        (computed - printed) / printed; None where it has no meaning.
    verdict : Verdict
    reason : str
        Why, for a reader who knows only the document.
    document, experiment : str
        Their keys; the audit fills them in.
    text : str
        A printed number with all its digits, "0.510"; empty for words.

    Examples
    --------
    >>> row = Row("(46)", "time constant", 10.0, 10.0, "s", 0.0, "reproduced", "V0 / f0")
    >>> row.as_dict()["printed"]
    10.0
    """

    place: str
    name: str
    printed: float | str
    computed: float | str
    unit: str
    difference: float | None
    verdict: Verdict
    reason: str
    document: str = ""
    experiment: str = ""
    text: str = ""

    @property
    def is_counted(self) -> bool:
        """Whether it judges the document."""
        return self.verdict in COUNTED

    @property
    def is_as_printed(self) -> bool:
        """Whether nothing here speaks against the document."""
        return self.verdict not in ("misprint", "not reproducible", "claim fails")

    def as_dict(self) -> dict[str, Any]:
        """Return the row under the names that a JSON document has for it."""
        return {
            "document": self.document,
            "place": self.place,
            "name": self.name,
            "printed": self.printed,
            "computed": self.computed,
            "unit": self.unit,
            "difference": self.difference,
            "verdict": self.verdict,
            "reason": self.reason,
        }


Rows = Iterator[Row]
