"""Profiles of inputs and disturbances, written as words: values, steps and ramps."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clepsydra.base.arguments import require_signal
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import to_si, with_percent_hint
from clepsydra.base.words import TIME_UNITS, time_text
from clepsydra.process.process import Process
from clepsydra.process.signal_values import beyond_range

_EXAMPLE = "write as in pump_1=3.2V, pump_1=3.5V@60s, pump_1=4V@60s..120s or pump_1=4V@60s+5s"
#: A time, and behind ".." or "+" another one; "1e+3 s" is one.
_WHEN = re.compile(r"(.*?)(?:\.\.(.+)|(?<![\d.][eE])\+(.+))?", re.DOTALL)
_PRETTY = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
#: Shares of a sampling period by which a time may miss a sample and still count as on it.
_ON_SAMPLE = 1e-9


@dataclass(frozen=True)
class Change:
    """That an input or a disturbance takes a new value, at once, along a ramp, or for a time.

    Parameters
    ----------
    signal : str
    value : float
        [SI]
    start, stop : float
        [s]; equal for a step.
    place : str
        Where it was written, for messages.
    back : float or None
        When a pulse goes back to the value before it [s]; None where the new value stays.
    """

    signal: str
    value: float
    start: float
    stop: float
    place: str = ""
    back: float | None = None

    @property
    def is_ramp(self) -> bool:
        """It takes time."""
        return self.stop > self.start

    @property
    def end(self) -> float:
        """When the signal stays where it is [s]."""
        return self.stop if self.back is None else self.back


class When(NamedTuple):
    """When a change begins and how long it takes, or lasts, in words; empty where it does not."""

    begin: str
    until: str = ""
    lasts: str = ""


def read_when(words: str, place: str) -> When:
    """Read the time of a change: "60s", of a ramp "60s..120s", of a pulse "60s+5s".

    Raises
    ------
    InputError
        It is a ramp and a pulse, or has more times than these.

    Examples
    --------
    >>> read_when("60s+5s", "--input")
    When(begin='60s', until='', lasts='5s')
    """
    begin, until, lasts = _parts(words)
    if any(_parts(until or lasts)[1:]):
        raise InputError(
            place, words[:60], "one time, or two with '..' or '+' between them", _EXAMPLE
        )
    return When(begin, until, lasts)


def _parts(words: str) -> tuple[str, str, str]:
    match = _WHEN.fullmatch(words)
    assert match is not None  # it takes any text
    begin, until, lasts = (part.strip() for part in match.groups(default=""))
    return begin, until, lasts


def read_assignment(text: str, process: Process, place: str) -> Change:
    """Read what a signal does: "pump_1=3.2V", "pump_1=3.5V@60s", "pump_1=4V@60s..120s".

    With "pump_1=4V@60s+5s" it goes back after 5 s.

    Parameters
    ----------
    text : str
        Of an input or a disturbance.
    process : Process
    place : str
        Where it stands, for messages.

    Raises
    ------
    InputError
        There is no such signal; value or time is no quantity of the right kind; the value is out
        of the signal's range, the time before the start, the ramp ends before it begins, or the
        pulse does not last.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> change = read_assignment("pump_1=4V@60s..120s", load_process("quadruple-tank"), "--input")
    >>> change.value, change.start, change.stop
    (4.0, 60.0, 120.0)
    """
    named, equals, words = text.partition("=")
    if not equals:
        raise InputError(place, text[:60], "a signal, '=' and its value", _EXAMPLE)
    signal = outside_signal(named.strip(), process, place)
    value_words, at, times = words.partition("@")
    value = to_si(value_words, signal.unit, place)
    check_range(signal, value, place, value_words)
    if not at:
        return Change(signal.name, value, 0.0, 0.0, place)
    when = read_when(times, place)
    start, stop = (to_si(part, "s", place) for part in (when.begin, when.until or when.begin))
    if start < 0.0:
        raise InputError(place, when.begin, "a time from 0 s on", "begin at 0 s or later")
    if when.until and stop <= start:
        raise InputError(
            place, times.strip(), "a ramp that ends after it begins", "exchange the two times"
        )
    back = start + read_duration(when.lasts, place) if when.lasts else None
    return Change(signal.name, value, start, stop, place, back)


def outside_signal(name: str, process: Process, place: str) -> Signal:
    """Return an input or a disturbance by its name, or refuse the name."""
    outside = (*process.inputs, *process.disturbances)
    return require_signal(place, name, outside, f"an input or a disturbance of {process.name}")


def check_range(signal: Signal, value: float, place: str, written: object = None) -> None:
    """Refuse a value [SI] outside a signal's range, which was written like that."""
    beyond = beyond_range(signal, value, "a value")
    if beyond is not None:
        remedy = with_percent_hint("stay inside the range", written, signal.unit)
        raise InputError(place, *beyond, remedy)


