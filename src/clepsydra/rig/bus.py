"""What a controller has of a bus: tags by name, read and written in the units of its ports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol


class BusFault(Exception):
    """A read or a write that did not go through.

    Parameters
    ----------
    bus : str
        Where: "Modbus TCP 127.0.0.1:5020".
    tag : str
        The tag that it was about, or the first of several; empty for the connection itself.
    words : str
        What the other end said or did, with the register or node.
    answered : bool
        Whether the other end answered, so that it is alive and has refused; else it is silent.
    """

    def __init__(self, bus: str, tag: str, words: str, *, answered: bool) -> None:
        super().__init__(": ".join(part for part in (bus, tag, words) if part))
        self.bus, self.tag, self.words, self.answered = bus, tag, words, answered

    def __reduce__(self) -> tuple[object, ...]:
        """Return it with its fields, for the process that hears of it."""
        return _fault, (self.bus, self.tag, self.words, self.answered)


def _fault(bus: str, tag: str, words: str, answered: bool) -> BusFault:
    return BusFault(bus, tag, words, answered=answered)


class Bus(Protocol):
    """The way of a controller to the tags of a plant: Modbus TCP, OPC UA.

    After a fault the same bus can be used again: it connects anew where it has to.
    """

    async def open(self) -> None:
        """Connect.

        Raises
        ------
        BusFault
            Nobody is there.
        """

    async def read(self, names: Iterable[str]) -> dict[str, float]:
        """Return the values of tags, in the units of their signals; 0 and 1 of switches.

        Raises
        ------
        BusFault
        """

    async def write(self, values: Mapping[str, float]) -> None:
        """Give tags values, in the units of their signals.

        Raises
        ------
        BusFault
        """

    async def close(self) -> None:
        """Leave; what is closed already stays closed."""
