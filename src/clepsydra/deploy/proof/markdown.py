"""A proof as a page of Markdown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.deploy.proof.words import HEADS, cells, next_step, notes, result_sentence

if TYPE_CHECKING:
    from clepsydra.deploy.proof.proof import Proof


def proof_markdown(proof: Proof) -> str:
    """Return the table of a proof, its notes and what ran it.

    Examples
    --------
    >>> from clepsydra.deploy.proof.proof import Proof
    >>> proof_markdown(Proof(())).splitlines()[:3]
    ['# Proof', '', 'Nothing was compared.']
    """
    lines = ["# Proof", "", result_sentence(proof), ""]
    lines += [_line(("controller or process", *HEADS)), _line(["---"] * (len(HEADS) + 1))]
    lines += [_line((row.subject, *cells(row))) for row in proof.rows]
    said = notes(proof)
    if said:
        lines += ["", *(f"- {_plain(note)}" for note in said)]
    lines += [
        "",
        "Differences are shares of the signal's range. Decisions are integer and boolean outputs "
        "and states that differ.",
        "",
        f"{proof.scans:,} scans, seed {proof.seed}; {'; '.join(proof.versions)}.",
        "",
        f"Next: {next_step(proof)}",
        "",
    ]
    return "\n".join(lines)


def _line(texts: tuple[str, ...] | list[str]) -> str:
    return "| " + " | ".join(_plain(text) for text in texts) + " |"


def _plain(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())
