"""A line of the table of a document, and how it is judged: by computation alone."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from clepsydra.papers.formula import read_formula
from clepsydra.papers.rational_function import RationalFunction, exact
from clepsydra.papers.row import Row, Verdict, joined

#: What the document itself says elsewhere, in words, and whether it holds.
Evidence = tuple[str, bool]
_NUMBER = re.compile(r"([+\-−]?)(\d*)\.?(\d*)(?:[eE]([+\-−]?\d+))?")


@dataclass(frozen=True)
class PrintedNumber:
    """A printed number, and half a unit of its last digit: what rounding leaves open."""

    value: float
    half_unit: float

    def is_cut_from(self, value: float) -> bool:
        """Whether these are the first digits of a value, with the others left out."""
        same_sign = math.copysign(1.0, value) == math.copysign(1.0, self.value)
        return same_sign and 0.0 <= abs(value) - abs(self.value) < 2.0 * self.half_unit


def printed_number(text: str, digits: int | None = None) -> PrintedNumber:
    """Read a number as it is printed, so that its digits count.

    Trailing zeros count as digits, also of whole numbers; ``digits`` are the significant ones where
    the print leaves them out: "1" beside "0.92". A bare "0" says that there is nothing, and leaves
    nothing open. What is no number is a ValueError.

    Examples
    --------
    >>> printed_number("3.0536")
    PrintedNumber(value=3.0536, half_unit=5e-05)
    >>> printed_number("5744").half_unit, printed_number("1", digits=2).half_unit
    (0.5, 0.05)
    """
    match = _NUMBER.fullmatch(text.strip())
    if match is None or not (match[2] or match[3]):
        raise ValueError(f"{text!r} is no printed number")
    value = float(text.strip().replace("−", "-"))
    last = int((match[4] or "0").replace("−", "-")) - len(match[3])
    if value == 0.0 and not match[3]:
        return PrintedNumber(value, 0.0)
    if digits is not None and value:
        last = math.floor(math.log10(abs(value))) - digits + 1
    # From text, so that 5e-05 is the nearest number to it.
    return PrintedNumber(value, float(f"5e{last - 1}"))


@dataclass(frozen=True)
class Printed:
    """A line of the table of a document.

    Parameters
    ----------
    place : str
        Where it stands in the document: "Table 7", "(100b)", "section 4".
    name : str
        What it is: "IAE of C, constant outflow, by hand". No two of one place have one name.
    line : int
        Line of the text that the document was converted to, counted from 1.
    text : str
        As printed: a number with all its digits, a formula as `read_formula` takes it, or words.
    unit : str
    digits : int, optional
        Significant digits, where the print leaves out trailing zeros.
    damage : str
        What in our text of the document looks like damage of its conversion.
    note : str
        What it is compared with and why. Where that needs numbers it names them in braces, as
        ``{peak:.2f}``, and whatever judges the line is told them by name.
    is_given : bool
        Whether the computation starts from it, and nothing judges it.
    """

    place: str
    name: str
    line: int
    text: str
    unit: str = ""
    digits: int | None = None
    damage: str = ""
    note: str = ""
    is_given: bool = False

    @property
    def number(self) -> PrintedNumber:
        """The text as a number."""
        return printed_number(self.text, self.digits)

    @property
    def value(self) -> float:
        """The number without what its digits leave open."""
        return self.number.value

    def told(self, **values: object) -> Printed:
        """Return the line with values in the braces of its note."""
        return replace(self, note=self.note.format(**values)) if values else self

    def compared(
        self,
        computed: float,
        *,
        tolerance: float = 0.0,
        zero: float = 0.0,
        right_if: Sequence[Evidence] = (),
        unprinted: str = "",
        **told: object,
    ) -> Row:
        """Compare a printed number with a computed one.

        It is "reproduced" where the computed number rounds to the printed one or is cut to it, or
        is as near as the tolerance beside that; otherwise a "misprint" where all evidence holds,
        and else "not reproducible". With a tolerance or a zero the line needs a note.

        Parameters
        ----------
        computed : float
            In the unit of the print.
        tolerance : float
            Share of the computed number that is left open beside the printed digits.
        zero : float
            Numbers that are no larger are zero up to rounding, and agree without a difference.
        right_if : sequence of (words, bool)
            Other printed numbers that agree with the computed one and contradict this one.
        unprinted : str
            Said instead of the note where it is not reproducible: what the document leaves out.
        **told
            Values for the braces of the note.

        Examples
        --------
        >>> line = Printed("(97b)", "Fi12", 679, "3.0536")
        >>> row = line.compared(10**0.5, right_if=[("Fi12² is Q4 / R1", True)])
        >>> row.verdict, round(row.difference, 4)
        ('misprint', 0.0356)
        """
        said, number, reason = f"{self.place}, {self.name}", self.number, self.told(**told).note
        if (tolerance or zero) and not reason:
            raise ValueError(f"{said}: a tolerance needs its reason")
        room = number.half_unit * (1.0 + 1e-9) + tolerance * abs(computed)
        are_zero = max(abs(computed), abs(number.value)) <= zero
        verdict: Verdict = "reproduced"
        if are_zero or abs(computed - number.value) <= room:
            pass
        elif number.is_cut_from(computed):
            reason = joined(reason, "Cut after its last digit.")
        elif right_if and all(holds for _, holds in right_if):
            words = "; ".join(words for words, _ in right_if)
            verdict, reason = "misprint", f"{short(computed)} is right: {words}."
        else:
            failed = "; ".join(words for words, holds in right_if if not holds)
            verdict, reason = "not reproducible", unprinted or failed or reason
        if verdict != "reproduced" and not reason:
            raise ValueError(f"{said}: {computed!r} is not {self.text}, and no reason is given")
        row = replace(self._row(verdict, float(computed), reason), text=self.text)
        difference = None if are_zero else _difference(float(computed), number.value)
        return replace(row, printed=number.value, difference=difference)

    def formula(
        self,
        computed: RationalFunction | int,
        *,
        names: Mapping[str, RationalFunction] | None = None,
    ) -> Row:
        """Compare a printed formula with the one that follows from the document's equations.

        It is "reproduced" where the difference is zero for all values of its symbols, else a
        "misprint", since the derivation is the document's own. `names` are those of the print that
        mean other symbols of the derivation.

        Examples
        --------
        >>> from clepsydra.papers.rational_function import symbols
        >>> s, k = symbols("s K_p2")
        >>> Printed("(52)", "V loop", 361, "K_p2/(s + K_p2)").formula(1 / (1 + s / k)).verdict
        'reproduced'
        """
        same = read_formula(self.text, names) == exact(computed)
        if not same and not self.note:
            raise ValueError(f"{self.place}, {self.name}: the formula differs, and has no reason")
        return self._row("reproduced" if same else "misprint", str(computed))

    def formula_in(
        self, cases: Iterable[tuple[RationalFunction, Mapping[str, RationalFunction]]]
    ) -> Row:
        """Compare one printed formula in several cases, each with what its names mean there.

        The row shows one that differs, if any does, and else the first.
        """
        rows = [self.formula(computed, names=names) for computed, names in cases]
        return next((row for row in rows if row.verdict != "reproduced"), rows[0])

    def stated(self, right: str, is_right: bool, **told: object) -> Row:
        """Compare printed words, a caption or a label, with what the check finds to be right."""
        return self.told(**told)._row("reproduced" if is_right else "misprint", right)

    def claimed(self, holds: bool, computed: str, **told: object) -> Row:
        """Judge a claim in words by what was computed: the figures that decide.

        Examples
        --------
        >>> line = Printed("section 4", "rise", 90, "no overshoot", note="With {gain:.1f} V/V.")
        >>> row = line.claimed(False, "3.2 %", gain=2.04)
        >>> row.verdict, row.reason
        ('claim fails', 'With 2.0 V/V.')
        """
        return self.told(**told)._row("claim holds" if holds else "claim fails", computed)

    def remark(self, computed: str, **told: object) -> Row:
        """Return a claim that holds in one reading of what is left open, and not in all."""
        return self.told(**told)._row("remark", computed)

    def _row(self, verdict: Verdict, computed: float | str, reason: str = "") -> Row:
        """Return the row of a line: "damaged text" where the line looks damaged and disagrees."""
        reason = reason or self.note
        if self.damage and verdict in ("misprint", "not reproducible"):
            verdict, reason = "damaged text", joined(self.damage, reason)
        row = Row(self.place, self.name, self.text, computed, self.unit, None, verdict, reason)
        return replace(row, line=self.line)


def _difference(computed: float, printed: float) -> float | None:
    if printed == 0.0 or not math.isfinite(computed):
        return None
    return (computed - printed) / abs(printed)


def short(value: float) -> str:
    """Return a number in as many digits as a reader compares: 0.001234567 as "0.001235"."""
    return f"{value:.4g}"
