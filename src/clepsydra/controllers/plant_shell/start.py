"""Cold and warm start: which state a scan goes on from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Symbols

_COUNT, _LAST = "scans_since_start", "last_start"


@dataclass(frozen=True)
class Start:
    """How a scan begins.

    Parameters
    ----------
    cold, warm : casadi.SX
        Whether this scan is a cold or a warm start.
    first : casadi.SX
        Whether nothing was remembered before this scan.
    state : dict
        State name to the value that the scan goes on from.
    next_state : dict
        The scans since the start, for the rings, and what was asked for in this scan.

    Examples
    --------
    >>> start = Start(ca.SX(0), ca.SX(1), ca.SX(0), {}, {})
    >>> bool(ca.evalf(start.anew))
    True
    """

    cold: ca.SX
    warm: ca.SX
    first: ca.SX
    state: dict[str, ca.SX]
    next_state: dict[str, ca.SX]

    @property
    def anew(self) -> ca.SX:
        """Whether this scan is a start of either kind."""
        return ca.logic_or(self.cold, self.warm)


def start_input() -> Signal:
    """Return the input that tells how a scan begins.

    Examples
    --------
    >>> start_input().kind
    'integer'
    """
    return Signal(
        "start",
        low=0.0,
        high=2.0,
        kind="integer",
        description="0 runs on; where it changes to 1 a warm start with the state as it was kept, "
        "to 2 a cold start; held it acts once",
    )


def start_states() -> tuple[Signal, Signal]:
    """Return what a cold start does not reset: the scans since it, and the last input.

    Examples
    --------
    >>> [state.name for state in start_states()]
    ['scans_since_start', 'last_start']
    """
    return (
        Signal(
            _COUNT, low=0.0, high=1e9, kind="integer",
            description="scans since the cold start, counted until every delay is overwritten",
        ),
        Signal(
            _LAST, low=0.0, high=2.0, kind="integer",
            description="start in the last scan, so that held it acts once",
        ),
    )  # fmt: skip


def started(
    symbols: Symbols, state: Iterable[Signal | DelayRing], initial: Mapping[str, float]
) -> Start:
    """Return the state that a scan goes on from.

    A start is asked for as by a button: where the input changes to 1 or 2. Held for ever it acts
    once, so that sensors are judged and outputs move behind it; for that the last input outlives
    a cold start.

    In a cold start every state counts as its initial value. A ring cannot be overwritten in one
    scan: what is read of it counts as the initial value until it was written after the start.

    Parameters
    ----------
    symbols : mapping
        The shell's signals by name: start, scans_since_start, last_start and every state.
    state : iterable of Signal or DelayRing
        All but `start_states`.
    initial : mapping
        State name to its initial value.

    Examples
    --------
    A cold start, with a delay of two scans:

    >>> ring = DelayRing(Signal("delayed"), 2)
    >>> given = {"start": 2, "scans_since_start": 7, "last_start": 0, "delayed": 9.0,
    ...          "integral": 9.0}
    >>> found = started({name: ca.DM(value) for name, value in given.items()},
    ...                 [Signal("integral"), ring], {"integral": 3.0, "delayed": 4.0})
    >>> [float(ca.evalf(found.state[name])) for name in ("integral", "delayed")]
    [3.0, 4.0]
    """
    asked, last = symbols["start"], symbols[_LAST]
    cold = ca.logic_and(asked == 2, last != 2)
    warm = ca.logic_and(asked == 1, last != 1)
    scans = ca.if_else(cold, 0, symbols[_COUNT])
    found: dict[str, ca.SX] = {}
    longest = 1
    for entry in state:
        anew = cold
        if isinstance(entry, DelayRing):
            anew, longest = scans < entry.length, max(longest, entry.length)
        found[entry.name] = _begun(anew, initial[entry.name], symbols[entry.name], entry)
    following = ca.fmin(longest, ca.fmax(0, scans) + 1)
    # As numbers of their own: what stands for no start is none.
    remembered = ca.if_else(asked == 2, 2, ca.if_else(asked == 1, 1, 0))
    return Start(cold, warm, scans < 1, found, {_COUNT: following, _LAST: remembered})


def _begun(anew: ca.SX, first: float, kept: ca.SX, entry: Signal | DelayRing) -> ca.SX:
    """Return the initial value of a state in a start, else the kept one."""
    if isinstance(entry, DelayRing) or entry.kind != "boolean":
        return ca.if_else(anew, first, kept)
    return ca.logic_or(anew, kept) if first else ca.logic_and(kept, ca.logic_not(anew))
