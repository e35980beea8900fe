"""The tags of a process: all that travels on the wires of its rig."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.signal import Signal, identifier, path
from clepsydra.base.tags import tagging
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.controllers.plant_shell.status import INTERLOCKED_BITS
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.alarms import alarm_signals
from clepsydra.loop.faults import APPLIED
from clepsydra.rig.tag import (
    ACKNOWLEDGE,
    COMMAND,
    COMMAND_STATUS,
    HEARTBEAT,
    PLANT_WATCHDOG,
    REMOTE,
    Tag,
    Writer,
)

#: The largest number of 16 bits.
_WORD = 65535.0


def tags_of(point: OperatingPoint) -> tuple[Tag, ...]:
    """Return the tags of a process, those of the plant first, each with its value at a point.

    Parameters
    ----------
    point : OperatingPoint
        Where the rig rests at first; of the process without the hands of a laboratory.

    Examples
    --------
    >>> import clepsydra as cl
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> [tag.name for tag in tags if tag.writer is Writer.CONTROLLER][:3]
    ['pump_1.out', 'pump_2.out', 'pump_1.status']
    """
    process, at = point.process, point.as_dict()
    named = tagging(process.tags, [signal.name for signal in process.state])
    plant, controller, operator = Writer
    measurements, inputs = process.measurements, process.inputs
    controlled = [process.signal(name) for name in process.controlled]
    counter = Signal("counter", kind="integer", low=0.0, high=_WORD)
    every_bit = float(sum(bit.value for bit in INTERLOCKED_BITS.values()))
    switch = Signal("switch", kind="boolean", low=0.0, high=1.0)
    modes = replace(counter, high=2.0)

    def tag(
        writer: Writer, signal: Signal, part: str, cell: str, *,
        of: Signal | None = None, words: str = "", initial: float = 0.0, judged: bool = False,
    ) -> Tag:  # fmt: skip
        owner = of or signal
        name = path(owner, part) if part else owner.name
        told = replace(
            signal, initial=at.get(owner.name, initial) if of is None else initial,
            description=words or signal.description or owner.name,
        )  # fmt: skip
        judge = path(owner, "good") if judged else ""
        label = identifier(named(name))
        return Tag(name, label, at_port(told), writer, cell, signal.unit, judge)

    return (
        *(tag(plant, y, "pv", y.name, judged=True) for y in measurements),
        *(
            tag(plant, u, "position", path(u, APPLIED), words=f"where {u.name} stands")
            for u in inputs
        ),
        *(
            tag(plant, switch, "good", path(y, "sensor"), of=y, initial=1.0,
                words=f"whether {y.name} can be believed")
            for y in measurements
        ),
        *(tag(plant, each, "", each.name) for each in alarm_signals(process)
          if each.kind == "boolean"),
        tag(plant, replace(counter, name=PLANT_WATCHDOG), "", PLANT_WATCHDOG,
            words="counts the samples of the plant"),
        *(tag(controller, u, "out", path(u, COMMAND)) for u in inputs),
        *(
            tag(controller, replace(counter, high=every_bit), "status", path(u, COMMAND_STATUS),
                of=u, words=f"status word of {u.name}")
            for u in inputs
        ),
        tag(controller, replace(counter, name=HEARTBEAT), "", HEARTBEAT,
            words="counts the scans of the controller"),
        *(
            tag(operator, y, "sp", path(y, "setpoint"), words=f"setpoint of {y.name}")
            for y in controlled
        ),
        *(
            tag(operator, modes, "mode", path(u, "mode"), of=u, initial=1.0,
                words=f"of {u.name}: 0 manual, 1 automatic, 2 tracking")
            for u in inputs
        ),
        *(
            tag(operator, u, "manual", path(u, "manual"), words=f"manual value of {u.name}")
            for u in inputs
        ),
        tag(operator, replace(switch, name=ACKNOWLEDGE), "", ACKNOWLEDGE,
            words="acknowledges what is latched"),
        tag(operator, replace(switch, name=REMOTE), "", REMOTE, initial=1.0,
            words="whether the wires move the plant"),
    )  # fmt: skip
