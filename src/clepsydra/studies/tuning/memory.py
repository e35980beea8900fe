"""What a tuning has computed, in memory and in a file, so that it can go on another day."""

from __future__ import annotations

import hashlib
import json
import math
import struct
import time
from pathlib import Path
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.base.input_file import read_input
from clepsydra.base.standing import Standing, standing_at

#: A file is written no more often than this, and at the end [s].
_PAUSE = 2.0
_FORMAT = 3
#: Most bytes of a file; the longest search of thirty parameters leaves a tenth of it.
_LARGEST = 200_000_000
_WRITTEN = "what an interrupted tuning wrote"
#: A status of a run is a whole number below.
_STATUSES = 2**32


class UnusableState(InputError):
    """The file of an interrupted tuning cannot be gone on with; all as for `InputError`."""


class Memory:
    """Every candidate that was simulated, by the bits of its point.

    A search is deterministic, so going on is doing it again from the beginning: what is
    remembered costs nothing, and the result is that of a search without a break.

    Parameters
    ----------
    parameters : int
        Numbers that make a point.
    width : int
        Numbers kept of each candidate, the last one the status of its run.
    digest : str
        Of the problem.

    Attributes
    ----------
    rows : dict
        Scores and status of each candidate.
    sensitivities : dict
        max|S| of those of which it was looked for.
    drawn : dict
        The quantile over drawn plants, and on how many of them it fails, of those that were tried
        there.
    """

    def __init__(self, parameters: int, width: int, digest: str) -> None:
        self.rows: dict[bytes, list[float]] = {}
        self.sensitivities: dict[bytes, float] = {}
        self.drawn: dict[bytes, list[float]] = {}
        self._point = struct.Struct(f"{parameters}d")
        self._width, self._digest = width, digest
        self._written = 0.0

    def save(self, path: Path) -> None:
        """Write everything to a file."""
        said = {
            "format": _FORMAT,
            "problem": self._digest,
            "candidates": [[key.hex(), row] for key, row in self.rows.items()],
            "sensitivities": [[key.hex(), value] for key, value in self.sensitivities.items()],
            "drawn": [[key.hex(), row] for key, row in self.drawn.items()],
        }
        with whole_file(path) as part:
            part.write_text(json.dumps(said | {"seal": _seal(said)}), encoding="utf-8")
        self._written = time.monotonic()

    def save_now_and_then(self, path: Path) -> None:
        """Write everything to a file, if the last time was a while ago."""
        if time.monotonic() - self._written > _PAUSE:
            self.save(path)

    def load(self, path: Path, *, afresh: bool = False) -> bool:
        """Read what was written; a file that is not there yet is empty.

        Parameters
        ----------
        afresh : bool
            Whether a file of another problem counts as empty, and is not refused.

        Returns
        -------
        bool
            Whether it is of another problem, so that nothing was read.

        Raises
        ------
        UnusableState
            The file cannot be read, is none of a tuning, was changed since, or is of another
            problem.
        """
        place = f"tuning, {path}"
        try:
            if standing_at(path, place, _WRITTEN) is Standing.NOTHING:
                return False
            content = read_input(path, _WRITTEN, _LARGEST)
        except InputError as error:
            raise UnusableState(place, error.value, error.expected, error.remedy) from None
        try:
            said = json.loads(content)
            if said.pop("seal") != _seal(said):
                raise ValueError
            if (said["format"], said["problem"]) != (_FORMAT, self._digest):
                if afresh:
                    return True
                raise UnusableState(
                    place, "the state of another problem",
                    "one of this process, controller, scenario, objective and bounds",
                    "choose another file, or delete this one to begin again",
                )  # fmt: skip
            rows = {self._key(key): self._row(row) for key, row in said["candidates"]}
            peaks = {self._key(key): _number(peak) for key, peak in said["sensitivities"]}
            drawn = {self._key(key): _over_draws(row) for key, row in said["drawn"]}
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError, struct.error):
            raise UnusableState(
                place, "something else, or changed since", _WRITTEN,
                "choose another file, or delete this one to begin again",
            ) from None  # fmt: skip
        self.rows, self.sensitivities, self.drawn = rows, peaks, drawn
        return False

    def _key(self, written: str) -> bytes:
        """Return the bits of a point, whose numbers are finite."""
        bits = bytes.fromhex(written)
        if not all(map(math.isfinite, self._point.unpack(bits))):
            raise ValueError
        return bits

    def _row(self, written: list[Any]) -> list[float]:
        """Return the scores of a candidate and the status of its run."""
        row = [_number(value) for value in written]
        if len(row) != self._width or not (row[-1].is_integer() and 0 <= row[-1] < _STATUSES):
            raise ValueError
        return row


def _over_draws(written: list[Any]) -> list[float]:
    """Return the quantile of a candidate over drawn plants, and on how many it fails."""
    quantile, failed = map(_number, written)
    if not (failed.is_integer() and failed >= 0.0):
        raise ValueError
    return [quantile, failed]


def _number(written: Any) -> float:
    """Return a number as it was written; a score may be infinite or not-a-number."""
    if not isinstance(written, float):
        raise TypeError
    return written


def _seal(said: dict[str, Any]) -> str:
    """Return what shows that a file is as it was written."""
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()
