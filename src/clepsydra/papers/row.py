"""A row of the audit: one printed number or claim beside what Clepsydra computes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
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
#: Entries of matrices and terms of formulas that are as good as not there.
_BARE = ("0", "1", "-1", "−1")


@dataclass(frozen=True)
class Row:
    """One printed number or claim, what was computed, and what follows.

    Parameters
    ----------
    place, name : str
        Where it stands in the document, and what it is, as `Printed` has them.
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
    line : int
        Where it stands in the text of the document, as `Printed` has it.
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
    line: int = 0

    @property
    def shown(self) -> str:
        """What is printed, with all its digits."""
        return self.text or value_words(self.printed)

    @property
    def is_counted(self) -> bool:
        """Whether it judges the document."""
        return self.verdict in COUNTED

    @property
    def is_bare(self) -> bool:
        """Whether what is printed is nothing but 0, 1 or −1, which much comes out as."""
        if isinstance(self.printed, str):
            return self.printed.strip() in _BARE
        return abs(self.printed) in (0.0, 1.0)

    @property
    def is_as_printed(self) -> bool:
        """Whether nothing here speaks against the document."""
        return self.verdict not in ("misprint", "not reproducible", "claim fails")

    def as_dict(self) -> dict[str, Any]:
        """Return the row under the names that a JSON document has for it.

        What is printed stands there as a number, and as text with all its digits.
        """
        names = "document place line name printed computed unit difference verdict reason"
        return {name: getattr(self, name) for name in names.split()} | {"text": self.shown}

    def circular(self, solved_from: str) -> Row:
        """Return a row whose agreement proves nothing: "consistent" where it was "reproduced".

        `solved_from` tells what the computed number was solved from or fitted to, the printed one
        among it.
        """
        if self.verdict not in ("reproduced", "claim holds"):
            return self
        return replace(self, verdict="consistent", reason=joined(solved_from, self.reason))

    def undecided(self, hangs_on: str) -> Row:
        """Return a number that agrees in one reading and not in another as a remark.

        What is reproduced in the reading that stands in the row is as it was; `hangs_on` tells in
        which readings it agrees.
        """
        if self.verdict != "not reproducible":
            return self
        return replace(self, verdict="remark", reason=joined(hangs_on, self.reason))


Rows = Iterator[Row]


def joined(*sentences: str) -> str:
    """Return sentences as one text, without those that are empty."""
    return " ".join(sentence for sentence in sentences if sentence)


def value_words(value: float | str) -> str:
    """Return a value in at most six digits, −8.5 as "−8.5"; words stay as they are."""
    return value if isinstance(value, str) else f"{value:.6g}".replace("-", "−")
