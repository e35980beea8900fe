"""The law as a block that the shell calls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca

from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.controllers.plant_shell.scan import Scan
from clepsydra.controllers.plant_shell.status import bit_of
from clepsydra.program.block import Block
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols

#: Bits that the shell takes from a law, and those that it needs where it knows no limits.
_FROM_LAW = ("sensor_fault", "invalid_input", "invalid_time_step", "at_rate_limit")
_OF_LIMITS = ("at_low_limit", "at_high_limit")


class LawBlock:
    """A law whose parameters are inputs, and which tells its status bits one by one.

    They are what the law names told_sensor_fault_1 and the like on the way to its status word, or
    else the bits of the word.

    Parameters
    ----------
    law : StepLaw
    outputs : int
        Number of its outputs.
    initial : mapping
        State name to initial value.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> block = LawBlock(multiloop_pid_law(1), 1, {}).block
    >>> [signal.name for signal in block.outputs if signal.kind == "real"]
    ['manipulated_1']
    """

    def __init__(self, law: StepLaw, outputs: int, initial: Mapping[str, float]) -> None:
        known = {signal.name for signal in (*law.parameters, *law.intermediates)}
        #: A law that only joins blocks needs none around them.
        self._is_diagram = bool(law.blocks)
        self._bits = {i: _bits(i, known) for i in range(1, outputs + 1)}
        told = {(i, bit): f"told_{bit}_{i}" for i, bits in self._bits.items() for bit in bits}
        words = {f"status_{i}" for i in self._bits}

        def equations(symbols: Symbols) -> Equations:
            assert law.equations is not None
            found = law.equations(symbols)
            results, between = dict(found.outputs), dict(found.intermediates)
            for (i, bit), name in told.items():
                read = between.get(name)
                results[name] = bit_of(results[f"status_{i}"], bit) if read is None else read
            shown = {name: results[name] for name in results if name not in words}
            named = {name: between[name] for name in between if not name.startswith("told_")}
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

    def bits(self, outputs: Symbols, i: int) -> dict[str, ca.SX]:
        """Return the status bits of output i that only the law knows, from its outputs."""
        told = {bit: outputs[f"told_{bit}_{i}"] for bit in self._bits[i]}
        return {"at_rate_limit": ca.SX(0), **told}


def _bits(i: int, known: set[str]) -> list[str]:
    """Return the bits of output i that are to be told."""
    limited = {f"low_limit_{i}", f"high_limit_{i}"} <= known
    # A law that names its bits and has no rate limit is never at one.
    free = f"told_at_rate_limit_{i}" in known and f"rate_limit_{i}" not in known
    bits = _FROM_LAW if limited else (*_FROM_LAW, *_OF_LIMITS)
    return [bit for bit in bits if not (free and bit == "at_rate_limit")]
