"""White noise of a signal, said in a few numbers, so that whoever has them can make it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.engine.white_noise import stream_of, white_noise


@dataclass(frozen=True)
class Noise:
    """White, normal noise of a signal in a stretch of samples.

    Parameters
    ----------
    signal : str
        A measurement or a disturbance.
    deviation : float
        Its standard deviation, in the unit of the signal.
    first, count : int
        The first sample that has it, and how many.

    Examples
    --------
    The noise of a sample is the same in any stretch that has it:

    >>> whole, end = Noise("level_1", 0.05, 0, 100), Noise("level_1", 0.05, 90, 10)
    >>> bool(np.all(end.values(seed=1) == whole.values(seed=1)[90:]))
    True
    """

    signal: str
    deviation: float
    first: int
    count: int

    @property
    def stream(self) -> int:
        """Its stream of the generator, which is that of its signal in any process."""
        return stream_of(self.signal)

    def values(self, seed: int) -> np.ndarray:
        """Return the noise [count] of a seed, not negative."""
        return self.deviation * white_noise(seed, self.stream, self.first, self.count)
