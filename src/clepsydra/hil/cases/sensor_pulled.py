"""A sensor is pulled: ridden through, then fail-safe until it is sound and acknowledged."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.hil.case import CASES, Act, Case, Episode, Subject, Verdict

#: Samples behind the delay for which it stays pulled, is sound and not acknowledged, and after.
_PULLED, _SOUND, _AFTER = 6, 6, 40


def _acts(subject: Subject) -> Mapping[int, Act]:
    name = subject.level.name
    sound = 2 + subject.ridden + _PULLED

    return {
        2: lambda hands: hands.instructor.fail(name, "dead"),
        sound: lambda hands: hands.instructor.fail(name, "none"),
        sound + _SOUND: lambda hands: hands.press(True),
        sound + _SOUND + 4: lambda hands: hands.press(False),
    }


def _judge(episode: Episode) -> Verdict:
    ridden = int(episode.told("rides_through").sum())
    failed = episode.told("failed_safe")
    safe = bool(episode.some_safe.any())
    waited = int(failed.sum())
    holds = safe and waited >= _SOUND and not failed[-1] and not episode.told("sensor_fault")[-1]
    delay = episode.subject.sensor_delay
    back = "back after it was acknowledged" if not failed[-1] else "not back"
    return Verdict(
        holds, f"held for {ridden} scans ({delay:g} s), then fail-safe for {waited}; {back}"
    )


def _samples(subject: Subject) -> int:
    return 2 + subject.ridden + _PULLED + _SOUND + _AFTER


CASES.add("sensor-pulled", Case(4, "sensor pulled", True, _acts, _samples, _judge))
