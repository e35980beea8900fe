"""What an earlier proof found, so that a proof goes on where it was interrupted."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.deploy.proof.coverage import Coverage
from clepsydra.deploy.proof.row import ProofRow


@dataclass(frozen=True)
class Known:
    """A row of an earlier proof, with what its scans exercised."""

    row: ProofRow
    coverage: Coverage


def read_memory(path: Path) -> dict[tuple[object, ...], Known]:
    """Return the rows of an earlier proof that compared something and hold, by their keys.

    A file that is not there holds nothing; rows that differ are computed anew.

    Raises
    ------
    InputError
        The file cannot be read, or is something else than a proof.

    Examples
    --------
    >>> read_memory(Path("no-such-proof.json"))
    {}
    """
    if not path.exists():
        return {}
    place = f"proof, {path}"
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
        coverage = {n: Coverage.from_dict(entry) for n, entry in said["coverage"].items()}
        rows = [ProofRow.from_dict(entry) for entry in said["rows"]]
    except OSError as error:
        raise InputError(
            place, error.strerror or "no access", "a file that can be read", "choose another folder"
        ) from None
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(
            place, "something else", "what an earlier proof wrote", "move that file away"
        ) from None
    return {
        row.key: Known(row, coverage[row.subject])
        for row in rows
        if row.holds and row.verdict != "refused" and row.subject in coverage
    }
