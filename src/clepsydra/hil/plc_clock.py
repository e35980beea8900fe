"""The clock of a soft PLC, by which it measures the time between two scans."""

from __future__ import annotations

from dataclasses import dataclass

#: The least that its clock counts, of a real clock [s].
_COUNT = 1e-3


@dataclass
class PlcClock:
    """A clock that counts milliseconds, as `TIME()` does, on a plant that may run faster.

    At several times real time its counts are as many milliseconds of the plant; they are a little
    longer where a period is no whole number of them, so that scans in time are a period apart.

    Parameters
    ----------
    sampling_period : float
        Of the plant [s].
    period : float
        The same by a real clock: less where the plant runs faster [s].
    origin : float
        Of that clock, where a deadline stands [s].

    Examples
    --------
    Twenty times as fast as real time a millisecond late is 20 ms late:

    >>> clock = PlcClock(1.0, 0.05, 100.0)
    >>> [clock.step(100.0 + now) for now in (0.0, 0.0503, 0.1012, 0.1501)]
    [1.0, 1.0, 1.02, 0.98]
    """

    sampling_period: float
    period: float
    origin: float

    def __post_init__(self) -> None:
        self._counts = max(1, int(self.period / _COUNT))
        self._last: int | None = None

    def step(self, now: float) -> float:
        """Return the time since the last scan; in the first one a period [s of the plant]."""
        count = round((now - self.origin) / self.period * self._counts)
        # Nothing ran before: the sampling period, as docs/plc.md wires it.
        passed = self._counts if self._last is None else count - self._last
        self._last = count
        return self.sampling_period * passed / self._counts

    def begin(self) -> None:
        """Know of no scan before, as after the power came back."""
        self._last = None
