"""A setpoint beyond the end of its range: the controller holds it there."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.base.signal import path
from clepsydra.hil.case import CASES, Act, Case, Episode, Hands, Subject, Verdict

#: Beyond the end, as a share of the range; samples until it is back, and in all.
_BEYOND, _BACK, _SAMPLES = 0.1, 6, 30


def _acts(subject: Subject) -> Mapping[int, Act]:
    name, level = path(subject.level, "sp"), subject.level

    def beyond(hands: Hands) -> None:
        tag = hands.table.tags[name]
        hands.operate(name, tag.on_wire(level.high + _BEYOND * level.span))

    def back(hands: Hands) -> None:
        hands.operate(name, hands.table.tags[name].on_wire(level.initial))

    return {2: beyond, 2 + _BACK: back}


def _judge(episode: Episode) -> Verdict:
    limited = episode.told("setpoint_limited")
    holds = bool(limited.any()) and not limited[-1]
    words = "held at the end of the range, status 16384" if limited.any() else "taken as it was"
    return Verdict(holds, f"{words}, for {int(limited.sum())} scans")


CASES.add(
    "setpoint-out-of-range",
    Case(3, "setpoint out of range", True, _acts, lambda _: _SAMPLES, _judge),
)
