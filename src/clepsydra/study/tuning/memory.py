"""What a tuning has computed, in memory and in a file, so that it can go on another day."""

from __future__ import annotations

import json
import time
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file

#: A file is written no more often than this, and at the end [s].
_PAUSE = 2.0
_FORMAT = 1


class Memory:
    """Every candidate that was simulated, by the bits of its point.

    A search is deterministic, so going on is doing it again from the beginning: what is
    remembered costs nothing, and the result is that of a search without a break.

    Parameters
    ----------
    width : int
        Numbers kept of each candidate.
    digest : str
        Of the problem; a file of another problem is refused.

    Examples
    --------
    >>> memory = Memory(1, "one tank")
    >>> memory.rows[b"a point's bits"] = [3.2]
    >>> len(memory.rows)
    1
    """

    def __init__(self, width: int, digest: str) -> None:
        self.rows: dict[bytes, list[float]] = {}
        self.sensitivities: dict[bytes, float] = {}
        self._width, self._digest = width, digest
        self._written = 0.0

    def save(self, path: Path) -> None:
        """Write everything to a file."""
        said = {
            "format": _FORMAT,
            "problem": self._digest,
            "candidates": [[key.hex(), row] for key, row in self.rows.items()],
            "sensitivities": [[key.hex(), value] for key, value in self.sensitivities.items()],
        }
        with whole_file(path) as part:
            part.write_text(json.dumps(said), encoding="utf-8")
        self._written = time.monotonic()

    def save_now_and_then(self, path: Path) -> None:
        """Write everything to a file, if the last time was a while ago."""
        if time.monotonic() - self._written > _PAUSE:
            self.save(path)

    def load(self, path: Path) -> None:
        """Read what was written; a file that is not there yet is empty.

        Raises
        ------
        InputError
            The file cannot be read, is none of a tuning, or is of another problem.
        """
        if not path.exists():
            return
        place = f"tuning, {path}"
        try:
            said = json.loads(path.read_text(encoding="utf-8"))
            format_, digest = said["format"], said["problem"]
            rows = {bytes.fromhex(key): list(map(float, row)) for key, row in said["candidates"]}
            known = {bytes.fromhex(key): float(value) for key, value in said["sensitivities"]}
            whole = all(len(row) == self._width for row in rows.values())
        except OSError as error:
            raise InputError(
                place, error.strerror or "no access", "a file that can be read", "choose another"
            ) from None
        except (ValueError, TypeError, KeyError, AttributeError):
            raise InputError(
                place, "something else", "what an interrupted tuning wrote", "choose another file"
            ) from None
        if format_ != _FORMAT or digest != self._digest or not whole:
            raise InputError(
                place, "the state of another problem",
                "one of this process, controller, scenario, objective and bounds",
                "choose another file, or delete this one to begin again",
            )  # fmt: skip
        self.rows, self.sensitivities = rows, known
