"""What the scans of a proof exercised, so that a proof of nothing is seen."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np

from clepsydra.deploy.proof.instance import Array
from clepsydra.program.program import Program


@dataclass(frozen=True)
class Coverage:
    """What was seen of the outputs of a program.

    Parameters
    ----------
    seen : tuple of str
        Bits of status words and truth values that were on in one scan and off in another, as
        "pump.status bit 4" (the bit of value 16).
    unseen : tuple of str
        Those that were not.
    still : tuple of str
        Outputs of real numbers that never moved.
    moved : tuple of str
        Those that did.

    Examples
    --------
    >>> Coverage(("pump.status bit 0",), ("pump.status bit 7",), (), ("pump.out",)).sentence
    '1 of 2 status bits seen on and off; not pump.status bit 7'
    """

    seen: tuple[str, ...]
    unseen: tuple[str, ...]
    still: tuple[str, ...]
    moved: tuple[str, ...]

    def as_dict(self) -> dict[str, list[str]]:
        """Return all of it for JSON."""
        return {name: list(found) for name, found in asdict(self).items()}

    @property
    def is_idle(self) -> bool:
        """Whether no real output moved at all, so that a comparison says nothing.

        Where there is no real output, whether no status bit or truth value was seen to change.
        """
        if self.still or self.moved:
            return not self.moved
        return not self.seen

    @property
    def sentence(self) -> str:
        """What was seen, in a line."""
        total = len(self.seen) + len(self.unseen)
        said = f"{len(self.seen)} of {total} status bits seen on and off" if total else ""
        if self.unseen:
            said += f"; not {', '.join(self.unseen)}"
        if self.still:
            said += ("; " if said else "") + f"never moved: {', '.join(self.still)}"
        return said


def coverage(program: Program, table: Array) -> Coverage:
    """Return what outputs and states [scans, q + n] show of a program."""
    seen: list[str] = []
    unseen: list[str] = []
    still: list[str] = []
    moved: list[str] = []
    for column, signal in enumerate(program.outputs):
        values = table[:, column]
        if signal.record:
            # What a structure tells stands elsewhere, too.
            continue
        if signal.kind == "boolean":
            both = bool(values.any() and not values.all())
            (seen if both else unseen).append(signal.name)
        elif signal.kind == "real":
            moves = len(np.unique(values[~np.isnan(values)])) > 1
            (moved if moves else still).append(signal.name)
        elif signal.part.startswith("status") and math.isfinite(signal.high):
            word = values.astype(np.int64)
            for bit in range(int(signal.high).bit_length()):
                on = word >> bit & 1
                name = f"{signal.name} bit {bit}"
                (seen if 0 < on.sum() < len(on) else unseen).append(name)
    return Coverage(tuple(seen), tuple(unseen), tuple(still), tuple(moved))
