"""From a printed and a computed number to a verdict, by computation alone."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from clepsydra.papers.printed import printed_number
from clepsydra.papers.row import Row, Verdict

if TYPE_CHECKING:
    from sympy import Expr

#: What the document itself says elsewhere, in words, and whether it holds.
Evidence = tuple[str, bool]


def compared(
    place: str,
    name: str,
    printed: str,
    computed: float,
    unit: str = "",
    *,
    digits: int | None = None,
    tolerance: float = 0.0,
    zero: float = 0.0,
    why: str = "",
    right_if: Sequence[Evidence] = (),
    unprinted: str = "",
) -> Row:
    """Compare a printed number with a computed one.

    It is "reproduced" where the computed number rounds to the printed one or is cut to it, or is
    as near as the tolerance beside that; otherwise a "misprint" where all evidence holds, and
    else "not reproducible".

    Parameters
    ----------
    place, name : str
    printed : str
        As printed, so that its digits count.
    computed : float
        In the unit of the print.
    unit : str
    digits : int, optional
        Significant digits, where the print leaves out trailing zeros.
    tolerance : float
        Share of the computed number that is left open beside the printed digits.
    zero : float
        Numbers that are no larger are zero up to rounding, and agree without a difference.
    why : str
        What leaves it open; needed with a tolerance or a zero. Else what the number comes from.
    right_if : sequence of (words, bool)
        Other printed numbers that agree with the computed one and contradict this one.
    unprinted : str
        What the document leaves out, or what was tried, where it cannot be reproduced.

    Examples
    --------
    >>> compared("(97b)", "F21", "13.8661", 13.866069, why="Riccati equation").verdict
    'reproduced'
    >>> row = compared("(97b)", "Fi12", "3.0536", 10**0.5, right_if=[("Fi12² is Q4 / R1", True)])
    >>> row.verdict, round(row.difference, 4)
    ('misprint', 0.0356)
    """
    if (tolerance or zero) and not why:
        raise ValueError(f"{place}, {name}: a tolerance needs its reason")
    number = printed_number(printed, digits)
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
        raise ValueError(f"{place}, {name}: {computed!r} is not {printed}, and no reason is given")
    return Row(
        place, name, number.value, float(computed), unit,
        None if are_zero else _difference(float(computed), number.value), verdict, reason,
        text=printed,
    )  # fmt: skip


def _difference(computed: float, printed: float) -> float | None:
    if printed == 0.0 or not math.isfinite(computed):
        return None
    return (computed - printed) / abs(printed)


def compared_formula(
    place: str, name: str, printed: Expr, computed: Expr, *, reason: str = ""
) -> Row:
    """Compare a printed formula with the one that follows from the document's equations.

    It is "reproduced" where the difference is zero for all values of its symbols, else a
    "misprint", since the derivation is the document's own.

    Parameters
    ----------
    place, name : str
    printed, computed : sympy expression
    reason : str
        What the formula follows from, or what shows which is right.

    Examples
    --------
    >>> from sympy import symbols
    >>> s, k = symbols("s K_p2")
    >>> compared_formula("(52)", "V loop", k / (s + k), 1 / (1 + s / k)).verdict
    'reproduced'
    >>> compared_formula("(68)", "V loop", k / (s + k), k / (k - s), reason="(42)").verdict
    'misprint'
    """
    from sympy import simplify

    same = simplify(printed - computed) == 0
    verdict: Verdict = "reproduced" if same else "misprint"
    if not same and not reason:
        raise ValueError(f"{place}, {name}: the formula differs, and no reason is given")
    return Row(place, name, str(printed), str(computed), "", None, verdict, reason)


def stated(place: str, name: str, printed: str, right: str, is_right: bool, reason: str) -> Row:
    """Compare what is printed in words, a caption or a label, with what has to stand there.

    Parameters
    ----------
    place, name : str
    printed, right : str
        What stands there, and what the check finds to be right.
    is_right : bool
        Whether the printed words are right, as computed.
    reason : str
        What the check is.

    Examples
    --------
    >>> stated("Table 4", "caption", "regarding C(t)", "regarding V(t)", False, "eV").verdict
    'misprint'
    """
    return Row(
        place, name, printed, right, "", None, "reproduced" if is_right else "misprint", reason
    )


def claimed(
    place: str, name: str, claim: str, holds: bool, computed: str, unit: str = "", *, reason: str
) -> Row:
    """Judge a claim in words by what was computed.

    Parameters
    ----------
    place, name : str
    claim : str
        What the document says, in short.
    holds : bool
        Whether it does.
    computed : str
        The figures that decide.
    unit : str
    reason : str

    Examples
    --------
    >>> claimed("section 4", "overshoot", "no overshoot", False, "3.2 %", reason="of V").verdict
    'claim fails'
    """
    verdict: Verdict = "claim holds" if holds else "claim fails"
    return Row(place, name, claim, computed, unit, None, verdict, reason)


def circular(row: Row, solved_from: str) -> Row:
    """Return a row whose agreement proves nothing: "consistent" where it was "reproduced".

    Parameters
    ----------
    row : Row
    solved_from : str
        What the computed number was solved from or fitted to, the printed one among it.

    Examples
    --------
    >>> row = compared("Table 7", "IE of V", "1.24E-02", 0.01242)
    >>> circular(row, "The step follows from this cell.").verdict
    'consistent'
    """
    if row.verdict not in ("reproduced", "claim holds"):
        return row
    return dataclasses.replace(row, verdict="consistent", reason=_joined(solved_from, row.reason))


def damaged(row: Row, looks_like: str) -> Row:
    """Return a row that the conversion of the document to text seems to have damaged.

    It is "damaged text" where it would be a "misprint" or "not reproducible"; what agrees is as
    it was.

    Parameters
    ----------
    row : Row
    looks_like : str
        What in the text looks like damage of the conversion.

    Examples
    --------
    >>> row = compared("(98)", "Q4", "100", 10.0, right_if=[("Q4 of (97a)", True)])
    >>> damaged(row, "A decimal point is lost.").verdict
    'damaged text'
    """
    if row.verdict not in ("misprint", "not reproducible"):
        return row
    return dataclasses.replace(row, verdict="damaged text", reason=_joined(looks_like, row.reason))


def undecided(row: Row, hangs_on: str) -> Row:
    """Return a number that agrees in one reading of the document and not in another, as a remark.

    What is reproduced in the reading that stands in the row is as it was.

    Parameters
    ----------
    row : Row
    hangs_on : str
        In which readings it agrees.

    Examples
    --------
    >>> row = compared("Table 5", "rise", "6.3", 7.7, unprinted="The controller.")
    >>> undecided(row, "It agrees in 1 of 4 readings.").verdict
    'remark'
    """
    if row.verdict != "not reproducible":
        return row
    return dataclasses.replace(row, verdict="remark", reason=_joined(hangs_on, row.reason))


def remark(place: str, name: str, text: str, computed: str, unit: str = "", *, reason: str) -> Row:
    """Return a claim that holds in one reading of what the document leaves open, and not in all.

    Parameters
    ----------
    place, name : str
    text : str
        What the document has there.
    computed : str
        What we find.
    unit : str
    reason : str

    Examples
    --------
    >>> remark("section 5", "speed", "is faster", "settles sooner, rises later", reason="").verdict
    'remark'
    """
    return Row(place, name, text, computed, unit, None, "remark", reason)


def _joined(*sentences: str) -> str:
    return " ".join(sentence for sentence in sentences if sentence)


def short(value: float) -> str:
    """Return a number in as many digits as a reader compares.

    Examples
    --------
    >>> short(0.001234567), short(3469.9123), short(2.0)
    ('0.001235', '3470', '2')
    """
    return f"{value:.4g}"
