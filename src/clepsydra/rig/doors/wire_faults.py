"""What an instructor does to the wires of a rig: late answers, lost requests, a pulled cable."""

from __future__ import annotations

import random

from clepsydra.rig.image import ProcessImage
from clepsydra.rig.tag import LATEST_ANSWER, WIRE_CUT, WIRE_DELAY, WIRE_LOSS


class WireFaults:
    """The faults that stand in a process image now.

    Parameters
    ----------
    image : ProcessImage
    seed : int
        Of which requests are lost: the same ones, counted over all clients, every time.
    """

    def __init__(self, image: ProcessImage, seed: int) -> None:
        self._image, self._draws = image, random.Random(seed)

    @property
    def delay(self) -> float:
        """How much later an answer is sent [s]."""
        told = self._image.read(WIRE_DELAY)
        return min(told, LATEST_ANSWER) if told > 0.0 else 0.0

    @property
    def cut(self) -> bool:
        """Whether nobody is connected, nor can be."""
        return self._image.read(WIRE_CUT) != 0.0

    def loses(self) -> bool:
        """Return whether the next request is lost."""
        share = self._image.read(WIRE_LOSS)
        return share > 0.0 and self._draws.random() < share
