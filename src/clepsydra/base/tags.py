"""Tags: names of the plant's control system in the place of those of the process file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from clepsydra.base.signal import Signal


def tagging(tags: Mapping[str, str], known: Iterable[str]) -> Callable[[str], str]:
    """Return the function from a path to the same path with tags.

    A tag takes the place of a signal that a path belongs to, and of the second signal of an
    effect; a part that only reads like a signal stays.

    Parameters
    ----------
    tags : mapping
        Signal to its tag.
    known : iterable of str
        All signals of the process, so that "level" is not seen in "tank.level".

    Examples
    --------
    >>> tagged = tagging({"level": "LIC101", "pump": "P101"}, ["tank.level"])
    >>> tagged("level.pv"), tagged("pump.feedback.level")
    ('LIC101.pv', 'P101.feedback.LIC101')
    >>> tagged("tank.level"), tagged("pump.feedback.tank.level"), tagged("cascade.level")
    ('tank.level', 'P101.feedback.tank.level', 'cascade.level')
    """
    owned = tuple(f"{signal}." for signal in tags)
    whole = {*tags, *(signal for signal in known if not signal.startswith(owned))}
    longest_first = sorted(whole, key=len, reverse=True)
    signal = re.compile(rf"(?<![^.])(?:{'|'.join(map(re.escape, longest_first))})(?![^.])")

    def tagged(name: str) -> str:
        def tag(found: re.Match[str]) -> str:
            is_part = found.end() == len(name) and name.count(".", 0, found.start()) == 1
            return found[0] if is_part else tags.get(found[0], found[0])

        return signal.sub(tag, name)

    return tagged


def explained(signal: Signal, name: str, tag: str) -> Signal:
    """Return a signal whose description names both the process file's signal and its tag.

    Examples
    --------
    >>> explained(Signal("LIC101.pv", description="measured level"), "level", "LIC101").description
    'measured level (LIC101)'
    """
    words = signal.description
    if name not in words:
        words = f"{words}, {name}" if words else name
    return replace(signal, description=f"{words} ({tag})")
