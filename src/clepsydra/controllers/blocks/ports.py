"""Ports of blocks: signals without the unit, the range and the owner of an instance."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.program.block import Block
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, Symbols


def truth(name: str, description: str) -> Signal:
    """Return a port that is a truth value.

    Examples
    --------
    >>> truth("usable", "it may be acted on").kind
    'boolean'
    """
    return Signal(name, low=0.0, high=1.0, kind="boolean", description=description)


def port(signal: Signal) -> Signal:
    """Return a signal as a port: a real one without range and value, which an instance has.

    Examples
    --------
    >>> port(Signal("gain", low=0.0, initial=3.0))
    Signal(name='gain', unit='1', display_unit='', low=-inf, high=inf, initial=0.0, kind='real', \
description='')
    """
    if signal.kind != "real":
        return replace(signal, initial=0.0)
    return replace(signal, low=-math.inf, high=math.inf, initial=0.0)


def parts_of(
    owner: Signal | str, symbols: Symbols, ports: Iterable[Signal | DelayRing]
) -> dict[str, ca.SX]:
    """Return what a law has for some ports: that part of the owner, or its signal of that name.

    Examples
    --------
    >>> law = {"pump_1.mode": ca.SX(1), "pump_2.mode": ca.SX(0), "time_step": ca.SX(5)}
    >>> parts_of("pump_2", law, [Signal("mode"), Signal("time_step")])
    {'mode': SX(0), 'time_step': SX(5)}
    """
    names = {entry.name: path(owner, entry.name) for entry in ports}
    return {
        name: symbols[own] if own in symbols else symbols[name]
        for name, own in names.items()
        if own in symbols or name in symbols
    }


def called(block: Block, instance: str, given: Symbols) -> Equations:
    """Return the results of an instance that takes its state and inputs from a mapping by name.

    Examples
    --------
    >>> same = Block("same", (Signal("x"),), (), (Signal("y"),),
    ...              lambda s: Equations({}, {"y": s["x"]}))
    >>> called(same, "first", {"x": ca.SX(3), "z": ca.SX(4)}).outputs
    {'y': SX(3)}
    """
    inputs = {signal.name: given[signal.name] for signal in block.inputs}
    return block(instance, inputs, {entry.name: given[entry.name] for entry in block.state})


def as_parts(owner: Signal | str, values: Symbols) -> dict[str, ca.SX]:
    """Return values of ports by the names that they have as parts of their owner.

    Examples
    --------
    >>> as_parts("pump_1", {"mode": ca.SX(1)})
    {'pump_1.mode': SX(1)}
    """
    return {path(owner, name): value for name, value in values.items()}


def instance(name: str) -> str:
    """Return what the block of a part of a control scheme is called: a path.

    Examples
    --------
    >>> instance("split, valve_1")
    'split.valve_1'
    """
    return re.sub(r"\W+", ".", name)


def with_used_inputs(block: Block) -> Block:
    """Return a block without the inputs that nothing in it reads.

    Examples
    --------
    >>> same = Block("same", (Signal("x"), Signal("other")), (), (Signal("y"),),
    ...              lambda s: Equations({}, {"y": s["x"]}))
    >>> [signal.name for signal in with_used_inputs(same).inputs]
    ['x']
    """
    entries = [*block.state, *block.inputs]
    symbols = {entry.name: ca.SX.sym(entry.name) for entry in entries}
    found = block.equations(symbols)
    results = ca.vertcat(*found.next_state.values(), *found.outputs.values())
    used = {symbol.name() for symbol in ca.symvar(results)}
    unused = {signal.name: ca.SX(0) for signal in block.inputs if signal.name not in used}
    return replace(
        block,
        inputs=tuple(signal for signal in block.inputs if signal.name in used),
        equations=lambda s: block.equations({**unused, **s}),
    )
