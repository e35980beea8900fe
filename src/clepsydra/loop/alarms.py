"""Alarms in a closed loop: appended to its program, and what they hold of its inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.alarms.interlock import OUTPUT_INTERLOCK
from clepsydra.controllers.alarms.law import COMMAND, INTERLOCK, NAME, alarm_controller
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER
from clepsydra.controllers.controller import Controller
from clepsydra.process.alarm import interlocks
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.entries import signal_of
from clepsydra.program.reader import inline

#: What an input was moved to before a run: no number, which no alarm looks at.
UNKNOWN = 2.0 * LARGEST_NUMBER


class LoopAlarms:
    """The alarms of a process in a loop, which looks at them before its controller.

    Parameters
    ----------
    process : Process
        With alarms.
    operated : bool
        Whether an operator acknowledges each of them, see `alarm_controller`.

    Attributes
    ----------
    controller : Controller
        Of them, which moves nothing.
    state : tuple of Signal
        "alarms." and the name of a state of their law; "alarms.pump_1.command", what a watched
        input was moved to in the last sample.
    signals : tuple of Signal
        What they tell: "level_1.high.active", "pump_1.interlock".
    commands : dict
        Input of their law to the input of the process that it watches.
    inputs : tuple of Signal
        By which each is acknowledged, where they are operated: "level_1.high.acknowledge".

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.process.alarm import Alarm, AlarmKind
    >>> process = cl.load("quadruple-tank").process
    >>> high = Alarm("level_1", AlarmKind.HIGH, 8.0, interlock={"pump_1": 0.0})
    >>> [signal.name for signal in LoopAlarms(replace(process, alarms=(high,))).signals]
    ['level_1.high.active', 'level_1.watched', 'pump_1.interlock']
    """

    def __init__(self, process: Process, *, operated: bool = False) -> None:
        self.process = process
        self.controller: Controller = alarm_controller(process, operated=operated)
        law = self.controller.law
        free = [each for each in law.inputs if each.name in self.controller.free_inputs]
        self.commands = {each.name: each.owner for each in free if each.part == COMMAND}
        self.inputs = tuple(each for each in free if operated and each.name not in self.commands)
        own = map(signal_of, law.state)
        held = (
            replace(process.signal(u), name=n, initial=UNKNOWN) for n, u in self.commands.items()
        )
        self.state = tuple(replace(each, name=path(NAME, each.name)) for each in (*own, *held))
        self.signals = law.outputs

    def append(self, builder: BlockBuilder, value: dict[str, int]) -> list[int]:
        """Append them to a program; name what they tell, and return their next state.

        Parameters
        ----------
        value : dict
            Values of the loop by name, to which theirs are added. Mode, tracking and manual value
            of an input that an alarm holds are changed.
        """
        controller, law = self.controller, self.controller.law
        given = {name: value[wire] for name, wire in controller.input_wires.items()
                 if name not in controller.free_inputs}  # fmt: skip
        given |= {name: value[path(NAME, name)] for name in self.commands}
        given |= {each.name: value[each.name] for each in self.inputs}
        given["time_step"] = builder.constant(self.process.sampling_period)
        arguments = [
            *(value[path(NAME, entry.name)] for entry in law.state),
            *(given.get(s.name, builder.constant(s.initial)) for s in law.inputs),
            *(builder.constant(controller.values[p.name]) for p in law.parameters),
        ]
        results = inline(builder, law.function, arguments)
        outputs = zip(law.outputs, results[len(law.state) :], strict=False)
        value |= {signal.name: number for signal, number in outputs}
        for name, safe in interlocks(self.process.alarms).items():
            value |= _held(builder, value, name, safe)
        return results[: len(law.state)]

    def moved(self, value: Mapping[str, int]) -> list[int]:
        """Return the values of the inputs that they watch, once these have been moved."""
        return [value[u] for u in self.commands.values()]


def without_controller(process: Process) -> dict[str, float]:
    """Return what alarms look at where nothing controls: sound sensors, and no setpoint.

    Examples
    --------
    >>> import clepsydra as cl
    >>> without_controller(cl.load("wet-well").process)["level.sensor"]
    1.0
    """
    sensors = {path(y.name, "sensor"): 1.0 for y in process.measurements}
    return sensors | {path(name, "setpoint"): UNKNOWN for name in process.controlled}


def append_by_hand(
    alarms: LoopAlarms, builder: BlockBuilder, value: dict[str, int], told: Mapping[str, int]
) -> list[int]:
    """Append alarms to a program whose inputs are as they are given, where no alarm holds them.

    Parameters
    ----------
    value : dict
        Values by name, to which those of the alarms are added, and the inputs as they are moved.
    told : mapping
        Measurement to what its sensor tells.

    Returns
    -------
    list of int
        The next state of the alarms.
    """
    process = alarms.process
    value |= told
    value |= {name: builder.constant(x) for name, x in without_controller(process).items()}
    for u in process.inputs:
        value[path(u.name, "mode")] = builder.constant(float(Mode.MANUAL))
        value |= {path(u.name, part): value[u.name] for part in ("manual", "tracking")}
    following = alarms.append(builder, value)
    value |= {u.name: value[path(u.name, "manual")] for u in process.inputs}
    return [*following, *alarms.moved(value)]


def acknowledging_inputs(process: Process) -> tuple[Signal, ...]:
    """Return the inputs by which an operator acknowledges the alarms of a process, if it has any.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.process.alarm import Alarm, AlarmKind
    >>> process = cl.load("quadruple-tank").process
    >>> high = Alarm("level_1", AlarmKind.HIGH, 8.0)
    >>> [each.name for each in acknowledging_inputs(replace(process, alarms=(high,)))]
    ['level_1.high.acknowledge']
    """
    return LoopAlarms(process, operated=True).inputs if process.alarms else ()


def alarm_signals(process: Process) -> tuple[Signal, ...]:
    """Return what the alarms of a process tell; nothing where it has none."""
    return LoopAlarms(process).signals if process.alarms else ()


def _held(
    builder: BlockBuilder, value: Mapping[str, int], name: str, safe: float
) -> dict[str, int]:
    """Return mode, tracking and manual value of an input, which an alarm may hold."""
    acts, held = value[path(name, INTERLOCK)], builder.constant(safe)
    ports = [acts, held, value[path(name, "mode")], value[path(name, "tracking")]]
    mode, tracking = inline(builder, _interlock(), ports)
    manual = builder.operation("select", acts, held, value[path(name, "manual")])
    return {
        path(name, "mode"): mode,
        path(name, "tracking"): tracking,
        path(name, "manual"): manual,
    }


def _interlock() -> ca.Function:
    names = [port.name for port in OUTPUT_INTERLOCK.inputs]
    symbols = {name: ca.SX.sym(name) for name in names}
    found = OUTPUT_INTERLOCK.equations(symbols)
    return ca.Function("interlock", [*symbols.values()], [ca.vertcat(*found.outputs.values())])
