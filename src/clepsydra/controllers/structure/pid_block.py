"""One PID loop of a control scheme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_WORDS,
    give_output,
    output_end,
    output_ports,
    output_results,
)
from clepsydra.controllers.blocks.ports import (
    APPLIED,
    ASKED,
    Applied,
    Asked,
    Limits,
    instance,
    prefixed,
    truth,
    with_used_inputs,
    words_for,
)
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.signals import last_output
from clepsydra.controllers.structure.block import Opened
from clepsydra.controllers.structure.pid_loop import PidLoop
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_TRUTHS = ("setpoint_is_number", "measurement_is_number", "signals_known", "setpoint_is_remote")


@cache
def loop_with_output(loop: PidLoop, rate_limited: bool = False) -> Block:
    """Return the block of a loop that moves an output with nothing between."""

    def equations(s: Symbols) -> Equations:
        own = {**s, "last_applied": s["last_output"]}
        wish, carried = loop.asks(own, None)
        applied, results, named = output_end(own, wish, rate_limited=rate_limited)
        state, _, wound = loop.told({**own, **carried}, applied)
        results |= loop.shows({**own, **carried}, applied)
        named = {**carried, **named, **wound}
        state["last_output"] = applied.applied
        words = words_for(loop.words | OUTPUT_WORDS, state, results, named)
        return Equations(state, results, named, words)

    return Block(
        f"rate_limited_{loop.form.block}" if rate_limited else loop.form.block,
        (*loop.takes, *output_ports(rate_limited)),
        (*loop.memory, LAST_OUTPUT),
        (*output_results(rate_limited), *loop.results),
        equations,
        (loop.form.words,),
    )


@cache
def loop_in_two_calls(loop: PidLoop) -> tuple[Block, Block]:
    """Return the block that asks, and the one that is told; the second has the state."""
    outer = prefixed(ASKED, "remote_") if loop.inner else ()
    last = (Signal("last_applied"),) if loop.direct else ()
    given = (*outer, *loop.takes, Signal("time_step", "s"), *last)

    def asks(s: Symbols) -> Equations:
        wish, carried = loop.asks(s, Asked.read(s, "remote_") if outer else None)
        outputs = {**wish.ports(), **{name: carried[name] for name in needed}}
        return Equations({}, outputs, carried, words_for(loop.words, carried))

    def updated(s: Symbols) -> Equations:
        applied = Applied.read(s)
        following, got, named = loop.told(s, applied)
        outputs = loop.shows(s, applied) | ({} if got is None else got.ports("got_"))
        return Equations(following, outputs, named, words_for(loop.words, following, named))

    symbols = {entry.name: ca.SX.sym(entry.name) for entry in (*given, *loop.memory)}
    needed: list[str] = []
    carried = asks(symbols).intermediates
    passed = tuple(truth(n, "") if n in _TRUTHS else Signal(n) for n in carried)
    ends = Signal("low_limit"), Signal("high_limit")
    words = (loop.form.words,)
    told = (*(prefixed(APPLIED, "got_") if loop.inner else ()), *loop.results)
    name = f"{loop.form.block}{'_inner' if loop.inner else ''}{'_at_output' if last else ''}"
    ports = (*APPLIED, *given, *passed, *ends)
    telling = with_used_inputs(Block(f"{name}_update", ports, loop.memory, told, updated, words))
    needed += [signal.name for signal in passed if signal in telling.inputs]
    outputs = (*ASKED, *(signal for signal in passed if signal.name in needed))
    asking = with_used_inputs(
        Block(f"{name}_demand", (*given, *loop.memory), (), outputs, asks, words)
    )
    return asking, telling


@dataclass(frozen=True)
class PidBlock(PidLoop):
    """A PID loop in a control scheme.

    Examples
    --------
    >>> level, pump = Signal("level_1", "m"), Signal("pump_1", "V")
    >>> loop = PidBlock.of(level, PidForm(), pump)
    >>> loop.setpoint, loop.parameters()[0].unit, loop.state()[0].name
    ('level_1.sp', 'V/m', 'level_1.integral')
    """

    @classmethod
    def of(cls, measurement: Signal, form: PidForm, moved: Signal, *, direct: bool = True) -> Self:
        """Return the loop of a measurement whose setpoint the operator gives."""
        name, setpoint = measurement.name, path(measurement, "sp")
        return cls(f"loop {name}", name, form, measurement, moved, setpoint, direct=direct)

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
        sample.memory(*self.state(), last_output(output))
        block, name = loop_with_output(self.kind, rate_limited), path(output, "loop")
        found = sample.call(block, name, self.owner, output, **self._signals(sample))
        self._show(sample, found)
        give_output(sample, output, found)

    def _show(self, sample: Sample, found: Symbols) -> None:
        """Name what an operator sees, for who gives it."""
        sample.name(self.owner, {each.name: found[each.name] for each in self.kind.results})

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Compute what it asks for, and keep how its memory goes on."""
        sample.memory(*self.state())
        asking, telling = loop_in_two_calls(self.kind)
        own = self._signals(sample)
        own |= {"low_limit": limits[0].low, "high_limit": limits[0].high}
        if self.direct:
            (own["last_applied"],) = sample.memory(last_output(self.moved))
        for outer in asked:
            own |= outer.ports("remote_")
        name = instance(self.name)
        found = sample.call(asking, path(name, "demand"), self.owner, **own)

        def close(applied: Sequence[Applied]) -> tuple[Applied, ...]:
            given = {**own, **found, **applied[0].ports()}
            got = sample.call(telling, path(name, "update"), self.owner, **given)
            self._show(sample, got)
            return (Applied.read(got, "got_"),) if self.inner else ()

        return Opened((Asked.read(found),), close)
