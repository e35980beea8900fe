"""Scans that come late, and the same of them in their own time again."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.hil.case import CASES, Act, Case, Episode, Subject, Verdict
from clepsydra.hil.commands import Delay

#: How many, and by which share of a period; samples in all.
_LATE, _BY, _SAMPLES = 5, 0.5, 30


def _acts(subject: Subject) -> Mapping[int, Act]:
    late = Delay(seconds=_BY * subject.process.sampling_period, scans=_LATE)
    return {2: lambda hands: hands.command(late)}


def _judge(episode: Episode) -> Verdict:
    off = int(episode.told("scan_time_off").sum())
    lost = bool(episode.told("scan_lost").any())
    ends_well = bool(episode.heard.all()) and not episode.all_safe.any()
    words = f"{_LATE} scans half a period late: status 2048 in {off} of them"
    return Verdict(off > 0 and ends_well and not lost, f"{words}, and the loop went on")


CASES.add("late-scans", Case(5, "late scans", False, _acts, lambda _: _SAMPLES, _judge))
