"""Power off, and on again with nothing retained: outputs begin at their fail-safe values."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.hil.case import CASES, Act, Case, Episode, Subject, Verdict
from clepsydra.hil.commands import PowerCycle

#: Samples beyond the silence without power, and after.
_BEYOND, _AFTER = 5, 40


def _off(subject: Subject) -> int:
    return subject.silence + _BEYOND


def _acts(subject: Subject) -> Mapping[int, Act]:
    cycle = PowerCycle(seconds=_off(subject) * subject.process.sampling_period, retained=False)
    on = 2 + _off(subject)
    return {
        2: lambda hands: hands.command(cycle),
        on + 10: lambda hands: hands.press(True),
        on + 14: lambda hands: hands.press(False),
    }


def _judge(episode: Episode) -> Verdict:
    lost = episode.told("state_lost")
    safe = bool((episode.all_safe | episode.heard).all())
    back = bool(episode.heard[-1]) and not lost[-1]
    words = f"begins at its fail-safe values, status 131072 for {int(lost.sum())} scans"
    told = "and controls again" if back else "and does not control again"
    return Verdict(safe and back and bool(lost.any()), f"{words}, {told} once acknowledged")


CASES.add(
    "power-cycle",
    Case(9, "power cycle", False, _acts, lambda s: 2 + _off(s) + _AFTER, _judge),
)
