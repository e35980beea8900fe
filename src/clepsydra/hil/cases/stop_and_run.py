"""The PLC goes to STOP, and to RUN again: the rig's outputs are fail-safe meanwhile."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.hil.case import CASES, Act, Case, Episode, Subject, Verdict
from clepsydra.hil.commands import Stop

#: Samples beyond the silence for which it stands, and after.
_BEYOND, _AFTER = 15, 40


def _stands(subject: Subject) -> int:
    return subject.silence + _BEYOND


def _acts(subject: Subject) -> Mapping[int, Act]:
    stop = Stop(seconds=_stands(subject) * subject.process.sampling_period)
    runs = 2 + _stands(subject)
    return {
        2: lambda hands: hands.command(stop),
        runs + 10: lambda hands: hands.press(True),
        runs + 14: lambda hands: hands.press(False),
    }


def _judge(episode: Episode) -> Verdict:
    silent = ~episode.heard
    safe = bool((episode.all_safe | ~silent).all()) and bool(silent.any())
    back = bool(episode.heard[-1]) and not episode.told("failed_safe")[-1]
    lost = int(episode.told("scan_lost").sum())
    words = f"fail-safe for {int(silent.sum())} samples of silence"
    after = "controls again" if back else "does not control again"
    return Verdict(safe and back and lost > 0, f"{words}; in RUN status 32768, then it {after}")


CASES.add(
    "stop-and-run",
    Case(8, "STOP and RUN", False, _acts, lambda s: 2 + _stands(s) + _AFTER, _judge),
)