def profiles_of(
    changes: Iterable[Change], before: Mapping[str, float], period: float, samples: int
) -> dict[str, np.ndarray]:
    """Return what signals do on the grid of the samples.

    A value is held over a sample. A step between two samples acts from the later one on; a ramp
    is a staircase that meets it at the start of each sample.

    Parameters
    ----------
    changes : iterable of Change
        Those of one signal in order of time.
    before : mapping
        Every signal to its value until its first change [SI].
    period : float
        Sampling period [s].
    samples : int

    Returns
    -------
    dict
        Every signal of `before` to its values [samples].

    Raises
    ------
    InputError
        A change begins before the last one of its signal has ended, falls into the same sample,
        or has not ended with the last sample.

    Examples
    --------
    >>> changes = [Change("pump", 2.0, 0.0, 0.0), Change("pump", 4.0, 1.0, 3.0)]
    >>> profiles_of(changes, {"pump": 1.0}, period=1.0, samples=5)["pump"]
    array([2., 2., 3., 4., 4.])
    """
    begun: dict[str, list[tuple[int, Change]]] = {}
    for change in changes:
        earlier = begun.setdefault(change.signal, [])
        if earlier:
            _check_follows(earlier[-1][1], change, period)
        first = samples_before(change.start, period)
        if first >= samples or change.end > samples * period * (1.0 + 1e-12):
            raise InputError(
                change.place,
                time_text(change.end, 4),
                f"a change that ends within the duration of {time_text(samples * period, 4)}",
                "lengthen the duration or leave the change out",
            )
        if change.back is not None and change.back - change.start < period * (1.0 - _ON_SAMPLE):
            raise InputError(
                change.place,
                time_text(change.back - change.start, 4),
                f"a pulse of at least a sampling period of {time_text(period, 4)}",
                "let it last longer, or shorten the sampling period",
            )
        earlier.append((first, change))
    profiles = {name: np.full(samples, value) for name, value in before.items()}
    for name, found in begun.items():
        values, old = profiles[name], before[name]
        ends = [*(first for first, _ in found[1:]), samples]
        for (first, change), end in zip(found, ends, strict=True):
            if change.is_ramp:
                time = np.arange(first, end) * period
                share = np.clip((time - change.start) / (change.stop - change.start), 0.0, 1.0)
                # Written so that the ramp ends on its value exactly.
                values[first:end] = (1.0 - share) * old + share * change.value
            else:
                values[first:end] = change.value
            if change.back is None:
                old = change.value
            else:
                values[samples_before(change.back, period) : end] = old
    return profiles


def _check_follows(previous: Change, change: Change, period: float) -> None:
    """Refuse a change that would hide the one before it."""
    if change.start < previous.end:
        raise InputError(
            change.place,
            time_text(change.start, 4),
            f"a time from {time_text(previous.end, 4)} on, when the change of {change.signal} "
            "before it has ended",
            "give the changes of a signal in order of time",
        )
    if samples_before(change.start, period) <= samples_before(previous.start, period):
        raise InputError(
            change.place,
            time_text(change.start, 4),
            f"at most one value of {change.signal} in a sampling period of {time_text(period, 4)}",
            "leave one of the two out or shorten the sampling period",
        )


def pretty_duration(least: float) -> float:
    """Return a length of time [s], not below `least` [s], that is a pretty number in its unit.

    Examples
    --------
    >>> pretty_duration(544.0)  # ten minutes
    600.0
    """
    length, most = next((length, most) for _, length, most in TIME_UNITS if least <= most)
    count = least / length
    power = 10.0 ** math.floor(math.log10(count))
    pretty = next(p * power for p in _PRETTY if p * power >= count * (1.0 - _ON_SAMPLE))
    return min(length * pretty, most)  # three minutes, hours or days are pretty as well


def read_duration(text: object, place: str) -> float:
    """Read a length of time such as "20 min" [s].

    Raises
    ------
    InputError
        It is none, or not above zero.

    Examples
    --------
    >>> read_duration("20 min", "--duration")
    1200.0
    """
    duration = to_si(text, "s", place)
    if duration <= 0.0:
        raise InputError(place, text, "a time above 0 s", "write it as in '20 min'")
    return duration


def samples_before(time: float, period: float) -> int:
    """Return how many samples begin before a time [s]: the place of the first one at it or later.

    Examples
    --------
    >>> samples_before(0.3, 0.1), samples_before(0.31, 0.1)
    (3, 4)
    """
    return math.ceil(time / period - _ON_SAMPLE * max(1.0, time / period))
