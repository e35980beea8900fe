"""What the blocks of a control scheme tell each other, forward and backward."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.ports import Applied, Asked, Limits
from clepsydra.controllers.blocks.sample import Sample


class Opened(NamedTuple):
    """A block on the way forward: what it asks for, and how its sample ends.

    `asked`: one for each of its ports; `close`: takes what was applied at each port and returns
    what it tells back, one for each source.
    """

    asked: tuple[Asked, ...]
    close: Callable[[Sequence[Applied]], tuple[Applied, ...]]


class PlainBlock(Protocol):
    """What a block is that says nothing else: a port of its name, no signals, limits handed on."""

    @property
    def ports(self: Block) -> tuple[str, ...]:
        """The names under which others take what it asks for; each is taken once."""
        return (self.name,)

    def parameters(self) -> list[Signal]:
        """Its parameters."""
        return []

    def inputs(self) -> list[Signal]:
        """Inputs that it has beside measurements, setpoints and what belongs to outputs."""
        return []

    def limits(self: Block, sample: Sample, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Between which values it takes each source, from the limits after each port."""
        return (after[0],) * len(self.sources)


class Block(PlainBlock, Protocol):
    """A part of a control scheme: a loop, a selector, an output.

    A sample runs forward from setpoints to outputs, each block asking something of the next
    one, and then backward, each telling what was applied, so that every integral knows it:
    limits, selectors and hands far behind it included.
    """

    @property
    def name(self) -> str:
        """What others call it."""

    @property
    def sources(self) -> tuple[str, ...]:
        """The ports whose values it takes."""

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Run forward from what the sources ask for; `limits` are those after each port."""
