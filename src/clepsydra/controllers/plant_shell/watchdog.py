"""A counter that shows that the law still runs."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.signal import Signal

#: The largest signed whole number of 16 bits; 0 comes next.
LARGEST_COUNT = 32767


def watchdog_signals() -> tuple[Signal, Signal]:
    """Return the state scans_counted and the output watchdog.

    Examples
    --------
    >>> [signal.name for signal in watchdog_signals()]
    ['scans_counted', 'watchdog']
    """
    high = float(LARGEST_COUNT)
    return (
        Signal(
            "scans_counted", low=0.0, high=high, kind="integer",
            description="value of the watchdog in the last scan",
        ),
        Signal(
            "watchdog", low=0.0, high=high, kind="integer",
            description=f"counts the scans from 0 to {LARGEST_COUNT} and over again",
        ),
    )  # fmt: skip


def next_count(count: ca.SX) -> ca.SX:
    """Return the number after a count; the one after the largest is 0.

    Examples
    --------
    >>> [int(next_count(ca.DM(count))) for count in (0, 32766, 32767)]
    [1, 32767, 0]
    """
    return ca.if_else(count < LARGEST_COUNT, ca.fmin(LARGEST_COUNT - 1, ca.fmax(0, count)) + 1, 0)
