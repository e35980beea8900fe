"""How much native code does before it gives control back, so that it can be interrupted."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Self

#: A call that takes less than the one is followed by a longer one, and above the other by a
#: shorter one [s].
_SHORT, _LONG = 0.05, 0.3


class Pacing:
    """So many units of work a call that each call takes some tenths of a second.

    Parameters
    ----------
    pace : int
        Units of the first call; later ones follow from how long it took.

    Examples
    --------
    >>> with Pacing(100) as pacing:
    ...     done = list(range(pacing.pace))
    >>> len(done)
    100
    """

    def __init__(self, pace: int) -> None:
        self.pace = pace
        self._begun = 0.0

    def __enter__(self) -> Self:
        self._begun = time.perf_counter()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        taken = time.perf_counter() - self._begun
        if taken < _SHORT:
            self.pace *= 2
        elif taken > _LONG:
            self.pace = max(self.pace // 2, 1)
