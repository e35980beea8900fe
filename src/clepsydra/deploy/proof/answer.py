"""A proof in a screen: a line for each controller and process, and every target on request."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.deploy.proof.finding import findings, rounded_up
from clepsydra.deploy.proof.row import ProofRow
from clepsydra.deploy.proof.words import HEADS, cells, next_step, notes, result_sentence

if TYPE_CHECKING:
    from clepsydra.deploy.proof.proof import Proof

#: Controllers and processes that are listed, and findings that are told, each in two lines.
_LISTED, _TOLD = 16, 4
_EMPTY = Line("")


def proof_answer(proof: Proof, *, every: bool = False) -> Section:
    """Return how a proof came out, a line for each controller and process, and what to do next.

    Parameters
    ----------
    proof : Proof
    every : bool
        Whether with every target, the notes and the versions.

    Examples
    --------
    >>> from clepsydra.deploy.proof.proof import Proof
    >>> proof_answer(Proof(())).parts[0].text
    'Nothing was compared.'
    """
    rows = _by_subject(proof.rows)
    subjects = list(rows)
    told = [f"{name}: {words}" for name in subjects for words in _amiss(proof, rows[name])]
    listed = subjects if every else subjects[: _LISTED - 2 * min(len(told), _TOLD)]
    parts: list[Line | Table | Section] = [Line(result_sentence(proof), Mark.ANSWER)]
    if listed:
        parts += [_EMPTY, _table({name: rows[name] for name in listed})]
    parts += marked(Mark.WATCH, told if every else told[:_TOLD])
    if every:
        for name in subjects:
            table = Table("", HEADS, tuple(map(cells, rows[name])), names=3, kept=4)
            parts += [_EMPTY, Section(name, (table,))]
        parts += [_EMPTY, *marked(Mark.POINT, notes(proof))]
        parts.append(Line(f"{proof.scans:,} scans, seed {proof.seed}; {'; '.join(proof.versions)}"))
    elif subjects:
        more = len(subjects) - len(listed) + max(len(told) - _TOLD, 0)
        parts.append(Line(f"{f'{more} more, and e' if more else 'E'}very target: --all"))
    return Section("", (*parts, _EMPTY, Line(f"Next: {next_step(proof)}")))


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


def _amiss(proof: Proof, rows: Sequence[ProofRow]) -> list[str]:
    """Return what is to be told of a controller or process beside its line."""
    name = rows[0].subject
    clean = ("equal", "within the bound", "reported")
    said = [words for row, words in findings(rows) if row.verdict not in clean]
    if name in proof.coverage and proof.coverage[name].still:
        said.append(f"never moved: {', '.join(proof.coverage[name].still)}")
    return [f"{words}." for words in said]


def _table(rows_of: dict[str, list[ProofRow]]) -> Table:
    rows = []
    for name, rows_of_one in rows_of.items():
        double = [row for row in rows_of_one if row.precision == "double"]
        single = [row for row in rows_of_one if row.precision == "single"]
        rows.append((name, _double(double), _single(single)))
    head = ("controller or process", "double precision", "single precision")
    return Table("", head, tuple(rows), names=3, kept=2)


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
    return next((row.verdict for row in rows if row.verdict != "equal"), "")
