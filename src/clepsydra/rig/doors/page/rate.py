"""How often somebody may do something: so often at once, and then at a rate."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Rate:
    """An allowance that fills itself.

    Parameters
    ----------
    a_second : float
        What it fills by [1/s].
    at_once : float
        What it holds.

    Examples
    --------
    >>> rate = Rate(a_second=1.0, at_once=2.0)
    >>> [rate.allows(now) for now in (0.0, 0.1, 0.2, 1.3)]
    [True, True, False, True]
    """

    a_second: float
    at_once: float
    _left: float = field(init=False)
    _before: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self._left = self.at_once

    def allows(self, now: float) -> bool:
        """Return whether it may be done once more at a time [s]."""
        self._left = min(self.at_once, self._left + (now - self._before) * self.a_second)
        self._before = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
