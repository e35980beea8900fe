"""What an earlier proof found, so that a proof goes on where it was interrupted."""

from __future__ import annotations

import json
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.input_file import read_input
from clepsydra.deploy.proof.row import ProofRow

#: A row takes a kilobyte, and no study has a hundred thousand.
_LARGEST = 100_000_000


def read_memory(path: Path) -> dict[tuple[object, ...], ProofRow]:
    """Return the rows of an earlier proof that compared something and hold, by their keys.

    A key holds digests of all that makes a row: of the program, of the printed text that ran, of
    the scans and of what the simulation made of them. So a row is taken for true only where it
    would come out the same. A file that is not there holds nothing; rows that differ or are
    refused are computed anew.

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
    content = read_input(path, "what an earlier proof wrote", _LARGEST)
    try:
        said = json.loads(content)
        rows = [ProofRow.from_dict(entry) for entry in said["rows"]]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise InputError(
            f"proof, {path}", "something else", "what an earlier proof wrote", "move that file away"
        ) from None
    return {row.key: row for row in rows if row.holds and row.verdict != "refused" and row.text}
