"""One PID loop of a control scheme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.final_element import give_output
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.ports import instance
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.block import Opened, WithoutSignals
from clepsydra.controllers.structure.loop_blocks import loop_in_two_calls, loop_with_output
from clepsydra.controllers.structure.pid_loop import PidLoop
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class PidBlock(WithoutSignals):
    """A PID loop: it measures one signal and moves an output, or another loop's setpoint.

    Parameters
    ----------
    name : str
        What other blocks call it.
    owner : str
        What its parameters and its state belong to.
    measurement : Signal
        The process measurement.
    moved : Signal
        What it moves; lends unit and range.
    setpoint : str
        The law's input for it, or the port of the block that gives it.
    inner : bool
        Whether another block gives the setpoint (the outer loop of a cascade).
    direct : bool
        Whether it moves an output and nothing stands between.

    Examples
    --------
    >>> level, pump = Signal("level", "m"), Signal("pump", "V")
    >>> block = PidBlock("loop", "level", PidForm(), level, pump, "level.sp")
    >>> [signal.name for signal in block.state()]
    ['level.integral', 'level.last_proportional_gain', 'level.last_setpoint_weight']
    """

    name: str
    owner: str
    form: PidForm
    measurement: Signal
    moved: Signal
    setpoint: str
    inner: bool = False
    direct: bool = True

    @classmethod
    def of(cls, measurement: Signal, form: PidForm, moved: Signal, *, direct: bool = True) -> Self:
        """Return the loop of a measurement whose setpoint the operator gives."""
        name, setpoint = measurement.name, path(measurement, "sp")
        return cls(f"loop {name}", name, form, measurement, moved, setpoint, direct=direct)

    @property
    def sources(self) -> tuple[str, ...]:
        """The block that gives the setpoint, if one does."""
        return (self.setpoint,) if self.inner else ()

    @property
    def loop(self) -> PidLoop:
        """What it computes."""
        return PidLoop(self.form, self.inner, self.direct)

    def parameters(self) -> list[Signal]:
        """Settings of the loop; of an inner one also the limits of its setpoint."""
        return self.loop.parameters(self.owner, self.measurement, self.moved)

    def state(self) -> list[Signal]:
        """Integral, and what it remembers of the last sample."""
        return self.loop.state(self.owner, self.measurement, self.moved)

    def inputs(self) -> list[Signal]:
        """Where the setpoint may be chosen: the other setpoint and the choice."""
        return self.loop.inputs(self.owner, self.measurement)

    def faceplate(self) -> list[Signal]:
        """What an operator sees of the loop."""
        return self.loop.faceplate(self.owner, self.measurement, self.moved)

    def limits(self, sample: Sample, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Those of its setpoint, if another block gives it."""
        if not self.inner:
            return ()
        return (Limits(*sample.of(self.owner, "setpoint_low_limit", "setpoint_high_limit")),)

    def _signals(self, sample: Sample) -> dict[str, ca.SX]:
        measurement, sensor = sample.of(self.measurement, "pv", "good")
        setpoint = {} if self.inner else {"sp": sample[self.setpoint]}
        return {**setpoint, "pv": measurement, "good": sensor}

    def closed(self, sample: Sample, output: Signal, *, rate_limited: bool) -> None:
        """Run the whole sample of a loop that moves an output with nothing between."""
        block, name = loop_with_output(self.loop, rate_limited), path(output, "loop")
        found = sample.call(block, name, self.owner, output, **self._signals(sample))
        self._show(sample, found)
        give_output(sample, output, found)

    def _show(self, sample: Sample, found: Symbols) -> None:
        """Name what an operator sees, for who gives it."""
        sample.name(self.owner, {each.name: found[each.name] for each in self.loop.results})

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Compute what it asks for, and keep how its memory goes on."""
        asking, telling = loop_in_two_calls(self.loop)
        own = self._signals(sample)
        own |= {"low_limit": limits[0].low, "high_limit": limits[0].high}
        if self.direct:
            (own["last_applied"],) = sample.of(self.moved, "last_output")
        for outer in asked:
            own |= outer.ports("remote_")
        name = instance(self.name)
        found = sample.call(asking, path(name, "asks"), self.owner, **own)

        def close(applied: Sequence[Applied]) -> tuple[Applied, ...]:
            given = {**own, **found, **applied[0].ports()}
            got = sample.call(telling, path(name, "is_told"), self.owner, **given)
            self._show(sample, got)
            return (Applied.read(got, "got_"),) if self.inner else ()

        return Opened((Asked.read(found),), close)
