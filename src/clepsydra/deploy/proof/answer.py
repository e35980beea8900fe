"""A proof in a screen: a line for each controller and process, and every target on request."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from decimal import ROUND_CEILING, Context, Decimal

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.deploy.proof.limits import LIMITS
from clepsydra.deploy.proof.row import Proof, ProofRow, Verdict
from clepsydra.deploy.proof.words import HEADS, cells, next_step, notes, result_sentence
from clepsydra.deploy.structured_text.dialect import DIALECT_NAMES

#: Controllers and processes that are listed, and findings that are told, each in two lines.
_LISTED, _TOLD = 16, 4
_EMPTY = Line("")
#: What is told, the worst first.
_AMISS: dict[Verdict, str] = {
    "fails": "does not run",
    "differs": "differs",
    "refused": "refused without need",
    "diverges": "does not follow the simulation",
}
_REASONS = {limit.name: limit.reason for limit in LIMITS}
#: "Structured Text, scl", "FMU 3.0", "FMU 3.0 exchange".
_TARGET = re.compile(r"(Structured Text|FMU)[, ]+(\S+)(?: (exchange))?")


def proof_answer(proof: Proof, *, every: bool = False) -> Section:
    """Return how a proof came out, a line for each controller and process, and what to do next.

    Parameters
    ----------
    proof : Proof
    every : bool
        Whether with every target, the notes and the versions.
    """
    rows = _by_subject(proof.rows)
    subjects = list(rows)
    told = [f"{name}: {said}." for name in subjects for said in findings(rows[name], whole=every)]
    still = ((name, seen.still) for name, seen in proof.coverage.items() if not every)
    told += [f"{name}: never moved: {', '.join(found)}." for name, found in still if found]
    listed = subjects if every else subjects[: _LISTED - 2 * min(len(told), _TOLD)]
    parts: list[Line | Table | Section] = [Line(result_sentence(proof), Mark.ANSWER)]
    if listed:
        parts += [_EMPTY, _table({name: rows[name] for name in listed})]
    parts += marked(Mark.WATCH, told if every else told[:_TOLD])
    if every:
        for name in subjects:
            table = Table("", HEADS, tuple(map(cells, rows[name])), names=3)
            parts += [_EMPTY, Section(name, (table,))]
        parts += [_EMPTY, *marked(Mark.POINT, notes(proof))]
        parts.append(Line(f"{proof.scans:,} scans, seed {proof.seed}; {'; '.join(proof.versions)}"))
    elif subjects:
        more = len(subjects) - len(listed) + max(len(told) - _TOLD, 0)
        parts.append(Line(f"{f'{more} more, and e' if more else 'E'}very target: --all"))
    return Section("", (*parts, _EMPTY, Line(f"Next: {next_step(proof)}", Mark.NEXT)))


def proved_so_far(rows: Sequence[ProofRow]) -> Section:
    """Return the last lines of a proof that goes on; nothing where there are none.

    Examples
    --------
    >>> proved_so_far(()).parts
    ()
    """
    listed = list(_by_subject(rows).items())[-_LISTED:]
    return Section("", (_table(dict(listed)),) if listed else ())


def _by_subject(rows: Sequence[ProofRow]) -> dict[str, list[ProofRow]]:
    found: dict[str, list[ProofRow]] = {}
    for row in rows:
        found.setdefault(row.subject, []).append(row)
    return found


def _table(rows_of: dict[str, list[ProofRow]]) -> Table:
    rows: list[tuple[str, ...]] = []
    for name, rows_of_one in rows_of.items():
        double = [row for row in rows_of_one if row.precision == "double"]
        single = [row for row in rows_of_one if row.precision == "single"]
        rows.append((name, _double(double), _single(single)))
    head: tuple[str, ...] = ("controller or process", "double precision", "single precision")
    if not any(row.precision == "single" for each in rows_of.values() for row in each):
        head, rows = head[:2], [row[:2] for row in rows]
    return Table("", head, tuple(rows), names=len(head), kept=2)


def _double(rows: Sequence[ProofRow]) -> str:
    """Return the verdicts of double precision, with how many each where they differ."""
    counts = Counter("equal in every bit" if r.verdict == "equal" else r.verdict for r in rows)
    if len(counts) == 1:
        return next(iter(counts))
    return ", ".join(f"{number} {words}" for words, number in counts.items())


def _single(rows: Sequence[ProofRow]) -> str:
    """Return how far C is off in single precision, and whether that changes the ranking."""
    for row in rows:
        if row.verdict == "reported":
            changes = ", which changes the ranking" if row.scores.get("is_change") else ""
            return f"{rounded_up(row.largest)} of range{changes}"
    if not rows:
        return "not run"
    return next((row.verdict for row in rows if row.verdict != "equal"), "equal to C in every bit")


def findings(rows: Iterable[ProofRow], *, whole: bool = False) -> list[str]:
    """Return what is amiss in the rows of one controller or process, the worst first.

    Rows of which the same is to be said come together.

    Parameters
    ----------
    rows : iterable of ProofRow
    whole : bool
        Whether with all lines of a reason; a compiler writes many.

    Examples
    --------
    >>> rows = [ProofRow("PI", name, "double", "engine", "0f", 9, 1, verdict="fails", reason="?")
    ...         for name in ("C", "FMU 3.0", "FMU 2.0")]
    >>> findings(rows)
    ['does not run: C, FMU 2.0 and 3.0 (?)']
    """
    together: dict[tuple[str, str], list[ProofRow]] = {}
    amiss = [row for row in rows if row.verdict in _AMISS]
    for row in sorted(amiss, key=lambda row: (row.holds, [*_AMISS].index(row.verdict))):
        what = "not run" if row.limit else _AMISS[row.verdict]
        together.setdefault((what, _why(row, whole=whole)), []).append(row)
    return [f"{what}: {_targets(same)} ({why})" for (what, why), same in together.items()]


def _why(row: ProofRow, *, whole: bool) -> str:
    """Return how much or why, of a row that is amiss."""
    if row.verdict == "diverges":
        off = f"{row.signal} is {row.largest:.2g} times its range off in scan {row.scan}"
        return f"{off}; export it in double precision"
    if row.verdict != "differs":
        limit, reason = _REASONS.get(row.limit, ""), row.reason.split("\n")
        said = " ".join(reason if whole else reason[:2])
        return "; ".join(filter(None, [limit, said] if whole else [limit or said]))
    if math.isinf(row.largest):
        return f"{row.signal or 'a decision'} is infinite or not a number in scan {row.scan}"
    said = f"{row.differing:,} of the numbers compared"
    said += f", {row.decisions:,} of them decisions" if row.decisions else ""
    most = f", by up to {rounded_up(row.largest)} of the range of {row.signal} in scan {row.scan}"
    return said + (most if row.largest else "")


def rounded_up(share: float) -> str:
    """Return a share with two digits, rounded up.

    Examples
    --------
    >>> rounded_up(1.01e-5)
    '1.1e-5'
    """
    rounded = Context(prec=2, rounding=ROUND_CEILING).create_decimal(Decimal(repr(share)))
    return f"{float(rounded):g}".replace("e-0", "e-")


def _targets(rows: Iterable[ProofRow]) -> str:
    """Return the names of targets, dialects and versions of one kind together."""
    kinds: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        found = _TARGET.fullmatch(row.target)
        ending = " in single precision" if row.precision == "single" else ""
        if found is None:
            kinds[row.target, ending] = []
        else:
            ending += " for model exchange" if found[3] else ""
            kinds.setdefault((found[1], ending), []).append(found[2])
    names = (f"{name}{_each(name, each)}{end}" for (name, end), each in kinds.items())
    return ", ".join(names)


def _each(name: str, each: list[str]) -> str:
    if name == "FMU":
        return f" {' and '.join(sorted(each))}"
    if len(each) == len(DIALECT_NAMES):
        return f" ({len(each)} dialects)"
    return f" ({', '.join(each)})" if each else ""
