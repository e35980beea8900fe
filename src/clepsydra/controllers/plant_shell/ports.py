"""Ports of the shell's blocks, and what stands for them in a law of a process."""

from __future__ import annotations

import math
from dataclasses import replace

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of


def count(name: str, high: float, description: str, *, low: float = 0.0) -> Signal:
    """Return a port that is a whole number.

    Examples
    --------
    >>> count("mode", 2.0, "0 manual, 1 automatic, 2 tracking").high
    2.0
    """
    return Signal(name, low=low, high=high, kind="integer", description=description)


def of_process(entry: Signal | DelayRing, signal: Signal) -> Signal:
    """Return the state of a block that belongs to a process signal, as a state of the law.

    Examples
    --------
    >>> of_process(Signal("good_measurement"), Signal("level_2", "m", initial=1.0))
    Signal(name='level_2.good_measurement', unit='m', display_unit='', low=-inf, high=inf, \
initial=1.0, kind='real', description='level_2: ')
    """
    port = signal_of(entry)
    name, words = path(signal, port.name), f"{signal.name}: {port.description}"
    if port.kind != "real":
        return replace(port, name=name, description=words)
    initial = signal.initial if math.isfinite(signal.initial) else 0.0
    return replace(signal, name=name, initial=initial, description=words)


def largest_rate(name: str, signal: Signal, rate: float) -> Signal:
    """Return the parameter of a largest rate; the largest number that it may have is none.

    Examples
    --------
    >>> largest_rate("rate_limit", Signal("pump_1", "V"), 2.0).unit
    'V/s'
    """
    words = f"{signal.name}: largest rate, {signals.LARGEST_PARAMETER:g} for none"
    return replace(signals.largest_rate(path(signal, name), signal, words), initial=rate)
