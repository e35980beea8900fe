"""A step of the setpoint, as in any simulation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.base.conversion import conversion
from clepsydra.base.signal import path
from clepsydra.base.units import unit_text
from clepsydra.hil.case import CASES, Act, Case, Episode, Hands, Subject, Verdict

#: Of the range of the level; and samples until it is over.
_STEP, _SAMPLES = 0.05, 160


def _setpoint(subject: Subject, shares: float) -> float:
    """Return the setpoint away from rest by a share of the range, in the unit of its tag."""
    level = subject.level
    value = level.initial + shares * level.span
    way = conversion(level.unit, level.shown_unit)
    return value if way is None else float(way(value))


def _acts(subject: Subject) -> Mapping[int, Act]:
    # Towards the middle of the range, where there is room.
    sign = 1.0 if subject.level.to_percent(subject.level.initial) < 50.0 else -1.0
    name = path(subject.level, "sp")

    def step(hands: Hands) -> None:
        hands.operate(name, _setpoint(subject, sign * _STEP))

    def back(hands: Hands) -> None:
        hands.operate(name, _setpoint(subject, 0.0))

    return {2: step, _SAMPLES // 2: back}


def _judge(episode: Episode) -> Verdict:
    level = episode.subject.level
    column = episode.column(level.name)
    way = conversion(level.unit, level.shown_unit)
    moved = float(np.max(np.abs(column - column[0])))
    shown = moved if way is None else float(way(moved))
    holds = moved > 0.2 * _STEP * level.span
    unit = unit_text(level.shown_unit)
    return Verdict(holds, f"{level.name} moved by up to {shown:.3g} {unit} after its setpoint")


CASES.add(
    "setpoint-step",
    Case(1, "setpoint step", True, _acts, lambda subject: _SAMPLES, _judge),
)
