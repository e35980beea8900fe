"""From a printed and a computed number to a verdict, by computation alone."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from clepsydra.papers.printed import Printed, PrintedTable
from clepsydra.papers.row import Row, Verdict

if TYPE_CHECKING:
    from sympy import Expr

#: What the document itself says elsewhere, in words, and whether it holds.
Evidence = tuple[str, bool]


def compared(
    printed: Printed,
    computed: float,
    *,
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
    printed : Printed
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
    >>> compared(Printed("(97b)", "F21", "13.8661", note="Riccati"), 13.866069).verdict
    'reproduced'
    >>> line = Printed("(97b)", "Fi12", "3.0536")
    >>> row = compared(line, 10**0.5, right_if=[("Fi12² is Q4 / R1", True)])
    >>> row.verdict, round(row.difference, 4)
    ('misprint', 0.0356)
    """
    why, said = why or printed.note, f"{printed.place}, {printed.name}"
    if (tolerance or zero) and not why:
        raise ValueError(f"{said}: a tolerance needs its reason")
    number = printed.number
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
        raise ValueError(f"{said}: {computed!r} is not {printed.text}, and no reason is given")
    row = _row(printed, verdict, float(computed), reason, number.value)
    difference = None if are_zero else _difference(float(computed), number.value)
    return dataclasses.replace(row, difference=difference, text=printed.text)


def compared_all(table: PrintedTable, place: str, computed: Mapping[str, float]) -> list[Row]:
    """Compare the numbers of a place by name, whose notes say what they come from.

    Examples
    --------
    >>> table = {("(97b)", "F21"): Printed("(97b)", "F21", "13.8661")}
    >>> [row.verdict for row in compared_all(table, "(97b)", {"F21": 13.866069})]
    ['reproduced']
    """
    return [compared(table[place, name], float(value)) for name, value in computed.items()]


def compared_formulas(table: PrintedTable, place: str, computed: Mapping[str, Expr]) -> list[Row]:
    """Compare the formulas of a place by name, whose notes say what they follow from."""
    return [compared_formula(table[place, name], value) for name, value in computed.items()]


def entries(name: str, matrix: Any) -> dict[str, Any]:
    """Return the entries of a matrix by name, or by a pattern of it, row by row.

    Examples
    --------
    >>> import numpy as np
    >>> list(entries("A", np.eye(2))), list(entries("row {}, column {}", np.eye(1)))
    (['A11', 'A12', 'A21', 'A22'], ['row 1, column 1'])
    """
    rows, columns = matrix.shape
    pattern = name if "{}" in name else f"{name}{{}}{{}}"
    return {pattern.format(i + 1, j + 1): matrix[i, j] for i in range(rows) for j in range(columns)}


def _row(
    printed: Printed,
    verdict: Verdict,
    computed: float | str,
    reason: str,
    shown: float | str | None = None,
) -> Row:
    """Return the row of a line, whose note is the reason if there is no other.

    It is "damaged text" where it would be a "misprint" or "not reproducible" and the line looks
    damaged.
    """
    shown = printed.text if shown is None else shown
    reason = reason or printed.note
    if printed.damage and verdict in ("misprint", "not reproducible"):
        verdict, reason = "damaged text", _joined(printed.damage, reason)
    return Row(printed.place, printed.name, shown, computed, printed.unit, None, verdict, reason)


def _difference(computed: float, printed: float) -> float | None:
    if printed == 0.0 or not math.isfinite(computed):
        return None
    return (computed - printed) / abs(printed)


