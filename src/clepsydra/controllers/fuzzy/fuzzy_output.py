"""A linguistic output: what it does to its manipulated variable."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import next_integral, tracking_share
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_WORDS,
    output_end,
    output_ports,
    output_results,
)
from clepsydra.controllers.blocks.ports import Asked, truth, words_for
from clepsydra.controllers.blocks.validity import all_of, time_step_of
from clepsydra.controllers.fuzzy.inference import CRISP
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

Action = Literal["position", "increment"]

_OUTPUT_GAIN = signals.signed("output_gain", "{output}", "gain to {output}", 1.0)
_FADES = "time in which a bumpless start of {output} fades"
_FADING_TIME = signals.amount("fading_time", "s", _FADES, 60.0, low=signals.SHORTEST_TIME)
_OFFSET = Key("offset", "{output}", "what a bumpless start adds to {output}")
_INFERRED = (
    *CRISP,
    truth("numbers", "the inputs of its rules are numbers"),
    truth("sensors", "their sensors are sound"),
)
#: What a reader is told above the steps of an output.
_WORDS = OUTPUT_WORDS | {
    "usable": "it may be acted on: sound inputs, and a rule fires",
    "offset_moved": "the offset fades, but not further into saturation; in manual it follows",
    "offset_kept": "what is no number is not taken",
}
_POSITION = "The centroid is where the output goes; an offset makes a change of mode bumpless."
_INCREMENT = "The centroid is how fast the output moves, from what was applied."


@dataclass(frozen=True)
class FuzzyOutput:
    """What a linguistic output does to its manipulated variable.

    Parameters
    ----------
    moved : Signal
        The manipulated variable.
    action : {"position", "increment"}
        The centroid is where it goes, or how fast it moves.
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

    def parameters(self) -> list[Signal]:
        """Return output_gain, fading_time of a position, limits and rate_limit."""
        own = [key.of(self.moved, output=self.crisp) for key in _keys(self.is_position)]
        return own + signals.limit_parameters(self.moved, rate_limited=self.rate_limited)

    def state(self) -> list[Signal]:
        """Return offset, of a position."""
        return [_OFFSET.of(self.moved, output=self.moved)] if self.is_position else []

    @property
    def block(self) -> Block:
        """From the centroid to what is applied."""
        return _block(self.is_position, self.rate_limited)


def _keys(is_position: bool) -> tuple[Key, ...]:
    return (_OUTPUT_GAIN, _FADING_TIME) if is_position else (_OUTPUT_GAIN,)


@cache
def _block(is_position: bool, rate_limited: bool) -> Block:
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
        return Equations(state, results, named, words_for(_WORDS, state, results, named))

    name = "fuzzy_position" if is_position else "fuzzy_increment"
    kept = (LAST_OUTPUT, _OFFSET.port) if is_position else (LAST_OUTPUT,)
    return Block(
        f"rate_limited_{name}" if rate_limited else name,
        (*_INFERRED, *(key.port for key in _keys(is_position)), *output_ports(rate_limited)),
        kept,
        output_results(rate_limited),
        equations,
        (_POSITION if is_position else _INCREMENT,),
    )
