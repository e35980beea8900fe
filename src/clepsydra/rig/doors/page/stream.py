"""The samples of a plant as one page gets them: in order, and the newest where it is too slow."""

from __future__ import annotations

import numpy as np

from clepsydra.rig.image import ProcessImage

#: Of one page: what it begins with and may be behind, and what it gets at once [bytes].
_BEHIND, _AT_ONCE = 1 << 21, 1 << 18
#: Samples of both at least.
_FEWEST_BEHIND, _FEWEST = 128, 16
_NUMBER = 8


class Stream:
    """Where one page stands in the samples of a rig.

    A page that is further behind than the image keeps, or than it would get in some seconds, goes
    on with the newest samples; what it sees of the others is a gap.

    Parameters
    ----------
    image : ProcessImage
    since : int
        The last sample that it has; −1 for none.
    """

    def __init__(self, image: ProcessImage, since: int = -1) -> None:
        self._image, self._last = image, since
        width = _NUMBER * (2 + len(image.layout.columns))
        self._behind = max(_BEHIND // width, _FEWEST_BEHIND)
        self._most = max(_AT_ONCE // width, _FEWEST)
        self._is_new = True

    @property
    def newest(self) -> int:
        """The last sample that is over; −1 before the first."""
        before = self._image.remembered()
        return -1 if before is None else before[0] - 1

    def take(self) -> np.ndarray:
        """Return the samples that come next, those that there are [rows, 2 + columns]."""
        newest = self.newest
        if newest < self._last:
            # Another plant counts anew.
            self._last = -1
        if newest - self._last > self._behind:
            self._last = newest - (self._behind if self._is_new else self._most)
        self._is_new = False
        rows = self._image.kept_since(self._last, self._most)
        if len(rows):
            self._last = int(rows[-1, 0])
        return rows
