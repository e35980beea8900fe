"""A manipulated variable at the end of a control scheme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.handover import Asked, Limits
from clepsydra.controllers.structure.block import Closed, Opened, WithoutSignals
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class OutputBlock(WithoutSignals):
    """One manipulated variable of a control scheme.

    Parameters
    ----------
    number : int
        i, from 1.
    signal : Signal
        The process input.
    source : str
        The port that moves it in automatic.
    rate_limited : bool
        Whether it has a rate_limit_i.

    Examples
    --------
    >>> block = OutputBlock(1, Signal("pump_1", "V", low=0.0, high=10.0), "level", True)
    >>> [signal.name for signal in block.parameters()]
    ['low_limit_1', 'high_limit_1', 'rate_limit_1']
    """

    number: int
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
        found = signals.limit_parameters(self.number, self.signal)
        if self.rate_limited:
            found.append(
                Signal(
                    f"rate_limit_{self.number}",
                    signals.ratio_of_units(self.signal.unit, "s"),
                    low=0.0,
                    high=signals.LARGEST_PARAMETER,
                    initial=signals.LARGEST_PARAMETER,
                    description=f"largest rate of change of {self.signal.name}",
                )
            )
        return found

    def state(self) -> list[Signal]:
        """The last output."""
        return [signals.last_output(self.number, self.signal)]

    def outputs(self) -> list[Signal]:
        """Manipulated variable and status word."""
        return signals.output_signals(self.number, self.signal)

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Its own."""
        low, high = symbols[f"low_limit_{self.number}"], symbols[f"high_limit_{self.number}"]
        return (Limits(low, high),)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Move the actuator."""
        element = final_element(
            symbols, self.number, self.signal, asked[0], rate_limited=self.rate_limited
        )
        closed = Closed(
            {f"last_output_{self.number}": element.manipulated},
            {
                f"manipulated_{self.number}": element.manipulated,
                f"status_{self.number}": element.status,
            },
            (element.applied,),
            element.named,
        )
        return Opened((), lambda applied: closed)
