"""Feedforward: terms of other signals added to what a loop asks for; decoupling too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.filters import filtered_derivative
from clepsydra.controllers.blocks.ports import Applied, Asked, Limits, instance, truth
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import is_number, time_step_of, value_or_zero
from clepsydra.controllers.signals import amount, last_output, signed
from clepsydra.controllers.structure.block import Opened, PlainBlock
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


@dataclass(frozen=True)
class FeedforwardTerm:
    """One signal that acts on a loop's output: gain (1 + lead s)/(1 + lag s) (x − x°).

    `owner`: what its parameters belong to; `moved`: what it is added to: an output, or another
    loop's setpoint; `signal`: the process signal; `measured`: whether it is a measurement; else it
    is another output, for decoupling; `dynamic`: whether it has a lead and a lag; else it acts at
    once.
    """

    owner: str
    moved: Signal
    signal: Signal
    measured: bool
    dynamic: bool

    def parameters(self) -> list[Signal]:
        """Gain and reference; lead and lag where dynamic."""
        roles = {"output": self.moved, "signal": self.signal}
        return [
            _GAIN.of(self.owner, **roles),
            _REFERENCE.of(self.owner, self.signal.initial, **roles),
            *(key.of(self.owner, **roles) for key in _DYNAMICS if self.dynamic),
        ]


_WAY = "from {signal} to {output}"
_GAIN = signed("gain", "{output}/{signal}", f"gain {_WAY}")
_REFERENCE = signed("reference", "{signal}", "{signal} at which it adds nothing")
_DYNAMICS = tuple(amount(what, "s", f"{what} time {_WAY}") for what in ("lead", "lag"))


@dataclass(frozen=True)
class FeedforwardBlock(PlainBlock):
    """A sum: what a loop asks for, and feedforward from other signals.

    With the last outputs of the other loops as signals it is inverted decoupling. A signal that
    fails leaves its term where it went to at last, and the loop goes on. The limits after
    it bound the loop's part loosely.

    `source`: the loop's port; `moved`: what the sum moves: an output, or another loop's setpoint.

    References
    ----------
    H. L. Wade, Inverted decoupling: a neglected technique, ISA Transactions 36(1), 1997, 3-10.
    """

    name: str
    source: str
    moved: Signal
    terms: tuple[FeedforwardTerm, ...]

    @property
    def sources(self) -> tuple[str, ...]:
        """The loop."""
        return (self.source,)

    def parameters(self) -> list[Signal]:
        """Those of all terms."""
        return [parameter for term in self.terms for parameter in term.parameters()]

    def open(self, sample: Sample, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Add the terms."""
        (source,) = asked
        added, sensors = ca.SX(0), source.sensors
        for term in self.terms:
            block, name = _feedforward(term.dynamic, term.measured), instance(term.owner)
            sample.memory(Signal(path(term.owner, "lagged_signal"), term.signal.unit))
            if term.measured:
                read = sample.of(term.signal, "pv", "good")
                sensors = ca.logic_and(sensors, read[1])
            else:
                read = sample.memory(last_output(term.signal))
            given = dict(zip(("signal", "sensor"), read, strict=False))
            added = added + sample.call(block, name, term.owner, **given)["added"]
        value = source.asked + added

        def close(applied: Sequence[Applied]) -> tuple[Applied, ...]:
            (result,) = applied
            # What was applied as asked is told to the last bit: no rounding looks like a limit.
            applied_here = result.applied
            got = ca.if_else(applied_here == value, source.asked, applied_here - added)
            return (replace(result, applied=got),)

        return Opened((replace(source, asked=value, sensors=sensors),), close)


@cache
def _feedforward(dynamic: bool, sensed: bool) -> Block:
    """Return the block of a term; a signal that is an output of the law has no sensor."""

    def equations(s: Symbols) -> Equations:
        good = is_number(s["signal"])
        if sensed:
            good = ca.logic_and(good, s["sensor"])
        deviation = value_or_zero(s["signal"], good) - s["reference"]
        good = ca.logic_and(good, is_number(deviation))
        taken = ca.if_else(good, deviation, s["lagged_signal"])
        if not dynamic:
            return Equations({"lagged_signal": taken}, {"added": s["gain"] * taken})
        time_step, time_step_good = time_step_of(s)
        # (1 + lead s)/(1 + lag s) by backward differences; times below zero count as zero.
        rate, following = filtered_derivative(
            taken, s["lagged_signal"], ca.fmax(0, s["lag"]), time_step
        )
        value = following + ca.fmax(0, s["lead"]) * rate
        kept = ca.logic_and(time_step_good, is_number(following))
        lagged = ca.if_else(kept, following, s["lagged_signal"])
        return Equations({"lagged_signal": lagged}, {"added": s["gain"] * value})

    return Block(
        f"{'dynamic' if dynamic else 'static'}_feedforward{'' if sensed else '_of_output'}",
        (
            Signal("signal", description="what acts on the output"),
            *([truth("sensor", "its sensor is good")] if sensed else []),
            _GAIN.port,
            _REFERENCE.port,
            *((*(key.port for key in _DYNAMICS), Signal("time_step", "s")) if dynamic else ()),
        ),
        (Signal("lagged_signal", description="the signal less its reference, lagged"),),
        (Signal("added", description="added value, in the unit of the output"),),
        equations,
        ("A failed signal holds the added value.",),
    )
