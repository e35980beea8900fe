"""Requests on the wires of which some are never answered."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from clepsydra.base.words import share_text
from clepsydra.hil.case import CASES, Act, Case, Episode, Subject, Verdict
from clepsydra.rig.tag import WIRE_LOSS

#: The share that is lost, for so many samples; how long a client may need to connect anew, which
#: no plant makes faster [s]; and samples behind it.
_SHARE, _LOSES, _CONNECTS, _AFTER = 0.2, 25, 5.0, 15


def _connected(subject: Subject) -> int:
    return 2 + _LOSES + math.ceil(_CONNECTS / subject.period)


def _acts(subject: Subject) -> Mapping[int, Act]:
    return {
        2: lambda hands: hands.table.image.write(WIRE_LOSS, _SHARE),
        2 + _LOSES: lambda hands: hands.table.image.write(WIRE_LOSS, 0.0),
        _connected(subject): lambda hands: hands.press(True),
        _connected(subject) + 4: lambda hands: hands.press(False),
    }


def _judge(episode: Episode) -> Verdict:
    log, samples = episode.log, episode.log.column("sample")
    own = (samples >= episode.first) & (samples < episode.last)
    lost = int(np.sum(own & ((log.column("read") == 0.0) | (log.column("written") == 0.0))))
    recovers = bool(episode.heard[-1]) and not episode.told("failed_safe")[-1]
    exchanges = "1 exchange" if lost == 1 else f"{lost} exchanges"
    words = f"{exchanges} lost with {share_text(_SHARE)} of the requests; "
    return Verdict(lost > 0 and recovers, words + ("control is back" if recovers else "not back"))


CASES.add(
    "lost-requests",
    Case(7, "lost requests", False, _acts, lambda s: _connected(s) + _AFTER, _judge),
)
