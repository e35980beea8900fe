"""What the plant of a rig went through, sample by sample, taken from its image."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clepsydra.rig.image import ImageLayout, ProcessImage


@dataclass
class PlantRows:
    """All that a plant told, and all that moved it, in its samples [SI].

    An image keeps the last rows only; who asks it from time to time has all.

    Parameters
    ----------
    layout : ImageLayout
    """

    layout: ImageLayout
    _parts: list[np.ndarray] = field(default_factory=list, repr=False)

    def take(self, image: ProcessImage) -> None:
        """Take what the plant went through since the last time.

        Raises
        ------
        ValueError
            Samples are missing: the image has been overwritten meanwhile.
        """
        while len(rows := image.kept_since(self.last)):
            if rows[0, 0] != self.last + 1:
                raise ValueError(f"samples {self.last + 1} to {rows[0, 0] - 1:.0f} are gone")
            self._parts.append(rows.copy())

    @property
    def last(self) -> int:
        """The last sample; −1 for none."""
        return int(self._parts[-1][-1, 0]) if self._parts else -1

    def column(self, name: str) -> np.ndarray:
        """Return what was told, or what moved the plant, in each sample from 0 on [samples]."""
        place = 2 + self.layout.columns.index(name)
        return np.concatenate([np.empty(0), *(part[:, place] for part in self._parts)])
