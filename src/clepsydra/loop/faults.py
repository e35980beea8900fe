"""Faults of sensors and final elements as inputs of a loop's program."""

from __future__ import annotations

import math
from collections.abc import Mapping

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.reader import inline

#: Of a measurement: whether its transmitter shows something else, and what.
FORCED, READING = "forced", "reading"
#: Of an input: whether what it moves has stopped, and how far it has to be asked to go to move.
STOPPED, STICTION = "stopped", "stiction"
#: Of an input: where what it moves is stuck, and where the process has it in this sample.
HELD, APPLIED = "held", "applied"


def fault_inputs(process: Process) -> tuple[Signal, ...]:
    """Return the inputs that make a sensor or a final element fail; all sound at first.

    Of a measurement y: "y.forced" (1: it shows "y.reading", whatever the process does). Of an
    input u: "u.stopped" (1: what it moves stands at its low end, a pump without power) and
    "u.stiction" [unit of u]: what it moves stays where it is until it is asked to go further than
    this, then jumps there; a valve that is stuck has more of it than its range.

    Examples
    --------
    >>> import clepsydra as cl
    >>> [signal.name for signal in fault_inputs(cl.load("wet-well").process)][:2]
    ['level.forced', 'level.reading']
    """
    return (
        *(
            signal
            for y in process.measurements
            for signal in (
                Signal(path(y.name, FORCED), kind="boolean", low=0.0, high=1.0),
                Signal(path(y.name, READING), y.unit, y.display_unit),
            )
        ),
        *(
            signal
            for u in process.inputs
            for signal in (
                Signal(path(u.name, STOPPED), kind="boolean", low=0.0, high=1.0),
                Signal(path(u.name, STICTION), u.unit, u.display_unit, low=0.0),
            )
        ),
    )


def held_states(process: Process) -> tuple[Signal, ...]:
    """Return the states: where what each input moves stands, if nothing has stopped it."""
    return tuple(
        Signal(path(u.name, HELD), u.unit, u.display_unit, initial=u.initial)
        for u in process.inputs
    )


def applied_signals(process: Process) -> tuple[Signal, ...]:
    """Return the outputs: where the process has each input, whatever the controller asks for."""
    return tuple(
        Signal(path(u.name, APPLIED), u.unit, u.display_unit, u.low, u.high) for u in process.inputs
    )


def append_readings(
    builder: BlockBuilder, process: Process, value: Mapping[str, int]
) -> dict[str, int]:
    """Append what the transmitters show to a program; return measurement to its value."""
    shown, forced, reading = ca.SX.sym("shown"), ca.SX.sym("forced"), ca.SX.sym("reading")
    either = ca.Function(
        "reading", [ca.vertcat(shown, forced, reading)], [ca.if_else(forced, reading, shown)]
    )
    return {
        y.name: inline(
            builder,
            either,
            [value[name] for name in (y.name, path(y.name, FORCED), path(y.name, READING))],
        )[0]
        for y in process.measurements
    }


def append_final_elements(
    builder: BlockBuilder, process: Process, value: Mapping[str, int]
) -> tuple[dict[str, int], list[int]]:
    """Append where final elements stand to a program.

    Returns
    -------
    applied : dict
        Input to where the process has it.
    held : list of int
        The next values of `held_states`.
    """
    applied: dict[str, int] = {}
    held: list[int] = []
    for u in process.inputs:
        asked, before, stiction, stopped = symbols = [
            ca.SX.sym(name) for name in ("asked", HELD, STICTION, STOPPED)
        ]
        now = ca.if_else(ca.fabs(asked - before) > stiction, asked, before)
        lowest = u.low if math.isfinite(u.low) else 0.0
        moved = ca.Function(
            "moved", [ca.vertcat(*symbols)], [ca.vertcat(ca.if_else(stopped, lowest, now), now)]
        )
        names = (u.name, *(path(u.name, part) for part in (HELD, STICTION, STOPPED)))
        applied[u.name], after = inline(builder, moved, [value[name] for name in names])
        held.append(after)
    return applied, held
