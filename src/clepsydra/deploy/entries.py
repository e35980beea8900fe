"""What a printer asks of a state: its signal, and whether it needs an array."""

from __future__ import annotations

from typing import TypeGuard

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing

Entry = Signal | DelayRing


def signal_of(entry: Entry) -> Signal:
    """Return the signal of a state, delayed or not."""
    return entry.signal if isinstance(entry, DelayRing) else entry


def is_ring(entry: Entry) -> TypeGuard[DelayRing]:
    """Whether a state needs an array: a delay by one sample is an ordinary state."""
    return isinstance(entry, DelayRing) and entry.length > 1
