"""What an earlier proof found, so that a proof goes on where it was interrupted."""

from __future__ import annotations

import json
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.deploy.proof.row import ProofRow


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
    place = f"proof, {path}"
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
        rows = [ProofRow.from_dict(entry) for entry in said["rows"]]
    except OSError as error:
        raise InputError(
            place, error.strerror or "no access", "a file that can be read", "choose another folder"
        ) from None
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(
            place, "something else", "what an earlier proof wrote", "move that file away"
        ) from None
    return {row.key: row for row in rows if row.holds and row.verdict != "refused" and row.text}