def compared_formula(
    printed: Printed, computed: Expr, *, names: Mapping[str, Expr] | None = None, reason: str = ""
) -> Row:
    """Compare a printed formula with the one that follows from the document's equations.

    It is "reproduced" where the difference is zero for all values of its symbols, else a
    "misprint", since the derivation is the document's own.

    Parameters
    ----------
    printed : Printed
    computed : sympy expression
    names : mapping, optional
        What printed names mean that are not those of the computed symbols.
    reason : str
        What the formula follows from, or what shows which is right; the note if left out.

    Examples
    --------
    >>> from sympy import symbols
    >>> s, k = symbols("s K_p2")
    >>> compared_formula(Printed("(52)", "V loop", "K_p2/(s + K_p2)"), 1 / (1 + s / k)).verdict
    'reproduced'
    >>> line = Printed("(68)", "V loop", "K_p2/(s + K_p2)", note="(42)")
    >>> compared_formula(line, k / (k - s)).verdict
    'misprint'
    """
    from sympy import simplify
    from sympy.parsing.sympy_parser import parse_expr

    known = {symbol.name: symbol for symbol in computed.free_symbols} | dict(names or {})
    same = simplify(parse_expr(printed.text, known) - computed) == 0
    if not same and not (reason or printed.note):
        raise ValueError(
            f"{printed.place}, {printed.name}: the formula differs, and no reason is given"
        )
    return _row(printed, "reproduced" if same else "misprint", str(computed), reason)


def compared_for_each(printed: Printed, cases: Iterable[tuple[Expr, Mapping[str, Expr]]]) -> Row:
    """Compare one printed formula in several cases, each with what its names mean there.

    The row shows one that differs, if any does, and else the first.
    """
    rows = [compared_formula(printed, computed, names=names) for computed, names in cases]
    return next((row for row in rows if row.verdict != "reproduced"), rows[0])


def stated(printed: Printed, right: str, is_right: bool, reason: str = "") -> Row:
    """Compare what is printed in words, a caption or a label, with what has to stand there.

    Parameters
    ----------
    printed : Printed
    right : str
        What the check finds to be right.
    is_right : bool
        Whether the printed words are right, as computed.
    reason : str
        What the check is; the note if left out.

    Examples
    --------
    >>> line = Printed("Table 4", "caption", "regarding C(t)", note="eV")
    >>> stated(line, "regarding V(t)", False).verdict
    'misprint'
    """
    return _row(printed, "reproduced" if is_right else "misprint", right, reason)


def claimed(printed: Printed, holds: bool, computed: str, reason: str = "") -> Row:
    """Judge a claim in words by what was computed.

    Parameters
    ----------
    printed : Printed
        What the document says, in short.
    holds : bool
        Whether it does.
    computed : str
        The figures that decide.
    reason : str
        The note if left out.

    Examples
    --------
    >>> line = Printed("section 4", "overshoot", "no overshoot", note="of V")
    >>> claimed(line, False, "3.2 %").verdict
    'claim fails'
    """
    return _row(printed, "claim holds" if holds else "claim fails", computed, reason)


def remark(printed: Printed, computed: str, reason: str = "") -> Row:
    """Return a claim that holds in one reading of what the document leaves open, and not in all.

    Parameters
    ----------
    printed : Printed
        What the document has there.
    computed : str
        What we find.
    reason : str
        The note if left out.

    Examples
    --------
    >>> remark(Printed("section 5", "speed", "is faster"), "settles sooner").verdict
    'remark'
    """
    return _row(printed, "remark", computed, reason)


def circular(row: Row, solved_from: str) -> Row:
    """Return a row whose agreement proves nothing: "consistent" where it was "reproduced".

    Parameters
    ----------
    row : Row
    solved_from : str
        What the computed number was solved from or fitted to, the printed one among it.

    Examples
    --------
    >>> row = compared(Printed("Table 7", "IE of V", "1.24E-02"), 0.01242)
    >>> circular(row, "The step follows from this cell.").verdict
    'consistent'
    """
    if row.verdict not in ("reproduced", "claim holds"):
        return row
    return dataclasses.replace(row, verdict="consistent", reason=_joined(solved_from, row.reason))


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
    >>> row = compared(Printed("Table 5", "rise", "6.3", note="The controller."), 7.7)
    >>> undecided(row, "It agrees in 1 of 4 readings.").verdict
    'remark'
    """
    if row.verdict != "not reproducible":
        return row
    return dataclasses.replace(row, verdict="remark", reason=_joined(hangs_on, row.reason))


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
