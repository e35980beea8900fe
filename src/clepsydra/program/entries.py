"""What a printer asks of a state: its signal, and whether it needs an array."""

from __future__ import annotations

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
