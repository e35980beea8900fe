"""Linguistic inputs and outputs: what they stand for in a process, and their blocks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import next_integral, tracking_share
from clepsydra.controllers.blocks.filters import filtered_derivative, gap_error
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_WORDS,
    declare_output,
    give_output,
    output_end,
    output_ports,
    output_results,
)
from clepsydra.controllers.blocks.ports import GOOD, PV, SP, Asked, truth, words_for
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import all_of, is_number, time_step_of, value_or_zero
from clepsydra.controllers.fuzzy.inference import CRISP
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

Action = Literal["position", "increment"]

_OUTPUT_GAIN = signals.signed("output_gain", "{output}", "gain to {output}", 1.0, bolder=1.0)
_OFFSET = Key("offset", "{output}", "what a bumpless start adds to {output}")
_INFERRED = (
    *CRISP,
    truth("numbers", "the inputs of its rules are numbers"),
    truth("sensors", "their sensors are sound"),
)
#: What a reader is told above the steps of an output.
_OUTPUT_WORDS = OUTPUT_WORDS | {
    "usable": "valid: good inputs, and a rule fires",
    "offset_moved": "the offset fades, but not further into saturation; in manual it follows",
    "offset_kept": "not a number: ignored",
}
_POSITION = "The centroid is where the output goes; an offset makes a change of mode bumpless."
_INCREMENT = "The centroid is how fast the output moves, from what was applied."


@dataclass(frozen=True)
class FuzzyOutput:
    """What a linguistic output does to its manipulated variable.

    `moved`: the manipulated variable; `action`: the centroid is where it goes, or how fast it
    moves.
    """

    moved: Signal
    action: Action = "position"
    rate_limited: bool = False

    @property
    def is_position(self) -> bool:
        """Whether it is where the manipulated variable goes."""
        return self.action == "position"

    @property
    def crisp(self) -> Signal:
        """What the centroid of a gain of one is, in its units."""
        units = self.moved if self.is_position else signals.per(self.moved, "s")
        return replace(units, name=self.moved.name)

    def move(self, sample: Sample, **wish: ca.SX) -> None:
        """Write from the centroid to what is applied."""
        u, keys = self.moved, _output_keys(self.is_position)
        sample.parameters(*(key.of(u, output=self.crisp) for key in keys))
        if self.is_position:
            sample.memory(_OFFSET.of(u, output=u))
        declare_output(sample, u, rate_limited=self.rate_limited)
        block = _output_block(self.is_position, self.rate_limited)
        give_output(sample, u, sample.call(block, path(u, "output"), u, **wish))


def _output_keys(is_position: bool) -> tuple[Key, ...]:
    return (_OUTPUT_GAIN, signals.FADING_TIME) if is_position else (_OUTPUT_GAIN,)


@cache
def _output_block(is_position: bool, rate_limited: bool) -> Block:
    def equations(s: Symbols) -> Equations:
        wish, last = s["output_gain"] * s["centroid"], s["last_output"]
        time_step, _ = time_step_of(s)
        usable = all_of([s["numbers"], s["sensors"], s["fires"]])
        asked = wish + s["offset"] if is_position else last + time_step * wish
        given = Asked(asked, usable, s["numbers"], s["sensors"])
        applied, results, named = output_end(s, given, rate_limited=rate_limited)
        state = {"last_output": applied.applied}
        if is_position:
            fades = tracking_share(time_step, s["fading_time"]) * s["offset"]
            moves = {"integral_used": s["offset"], "proportional": wish, "increment": -fades}
            state["offset"], on_the_way = next_integral(
                "conditional_integration", moves, applied, known=usable, last_applied=last
            )
            named |= {"offset_moved": on_the_way["integral_moved"], "offset_kept": state["offset"]}
            named["fades"] = fades
        named |= {"wish": wish, "asked": asked, "usable": usable}
        return Equations(state, results, named, words_for(_OUTPUT_WORDS, state, results, named))

    name = "fuzzy_position" if is_position else "fuzzy_increment"
    kept = (LAST_OUTPUT, _OFFSET.port) if is_position else (LAST_OUTPUT,)
    return Block(
        f"rate_limited_{name}" if rate_limited else name,
        (*_INFERRED, *(key.port for key in _output_keys(is_position)), *output_ports(rate_limited)),
        kept,
        output_results(rate_limited),
        equations,
        (_POSITION if is_position else _INCREMENT,),
    )


Quantity = Literal["error", "error_rate", "measurement", "measurement_rate"]

_GAIN = signals.signed("gain", "1/{input}", "gain of {input}", 1.0)
_DEAD_ZONE = signals.amount("dead_zone", "{input}", "half width of the dead zone of {input}")
_FILTER_TIME = signals.amount("filter_time", "s", "time constant of the filter of {input}")
#: What a reader is told above the steps of an input.
_INPUT_WORDS = {
    "rate": "filtered derivative",
    "outside": "what lies outside of the dead zone",
    "scaled": "not a number: counts as zero",
    "filtered": "remembers valid signals only",
}


@dataclass(frozen=True)
class FuzzyInput:
    """What a linguistic input stands for.

    `quantity`: the error is setpoint less measurement; a rate is a filtered derivative;
    `measurement`: of the process.
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

    def read(self, sample: Sample, name: str) -> dict[str, ca.SX]:
        """Return scaled of a linguistic variable, and numbers, whether that may be used."""
        keys = _input_keys(self.is_rate)
        sample.parameters(*(key.of(name, input=self.crisp(name)) for key in keys))
        if self.is_rate:
            words = f"filtered {self.quantity.removesuffix('_rate')} behind {name}"
            unit = self.measurement.unit
            sample.memory(Signal(path(name, "filtered"), unit, description=words))
        block = _input_block(self.quantity)
        return sample.call(block, path(name, "input"), name, self.measurement)


def _input_keys(is_rate: bool) -> tuple[Key, ...]:
    return (_GAIN, _DEAD_ZONE, _FILTER_TIME) if is_rate else (_GAIN, _DEAD_ZONE)


@cache
def _input_block(quantity: Quantity) -> Block:
    is_rate, is_of_error = quantity.endswith("_rate"), quantity.startswith("error")
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
        return Equations(state, results, named, words_for(_INPUT_WORDS, state, results, named))

    return Block(
        f"fuzzy_{quantity}",
        (*read, *(key.port for key in _input_keys(is_rate)), *timed),
        (Signal("filtered", description="the quantity behind its filter"),) if is_rate else (),
        (
            Signal("scaled", description="times its gain, before it is clipped to its range"),
            truth("numbers", "it is a number"),
        ),
        equations,
        (f"The {quantity.replace('_', ' ')} with dead zone and gain, for the rules.",),
    )
