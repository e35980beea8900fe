"""A line of the table of a document, and how it is judged: by computation alone."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from clepsydra.papers.printed_number import PrintedNumber, printed_number
from clepsydra.papers.row import Row, Verdict, joined

if TYPE_CHECKING:
    from sympy import Expr

#: What the document itself says elsewhere, in words, and whether it holds.
Evidence = tuple[str, bool]


@dataclass(frozen=True)
class Printed:
    """A line of the table of a document.

    Parameters
    ----------
    place : str
        Where it stands in the document: "Table 7", "(100b)", "section 4".
    name : str
        What it is: "IAE of C, constant outflow, by hand". No two of one place have one name.
    text : str
        As printed: a number with all its digits, a formula for SymPy, or words.
    unit : str
    digits : int, optional
        Significant digits, where the print leaves out trailing zeros.
    damage : str
        What in our text of the document looks like damage of its conversion.
    note : str
        What it is compared with and why, where that needs no computation.
    is_given : bool
        Whether the computation starts from it, and nothing judges it.

    Examples
    --------
    >>> Printed("Table 7", "IE of C", "0.380").number
    PrintedNumber(value=0.38, half_unit=0.0005)
    """

    place: str
    name: str
    text: str
    unit: str = ""
    digits: int | None = None
    damage: str = ""
    note: str = ""
    is_given: bool = False

    @property
    def value(self) -> float:
        """The number without what its digits leave open."""
        return self.number.value

    @property
    def number(self) -> PrintedNumber:
        """The text as a number."""
        return printed_number(self.text, self.digits)

    def compared(
        self,
        computed: float,
        *,
        tolerance: float = 0.0,
        zero: float = 0.0,
        why: str = "",
        right_if: Sequence[Evidence] = (),
        unprinted: str = "",
    ) -> Row:
        """Compare a printed number with a computed one.

        It is "reproduced" where the computed number rounds to the printed one or is cut to it, or
        is as near as the tolerance beside that; otherwise a "misprint" where all evidence holds,
        and else "not reproducible".

        Parameters
        ----------
        computed : float
            In the unit of the print.
        tolerance : float
            Share of the computed number that is left open beside the printed digits.
        zero : float
            Numbers that are no larger are zero up to rounding, and agree without a difference.
        why : str
            What leaves it open; needed with a tolerance or a zero. Else what the number comes from.
            The note of the line if left out.
        right_if : sequence of (words, bool)
            Other printed numbers that agree with the computed one and contradict this one.
        unprinted : str
            What the document leaves out, or what was tried, where it cannot be reproduced.

        Examples
        --------
        >>> Printed("(97b)", "F21", "13.8661", note="Riccati").compared(13.866069).verdict
        'reproduced'
        >>> line = Printed("(97b)", "Fi12", "3.0536")
        >>> row = line.compared(10**0.5, right_if=[("Fi12² is Q4 / R1", True)])
        >>> row.verdict, round(row.difference, 4)
        ('misprint', 0.0356)
        """
        why, said = why or self.note, f"{self.place}, {self.name}"
        if (tolerance or zero) and not why:
            raise ValueError(f"{said}: a tolerance needs its reason")
        number = self.number
        room = number.half_unit * (1.0 + 1e-9) + tolerance * abs(computed)
        right = bool(right_if) and all(holds for _, holds in right_if)
        verdict: Verdict
        are_zero = max(abs(computed), abs(number.value)) <= zero
        if are_zero or abs(computed - number.value) <= room:
            verdict, reason = "reproduced", why
        elif number.is_cut_from(computed):
            verdict, reason = "reproduced", f"{why} Cut after its last digit.".strip()
        elif right:
            words = "; ".join(words for words, _ in right_if)
            verdict, reason = "misprint", f"{short(computed)} is right: {words}."
        else:
            failed = "; ".join(words for words, holds in right_if if not holds)
            verdict, reason = "not reproducible", unprinted or failed or why
        if verdict != "reproduced" and not reason:
            raise ValueError(f"{said}: {computed!r} is not {self.text}, and no reason is given")
        row = self._row(verdict, float(computed), reason, number.value)
        difference = None if are_zero else _difference(float(computed), number.value)
        return replace(row, difference=difference, text=self.text)

    def formula(
        self, computed: Expr, *, names: Mapping[str, Expr] | None = None, reason: str = ""
    ) -> Row:
        """Compare a printed formula with the one that follows from the document's equations.

        It is "reproduced" where the difference is zero for all values of its symbols, else a
        "misprint", since the derivation is the document's own.

        Parameters
        ----------
        computed : sympy expression
        names : mapping, optional
            What printed names mean that are not those of the computed symbols.
        reason : str
            What the formula follows from, or what shows which is right; the note if left out.

        Examples
        --------
        >>> from sympy import symbols
        >>> s, k = symbols("s K_p2")
        >>> Printed("(52)", "V loop", "K_p2/(s + K_p2)").formula(1 / (1 + s / k)).verdict
        'reproduced'
        >>> line = Printed("(68)", "V loop", "K_p2/(s + K_p2)", note="(42)")
        >>> line.formula(k / (k - s)).verdict
        'misprint'
        """
        from sympy import simplify
        from sympy.parsing.sympy_parser import parse_expr

        known = {symbol.name: symbol for symbol in computed.free_symbols} | dict(names or {})
        same = simplify(parse_expr(self.text, known) - computed) == 0
        if not same and not (reason or self.note):
            raise ValueError(
                f"{self.place}, {self.name}: the formula differs, and no reason is given"
            )
        return self._row("reproduced" if same else "misprint", str(computed), reason)

    def formula_in(self, cases: Iterable[tuple[Expr, Mapping[str, Expr]]]) -> Row:
        """Compare one printed formula in several cases, each with what its names mean there.

        The row shows one that differs, if any does, and else the first.
        """
        rows = [self.formula(computed, names=names) for computed, names in cases]
        return next((row for row in rows if row.verdict != "reproduced"), rows[0])

    def stated(self, right: str, is_right: bool, reason: str = "") -> Row:
        """Compare what is printed in words, a caption or a label, with what has to stand there.

        Parameters
        ----------
        right : str
            What the check finds to be right.
        is_right : bool
            Whether the printed words are right, as computed.
        reason : str
            What the check is; the note if left out.

        Examples
        --------
        >>> line = Printed("Table 4", "caption", "regarding C(t)", note="eV")
        >>> line.stated("regarding V(t)", False).verdict
        'misprint'
        """
        return self._row("reproduced" if is_right else "misprint", right, reason)

    def claimed(self, holds: bool, computed: str, reason: str = "") -> Row:
        """Judge a claim in words by what was computed.

        Parameters
        ----------
        holds : bool
            Whether it does.
        computed : str
            The figures that decide.
        reason : str
            The note if left out.

        Examples
        --------
        >>> line = Printed("section 4", "overshoot", "no overshoot", note="of V")
        >>> line.claimed(False, "3.2 %").verdict
        'claim fails'
        """
        return self._row("claim holds" if holds else "claim fails", computed, reason)

    def remark(self, computed: str, reason: str = "") -> Row:
        """Return a claim that holds in one reading of what is left open, and not in all.

        Parameters
        ----------
        computed : str
            What we find.
        reason : str
            The note if left out.

        Examples
        --------
        >>> Printed("section 5", "speed", "is faster").remark("settles sooner").verdict
        'remark'
        """
        return self._row("remark", computed, reason)

    def _row(
        self, verdict: Verdict, computed: float | str, reason: str, shown: float | str | None = None
    ) -> Row:
        """Return the row of a line, whose note is the reason if there is no other.

        It is "damaged text" where it would be a "misprint" or "not reproducible" and the line
        looks damaged.
        """
        shown = self.text if shown is None else shown
        reason = reason or self.note
        if self.damage and verdict in ("misprint", "not reproducible"):
            verdict, reason = "damaged text", joined(self.damage, reason)
        return Row(self.place, self.name, shown, computed, self.unit, None, verdict, reason)


def _difference(computed: float, printed: float) -> float | None:
    if printed == 0.0 or not math.isfinite(computed):
        return None
    return (computed - printed) / abs(printed)


def short(value: float) -> str:
    """Return a number in as many digits as a reader compares.

    Examples
    --------
    >>> short(0.001234567), short(3469.9123), short(2.0)
    ('0.001235', '3470', '2')
    """
    return f"{value:.4g}"
