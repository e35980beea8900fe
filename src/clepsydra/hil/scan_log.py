"""What a soft PLC has recorded of its scans."""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from clepsydra.hil.scanner import Scan

if TYPE_CHECKING:
    import numpy as np

#: What stands before the inputs and outputs of each scan.
OF_SCAN = (
    "sample", "began", "lateness", "took", "read", "written", "power",
)  # fmt: skip


@dataclass
class ScanLog:
    """The scans of a soft PLC, in order.

    Of each it holds the plant's `sample` that it read, when it `began` [s since the PLC's first
    deadline, of a real clock], its `lateness` behind its deadline and how long it `took` [s],
    whether inputs were `read` and outputs `written` (0 or 1), and of the first scan after the
    `power` came back 1 without and 2 with kept state, else 0; then all inputs and outputs of the
    program, in their units.

    Parameters
    ----------
    inputs, outputs : tuple of str
        Of the program.

    Attributes
    ----------
    events : list
        Scan and words of what happened to the PLC, or on its bus.
    left_out : int
        Scans that were left out since the one before took too long, or the machine slept.

    Examples
    --------
    >>> log = ScanLog(("level.pv",), ("pump.out",))
    >>> log.add(Scan(7, "", "", (4.5,), (3.0,)), began=0.0, lateness=1e-4, took=2e-3)
    >>> log.column("sample").tolist(), log.found()["pump.out"].tolist(), log.lost
    ([7.0], [3.0], (0, 0))
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    events: list[tuple[int, str]] = field(default_factory=list)
    left_out: int = 0
    _numbers: array[float] = field(default_factory=lambda: array("d"), repr=False)

    def __len__(self) -> int:
        return len(self._numbers) // self._width

    @property
    def _width(self) -> int:
        return len(OF_SCAN) + len(self.inputs) + len(self.outputs)

    def add(
        self, scan: Scan, *, began: float, lateness: float, took: float, power: int = 0
    ) -> None:
        """Record a scan."""
        for words in filter(None, (scan.read, scan.written)):
            self.events.append((len(self), words))
        told = (scan.sample, began, lateness, took, not scan.read, not scan.written, power)
        self._numbers.extend((*map(float, told), *scan.given, *scan.found))

    def note(self, words: str) -> None:
        """Record what happens before the next scan."""
        self.events.append((len(self), words))

    @property
    def table(self) -> np.ndarray:
        """All of it [scans, columns]."""
        import numpy as np

        return np.array(self._numbers).reshape(len(self), self._width)

    def column(self, name: str) -> np.ndarray:
        """Return one of `OF_SCAN` [scans]."""
        found: np.ndarray = self.table[:, OF_SCAN.index(name)]
        return found

    def given(self) -> dict[str, np.ndarray]:
        """Return the inputs of the program by name [scans]."""
        return self._columns(self.inputs, len(OF_SCAN))

    def found(self) -> dict[str, np.ndarray]:
        """Return the outputs of the program by name [scans]."""
        return self._columns(self.outputs, len(OF_SCAN) + len(self.inputs))

    @property
    def lost(self) -> tuple[int, int]:
        """Scans whose inputs, and whose outputs, did not get through."""
        read, written = (int((self.column(name) == 0.0).sum()) for name in ("read", "written"))
        return read, written

    @property
    def unseen(self) -> int:
        """Samples of the plant, from the first one read to the last, that no scan has read."""
        import numpy as np

        seen = np.unique(self.column("sample")[self.column("read") == 1.0])
        return int(seen[-1] - seen[0]) + 1 - len(seen) if len(seen) else 0

    def _columns(self, names: Iterable[str], first: int) -> dict[str, np.ndarray]:
        table = self.table
        return {name: table[:, place] for place, name in enumerate(names, first)}
