"""What the state of a process is called in an FMU: as the user knows it, where that is free."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.deploy.process_program import HELD
from clepsydra.process.process import Process


def shown_contents(process: Process) -> frozenset[str]:
    """Return the names of those contents that are states as they are, such as levels.

    A concentration is no content: the amount is, and the state is computed from it.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> sorted(shown_contents(load_process("averaging-tank")))
    ['tank.level']
    """
    motion = process.motion
    contents = ca.SX.sym("c", len(motion.contents))
    states = motion.to_state(contents, ca.SX.sym("p", len(process.parameters)))
    places = {signal.name: place for place, signal in enumerate(motion.contents)}
    return frozenset(
        signal.name
        for number, signal in enumerate(process.state)
        if signal.name in places and ca.is_equal(states[number], contents[places[signal.name]])
    )


def held_signals(process: Process, signals: Sequence[Signal]) -> list[Signal]:
    """Return the signals of what a process holds, under names that nothing else has.

    Each keeps its name; where another variable has it, "held." stands before it.

    Parameters
    ----------
    process : Process
    signals : sequence of Signal
        Contents, memories and whatever else lives from step to step.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("averaging-tank")
    >>> [signal.name for signal in held_signals(process, process.motion.contents)]
    ['tank.level', 'tank.impurity_amount']
    """
    shown = shown_contents(process)
    taken = _names(
        process.parameters,
        process.inputs,
        process.disturbances,
        process.measurements,
        [signal for signal in process.state if signal.name not in shown],
    )
    # Counts of events grow without bound, so they are numbers and no integers of the target.
    return [
        replace(s, name=f"{HELD}.{s.name}" if s.name in taken else s.name, kind="real")
        for s in signals
    ]


def _names(*groups: Iterable[Signal]) -> set[str]:
    return {signal.name for group in groups for signal in group}
