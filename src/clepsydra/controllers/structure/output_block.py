"""A manipulated variable at the end of a control scheme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.ports import Asked, Limits
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.structure.block import Opened, PlainBlock


@dataclass(frozen=True)
class OutputBlock(PlainBlock):
    """One manipulated variable of a control scheme.

    `signal`: the process input; `source`: the port that moves it in automatic; `rate_limited`:
    whether it has a rate_limit.
    """

    signal: Signal
    source: str
    rate_limited: bool = False

    @property
    def name(self) -> str:
        """The process input."""
        return self.signal.name

    @property
    def sources(self) -> tuple[str, ...]:
        """The port that moves it."""
        return (self.source,)

    @property
    def ports(self) -> tuple[str, ...]:
        """None: the plant comes next."""
        return ()

    def parameters(self) -> list[Signal]:
        """Limits and, where it has one, the rate limit."""
        return signals.limit_parameters(self.signal, rate_limited=self.rate_limited)

    def limits(self, sample: Sample, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Its own."""
        return (Limits(*sample.of(self.signal, "low_limit", "high_limit")),)

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Move the actuator."""
        applied = final_element(sample, self.signal, asked[0], rate_limited=self.rate_limited)
        return Opened((), lambda _: (applied,))
