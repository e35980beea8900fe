"""One scan of the shell while it is written: what it goes on from, and what it calls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.plant_shell.scan_watch import SCAN_WATCH
from clepsydra.controllers.plant_shell.start import START
from clepsydra.program.block import Block
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Symbols


class Scan:
    """The signals of a scan, how it begins, whether it comes in time, and the next state so far.

    In a cold start every state counts as its initial value. A ring cannot be overwritten in one
    scan: what is read of it counts as the initial value until it was written after the start.

    Parameters
    ----------
    symbols : mapping
        The shell's signals by name.
    state : sequence of Signal or DelayRing
        All but those of the start.
    initial : mapping
        State name to its initial value.

    Examples
    --------
    A cold start, with a delay of two scans:

    >>> ring = DelayRing(Signal("delayed"), 2)
    >>> given = {"start": 2, "scans_since_start": 7, "last_start": 0, "acknowledge": 0,
    ...          "last_acknowledge": 0, "delayed": 9.0,
    ...          "integral": 9.0, "scans_counted": 7, "time_step": 1.0, "sampling_period": 1.0,
    ...          "scan_tolerance": 0.1}
    >>> scan = Scan({name: ca.DM(value) for name, value in given.items()},
    ...             [Signal("integral"), ring], {"integral": 3.0, "delayed": 4.0,
    ...             "scans_counted": 0.0})
    >>> [float(ca.evalf(scan.used(name))) for name in ("integral", "delayed")]
    [3.0, 4.0]
    """

    def __init__(
        self,
        symbols: Symbols,
        state: Sequence[Signal | DelayRing],
        initial: Mapping[str, float],
    ) -> None:
        self.symbols, self.initial = symbols, initial
        self.delays = {entry.name: entry.length for entry in state if isinstance(entry, DelayRing)}
        longest = max(self.delays.values(), default=1)
        begun = START(
            "scan_start",
            {
                "start": symbols["start"],
                "acknowledge": symbols["acknowledge"],
                "longest_delay": ca.SX(longest),
            },
            {entry.name: symbols[entry.name] for entry in START.state},
        )
        self.next_state: dict[str, ca.SX] = dict(begun.next_state)
        self._known: dict[str, ca.SX] = {**symbols, **begun.outputs}
        self._known |= self.call(SCAN_WATCH, "scan_watch")

    def __getitem__(self, name: str) -> ca.SX:
        """Return what the start or the watch tells of the scan, or a signal of the shell."""
        return self._known[name]

    def used(self, name: str) -> ca.SX:
        """Return the value of a state that the scan goes on from."""
        anew = self["cold"]
        if name in self.delays:
            anew = self["scans_before"] < self.delays[name]
        return ca.if_else(anew, self.initial[name], self.symbols[name])

    def call(
        self, block: Block, instance: str, owner: Signal | None = None, /, **inputs: ca.SX
    ) -> dict[str, ca.SX]:
        """Call a block that begins anew in a cold start, and return its outputs.

        What is not given is that part of the owner, or the signal of the port's name.

        Parameters
        ----------
        block : Block
        instance : str
        owner : Signal, optional
            The process signal that it belongs to.
        inputs
            By the names of the ports.
        """
        for port in block.inputs:
            if port.name not in inputs:
                inputs[port.name] = self[self._named(port.name, owner)]
        names = {entry.name: self._named(entry.name, owner) for entry in block.state}
        found = block(instance, inputs, {own: self.used(name) for own, name in names.items()})
        self.next_state |= {name: found.next_state[own] for own, name in names.items()}
        return dict(found.outputs)

    def _named(self, name: str, owner: Signal | None) -> str:
        own = name if owner is None else path(owner, name)
        return own if own in self.symbols else name
