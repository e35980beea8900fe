"""The operator takes an output in manual, and gives it back."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.blocks.status import Mode
from clepsydra.hil.case import CASES, Act, Case, Episode, Hands, Subject, Verdict

#: Of the range of the pump; samples in manual, and in all; and the samples that an act may need to
#: get through.
_AWAY, _MANUAL, _SAMPLES, _ACTS = 0.05, 20, 50, 4


def _value(subject: Subject) -> float:
    pump = subject.pump
    sign = 1.0 if pump.to_percent(pump.initial) < 50.0 else -1.0
    return pump.initial + sign * _AWAY * pump.span


def _acts(subject: Subject) -> Mapping[int, Act]:
    pump = subject.pump

    def take(hands: Hands) -> None:
        tag = hands.table.tags[path(pump, "manual")]
        hands.operate(path(pump, "manual"), tag.on_wire(_value(subject)))
        hands.operate(path(pump, "mode"), float(Mode.MANUAL))

    def give(hands: Hands) -> None:
        hands.operate(path(pump, "mode"), float(Mode.AUTOMATIC))

    return {2: take, 2 + _MANUAL: give}


def _judge(episode: Episode) -> Verdict:
    subject = episode.subject
    applied = episode.applied(subject.pump)
    wanted = _value(subject)
    close = np.abs(applied - wanted) <= 1e-3 * subject.pump.span
    obeyed = bool(np.any(close[2 : 2 + _MANUAL]))
    after = applied[2 + _MANUAL : 2 + _MANUAL + _ACTS]
    bump = 100.0 * float(np.max(np.abs(np.diff(after)))) / subject.pump.span
    # The law goes on from what stands there: it moves on by what the error asks for.
    moves = 100.0 * float(np.max(np.abs(np.diff(applied[-20:])))) / subject.pump.span
    holds = obeyed and bump <= max(2.0, 5.0 * moves)
    return Verdict(holds, f"{subject.pump.name} obeyed; back in automatic it moved by {bump:.1f} %")


CASES.add("manual-and-back", Case(2, "manual and back", True, _acts, lambda _: _SAMPLES, _judge))
