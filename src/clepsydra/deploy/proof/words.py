"""A proof in words: its result, its cells, its notes, and what to do next."""

from __future__ import annotations

from collections import Counter
from decimal import Decimal

from clepsydra.deploy.proof.row import Proof, ProofRow, Verdict

_SMALLEST_PERCENT = 1e-4
_FAILURES: dict[Verdict, str] = {
    "differs": "outside the bound",
    "fails": "not running",
    "refused": "more refused without need",
}
HEADS = ("target", "precision", "verdict", "largest difference", "compared with", "decisions", "s")


def result_sentence(proof: Proof) -> str:
    """Return how a proof came out."""
    compared = [row for row in proof.rows if row.verdict != "refused"]
    subjects = len({row.subject for row in compared})
    if proof.interrupted:
        return f"Interrupted after {len(proof.rows)} rows."
    if not compared:
        return "Nothing was compared."
    over = f"{_count(subjects, 'program')} in {len(compared)} rows of {proof.scans:,} random scans"
    if proof.failures:
        counts = Counter(row.verdict for row in proof.failures)
        said = [f"{counts[each]} {words}" for each, words in _FAILURES.items() if counts[each]]
        return f"The proof fails: of {over}, {', '.join(said)}."
    if proof.idle:
        return f"The proof says nothing of {', '.join(proof.idle)}: no real output moved."
    verdicts = Counter(row.verdict for row in compared)
    equal = f"{verdicts['equal']} equal in every bit"
    if verdicts["within the bound"]:
        equal += f", {verdicts['within the bound']} within 1e-12 of the range"
    if verdicts["reported"]:
        equal += f", {verdicts['reported']} in single precision"
    if proof.refusals:
        refused = _count(len(proof.refusals), "row")
        equal += f"; {refused} refused by what the target cannot express"
    if proof.diverging:
        names = ", ".join(dict.fromkeys(row.subject for row in proof.diverging))
        return (
            f"The proof holds in double precision: {over}, {equal}. In single precision {names} "
            "diverges from the simulation."
        )
    return f"The proof holds: {over}, {equal}."


def cells(row: ProofRow) -> tuple[str, ...]:
    """Return the cells of a row, as `HEADS` names them."""
    largest, decisions = "–", "–"
    if row.verdict not in ("refused", "fails"):
        largest = "0" if row.largest == 0.0 else f"{row.largest:.2g} of {row.signal}"
        decisions = str(row.decisions)
    return (
        row.target, row.precision, row.verdict, largest, row.against, decisions,
        f"{row.seconds:.1f}",
    )  # fmt: skip


def notes(proof: Proof) -> list[str]:
    """Return what is to be said of rows and subjects beside what is amiss, a sentence each."""
    said = [
        f"{row.subject}: {words}"
        for row in proof.rows
        if row.verdict in ("reported", "diverges")
        for words in (row.reason, _score_sentence(row) if row.scores else "")
        if words
    ]
    seen = proof.coverage.items()
    return said + [f"{name}: {each.sentence}" for name, each in seen if each.unseen or each.still]


def _score_sentence(row: ProofRow) -> str:
    scores = row.scores
    if not scores["score"]:
        return "single precision changes no score of the loop"
    verb = "changes" if scores["is_change"] else "does not change"
    said = f"single precision {verb} the ranking"
    if scores["ranking"] is None:
        said += ": its number is finite in one precision only"
    elif scores["ranking"] != 1.0:
        said += f": its number differs by {_percent(scores['ranking'] - 1.0)}"
    if scores["change"] is None:
        return f"{said}; {scores['score']} is finite in one precision only"
    return f"{said}; the score that changes most is {scores['score']}, by " + _percent(
        scores["change"]
    )


def _percent(share: float) -> str:
    """Return a share in percent with two digits, without an exponent."""
    percent = 100.0 * abs(share)
    if 0.0 < percent < _SMALLEST_PERCENT:
        return f"less than {_SMALLEST_PERCENT:.4f} %"
    return f"{Decimal(f'{percent:.2g}'):f} %"


def next_step(proof: Proof) -> str:
    """Return what to do next."""
    if proof.interrupted:
        return "run the same command again: it goes on from here."
    if any(row.verdict == "refused" for row in proof.failures):
        return "mend what is refused without need; the reasons are above."
    if proof.failures:
        return (
            "do not use the targets that differ; look at the scan and signal named above, and "
            "try another compiler where C differs."
        )
    if not proof.holds:
        return "choose controllers that can be exported; the reasons are above."
    return "clepsydra export writes the files of a controller for the plant."


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
