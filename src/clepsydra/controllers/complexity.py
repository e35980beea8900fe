"""How much a controller asks of the plant and of those who look after it."""

from __future__ import annotations

from enum import IntEnum


class Complexity(IntEnum):
    """What a controller is made of; the smaller, the more people can look after it.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> cl.design.simc(plant).complexity.words
    'PI or PID loops'
    >>> cl.design.lqi(plant).complexity.words
    'a model, and more measurements than are controlled'
    """

    LOOPS = 1
    ADVANCED_LOOPS = 2
    MODEL = 3
    MODEL_WITH_MORE_MEASUREMENTS = 4

    @property
    def words(self) -> str:
        """What it is, in a few words."""
        return _WORDS[self]


_WORDS = {
    Complexity.LOOPS: "PI or PID loops",
    Complexity.ADVANCED_LOOPS: "loops with decoupling, feedforward, cascade, rules or schedules",
    Complexity.MODEL: "a model in the controller, and no further sensors",
    Complexity.MODEL_WITH_MORE_MEASUREMENTS: "a model, and more measurements than are controlled",
}
