"""What a printer asks of a state: its signal, and whether it needs an array."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeGuard

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing

Entry = Signal | DelayRing


def signal_of(entry: Entry) -> Signal:
    """Return the signal of a state, delayed or not.

    Examples
    --------
    >>> signal_of(DelayRing(Signal("flow"), 3)).name, signal_of(Signal("level")).name
    ('flow', 'level')
    """
    return entry.signal if isinstance(entry, DelayRing) else entry


def is_ring(entry: Entry) -> TypeGuard[DelayRing]:
    """Whether a state needs an array: a delay by one sample is an ordinary state.

    Examples
    --------
    >>> [is_ring(DelayRing(Signal("flow"), length)) for length in (1, 3)]
    [False, True]
    """
    return isinstance(entry, DelayRing) and entry.length > 1


def with_signal(entry: Entry, change: Callable[[Signal], Signal]) -> Entry:
    """Return a state with its signal changed, delayed or not.

    Examples
    --------
    >>> with_signal(DelayRing(Signal("flow"), 3), lambda each: replace(each, unit="V")).signal.unit
    'V'
    """
    if isinstance(entry, DelayRing):
        return replace(entry, signal=change(entry.signal))
    return change(entry)
