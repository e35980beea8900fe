"""A linguistic input: what it stands for in a process, and how it is read in a sample."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.filters import filtered_derivative, gap_error
from clepsydra.controllers.blocks.ports import GOOD, PV, SP, truth, words_for
from clepsydra.controllers.blocks.validity import all_of, is_number, time_step_of, value_or_zero
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

Quantity = Literal["error", "error_rate", "measurement", "measurement_rate"]

_GAIN = signals.signed("gain", "1/{input}", "gain of {input}", 1.0)
_DEAD_ZONE = signals.amount("dead_zone", "{input}", "half width of the dead zone of {input}")
_FILTER_TIME = signals.amount("filter_time", "s", "time constant of the filter of {input}")
#: What a reader is told above the steps of an input.
_WORDS = {
    "rate": "filtered derivative",
    "outside": "what lies outside of the dead zone",
    "scaled": "zero where it is no number, though a parameter were changed at run time",
    "filtered": "only what was computed from sound signals is remembered",
}


@dataclass(frozen=True)
class FuzzyInput:
    """What a linguistic input stands for.

    Parameters
    ----------
    quantity : {"error", "error_rate", "measurement", "measurement_rate"}
        The error is setpoint less measurement; a rate is a filtered derivative.
    measurement : Signal
        Of the process.
    """

    quantity: Quantity
    measurement: Signal

    @property
    def is_rate(self) -> bool:
        """Whether it is a derivative."""
        return self.quantity.endswith("_rate")

    @property
    def is_of_error(self) -> bool:
        """Whether it needs a setpoint."""
        return self.quantity.startswith("error")

    def crisp(self, name: str) -> Signal:
        """Return what the linguistic variable of a name stands for, in its units."""
        units = signals.per(self.measurement, "s") if self.is_rate else self.measurement
        words = f"{name}, {self.quantity.replace('_', ' ')} of {self.measurement.name}"
        return Signal(words, units.unit, units.display_unit)

    def parameters(self, name: str) -> list[Signal]:
        """Return gain, dead_zone and, of a rate, filter_time of a linguistic variable."""
        return [key.of(name, input=self.crisp(name)) for key in _keys(self.is_rate)]

    def state(self, name: str) -> list[Signal]:
        """Return filtered, of a rate."""
        words = f"filtered {self.quantity.removesuffix('_rate')} behind {name}"
        kept = Signal(path(name, "filtered"), self.measurement.unit, description=words)
        return [kept] if self.is_rate else []

    @property
    def block(self) -> Block:
        """From pv, good and sp to scaled, and to numbers, whether that may be used."""
        return _block(self.quantity, self.is_rate, self.is_of_error)


def _keys(is_rate: bool) -> tuple[Key, ...]:
    return (_GAIN, _DEAD_ZONE, _FILTER_TIME) if is_rate else (_GAIN, _DEAD_ZONE)


@cache
def _block(quantity: str, is_rate: bool, is_of_error: bool) -> Block:
    read = (*([SP] if is_of_error else []), PV)
    timed = (GOOD, signals.TIME_STEP.port) if is_rate else ()

    def equations(s: Symbols) -> Equations:
        state: dict[str, ca.SX] = {}
        valid = all_of([is_number(s[port.name]) for port in read])
        value, *measured = (value_or_zero(s[port.name], valid) for port in read)
        if measured:
            value = value - measured[0]
        named = {"valid": valid}
        if measured and not is_rate:
            named["error"] = value
        if is_rate:
            time_step, good = time_step_of(s)
            value, filtered = filtered_derivative(value, s["filtered"], s["filter_time"], time_step)
            sound = all_of([valid, s["good"], good, is_number(filtered)])
            state["filtered"] = ca.if_else(sound, filtered, s["filtered"])
            named |= {"time_step_good": good, "time_step_used": time_step}
            named |= {"rate": value, "next_filtered": filtered}
        outside = gap_error(value, s["dead_zone"], ca.SX(0))
        product = s["gain"] * outside
        numbers = ca.logic_and(valid, is_number(product))
        results = {"scaled": value_or_zero(product, numbers), "numbers": numbers}
        named |= {"outside": outside, "product": product}
        return Equations(state, results, named, words_for(_WORDS, state, results, named))

    return Block(
        f"fuzzy_{quantity}",
        (*read, *(key.port for key in _keys(is_rate)), *timed),
        (Signal("filtered", description="the quantity behind its filter"),) if is_rate else (),
        (
            Signal("scaled", description="times its gain, before it is clipped to its range"),
            truth("numbers", "it is a number"),
        ),
        equations,
        (f"The {quantity.replace('_', ' ')} with dead zone and gain, for the rules.",),
    )
