"""Scans that do not come at all, fewer than the longest gap."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.hil.case import CASES, Act, Case, Episode, Subject, Verdict
from clepsydra.hil.commands import Skip

#: How many; samples in all.
_MISSED, _SAMPLES = 2, 30


def _acts(subject: Subject) -> Mapping[int, Act]:
    return {2: lambda hands: hands.command(Skip(scans=_MISSED))}


def _judge(episode: Episode) -> Verdict:
    sample = episode.log.column("sample")
    own = sample[(sample >= episode.first) & (sample < episode.last)]
    missing = episode.last - episode.first - len(set(own.tolist()))
    lost = bool(episode.told("scan_lost").any())
    holds = missing >= _MISSED and not lost and not episode.all_safe.any()
    words = f"{missing} samples without a scan: outputs held, the time step counted"
    return Verdict(holds, f"{words}, and the loop went on")


CASES.add("missed-scans", Case(6, "missed scans", False, _acts, lambda _: _SAMPLES, _judge))
