"""The law as a block that the shell calls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import path
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.controllers.plant_shell.scan import Scan
from clepsydra.controllers.plant_shell.status import bit_of
from clepsydra.controllers.signals import owners
from clepsydra.program.block import Block
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols

#: Bits that the shell takes from a law, and those that it needs where it knows no limits.
_FROM_LAW = ("sensor_fault", "invalid_input", "invalid_time_step", "at_rate_limit")
_OF_LIMITS = ("at_low_limit", "at_high_limit")


class LawBlock:
    """A law whose parameters are inputs, and which tells its status bits one by one.

    They are what the law names told_sensor_fault and the like of an output, on the way to its
    status word, or else the bits of the word.

    Parameters
    ----------
    law : StepLaw
    initial : mapping
        State name to initial value.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> block = LawBlock(multiloop_pid_law(["level"], ["pump"]), {}).block
    >>> [signal.name for signal in block.outputs if signal.kind == "real"]
    ['pump.out']
    """

    def __init__(self, law: StepLaw, initial: Mapping[str, float]) -> None:
        known = {signal.name for signal in (*law.parameters, *law.intermediates)}
        #: A law that only joins blocks needs none around them.
        self._is_diagram = bool(law.blocks)
        self._bits = {owner: _bits(owner, known) for owner in owners(law.outputs, "out")}
        told = {(u, bit): _told(u, bit) for u, bits in self._bits.items() for bit in bits}
        words = {path(owner, "status") for owner in self._bits}

        unread = {_told(owner, bit) for owner in self._bits for bit in STATUS_BITS}

        def equations(symbols: Symbols) -> Equations:
            assert law.equations is not None
            found = law.equations(symbols)
            results, between = dict(found.outputs), dict(found.intermediates)
            for (owner, bit), name in told.items():
                read = between.pop(name, None)
                word = path(owner, "status")
                results[name] = bit_of(results[word], bit) if read is None else read
            shown = {name: results[name] for name in results if name not in words}
            named = {n: value for n, value in between.items() if n not in unread}
            return Equations(found.next_state, shown, named)

        self.block = Block(
            law.name,
            (*law.inputs, *law.parameters),
            tuple(
                entry
                if isinstance(entry, DelayRing)
                else replace(entry, initial=initial.get(entry.name, entry.initial))
                for entry in law.state
            ),
            (
                *(signal for signal in law.outputs if signal.name not in words),
                *(truth(name, STATUS_BITS[bit].meaning) for (_, bit), name in told.items()),
            ),
            equations,
            law.description,
        )

    def computed(self, scan: Scan, given: Symbols) -> Equations:
        """Return what the law makes of the signals of a scan; a cold start begins it anew."""
        state = {entry.name: scan.used(entry.name) for entry in self.block.state}
        inputs = {signal.name: given[signal.name] for signal in self.block.inputs}
        found = (
            self.block.equations({**inputs, **state})
            if self._is_diagram
            else self.block("law", inputs, state)
        )
        scan.next_state |= found.next_state
        return found

    def bits(self, outputs: Symbols, owner: str) -> dict[str, ca.SX]:
        """Return the status bits of an output that only the law knows, from its outputs."""
        told = {bit: outputs[_told(owner, bit)] for bit in self._bits[owner]}
        return {"at_rate_limit": ca.SX(0), **told}


def _told(owner: str, bit: str) -> str:
    return path(owner, f"told_{bit}")


def _bits(owner: str, known: set[str]) -> list[str]:
    """Return the bits of an output that are to be told."""
    limited = {path(owner, f"{end}_limit") for end in ("low", "high")} <= known
    # A law that names its bits and has no rate limit is never at one.
    free = _told(owner, "at_rate_limit") in known and path(owner, "rate_limit") not in known
    bits = _FROM_LAW if limited else (*_FROM_LAW, *_OF_LIMITS)
    return [bit for bit in bits if not (free and bit == "at_rate_limit")]
