"""What a plant shell adds to a controller: parameters with their sources, and remarks."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.alarms.interlock import INTERLOCK, INTERLOCK_VALUE
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.controllers.plant_shell.parameter_check import Judged, judged
from clepsydra.controllers.plant_shell.scan import LONGEST_GAP, SAMPLING_PERIOD, SCAN_TOLERANCE
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.signal_check import RANGE, SENSOR_DELAY, SETPOINT_RATE
from clepsydra.controllers.plant_shell.status import FAIL_SAFE, RATE_LIMIT, TAKE_UP_SCANS
from clepsydra.controllers.plant_shell.take_up import take_up_scans
from clepsydra.controllers.signals import owners
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.wiring import wired_setpoints
from clepsydra.program.operation import LOGIC, Operation
from clepsydra.program.program import Call
from clepsydra.program.reader import structured_program_of
from clepsydra.program.step_law import StepLaw


def needed_by_outputs(law: StepLaw, parts: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return for each output whose inputs it needs, of these parts.

    An output needs a signal if out or status depends on it in the same sample. A signal that no
    output depends on so, but by what is remembered of it, is needed by all outputs that this
    reaches in the end.

    `parts`: "pv" and "good", say.
    """
    columns = _places(s if s.part in parts else None for s in law.inputs)
    rows = {u: _places(law.outputs)[u] for u in owners(law.outputs, "out")}
    direct, moved, kept = (law.depends(*each) for each in ((1, 1), (0, 1), (0, 0)))
    while not np.array_equal(wider := moved | kept @ moved, moved):
        moved = wider
    ever = direct | law.depends(1, 0) @ moved

    def needs(output: str, owner: str, where: np.ndarray) -> bool:
        return bool(where[np.ix_(rows[output], columns[owner])].any())

    at_once = {y for y in columns if any(needs(u, y, direct) for u in rows)}
    return {
        u: tuple(y for y in columns if needs(u, y, direct if y in at_once else ever)) for u in rows
    }


def _places(signals: Iterable[Signal | None]) -> dict[str, list[int]]:
    """Return where the signals of each owner stand."""
    found: dict[str, list[int]] = {}
    for place, signal in enumerate(signals):
        if signal is not None:
            found.setdefault(signal.owner, []).append(place)
    return found


_SETTING = "setting of the plant shell"
#: Share of the sampling period by which a measured time step may differ from it.
_TOLERANCE = 0.1
#: Sampling periods up to which a law integrates over the measured time: half the time constant of
#: a closed loop that is sampled ten times in it.
_GAP = 5.0


class Members:
    """The sensors, setpoints and outputs of a controller as its plant shell has them.

    `sampling_period` [s].

    Raises InputError: A setting is for a signal that the controller does not have, a fail-safe
    value lies outside the limits, or the rate of an output cannot be limited.
    """

    def __init__(
        self, controller: Controller, settings: PlantShell, sampling_period: float
    ) -> None:
        self.controller, self.settings = controller, settings
        #: What the shell adds, where the numbers come from, and those of the law that it sets.
        self.parameters: list[Signal] = []
        self.sources: dict[str, str] = {}
        self.own_rates: dict[str, float] = {}
        #: The inputs by which alarms hold outputs, and the names of these.
        self.interlocks: list[Signal] = []
        self.interlocked: set[str] = set()
        #: What the shell cannot do here.
        self.notes: list[str] = []
        #: An input that nobody wires is to be seen: no sensor, manual, no time between two scans.
        self.unwired = {"time_step": 0.0}
        settings.check_names(controller)
        law = controller.law
        #: Whether the law only joins blocks, so that the shell can join them itself.
        self.law_joins = bool(law.blocks) or _only_joins(law)
        #: The loops that an operator sees.
        self.loops = [block for block in law.blocks if isinstance(block, PidBlock)]
        #: The parameters of the law.
        self.own = {parameter.name for parameter in law.parameters}
        inputs = {signal.name: signal for signal in law.inputs}
        results = {signal.name: signal for signal in law.outputs}
        names = dict(zip(owners(law.inputs, "pv"), controller.measurements, strict=True))
        #: The process signals, by the names that the law has for them.
        self.sensors = [replace(inputs[path(owner, "pv")], name=owner) for owner in names]
        for signal, name in zip(self.sensors, names.values(), strict=True):
            self._add_sensor(signal, name)
        measured = {name: owner for owner, name in names.items()}
        free = wired_setpoints(law, controller.free_inputs)
        #: With the measurement that each is the setpoint of, if the law has it.
        self.setpoints: list[tuple[Signal, str | None]] = []
        for owner, name in zip(free, controller.setpoints, strict=True):
            signal = replace(inputs[path(owner, "sp")], name=owner)
            self.setpoints.append((signal, measured.get(name)))
            self._add(SETPOINT_RATE, signal, name, "default: no ramp", measurement=signal)
        moved = dict(zip(owners(law.outputs, "out"), controller.manipulated, strict=True))
        self.outputs = [replace(results[path(owner, "out")], name=owner) for owner in moved]
        safe = [
            self._add_output(u, name) for u, name in zip(self.outputs, moved.values(), strict=True)
        ]
        scans = take_up_scans(controller, sampling_period, safe)
        for key, value, source in (
            (SAMPLING_PERIOD, sampling_period, "sampling period that the controller runs with"),
            (SCAN_TOLERANCE, _TOLERANCE, "default: a tenth"),
            (LONGEST_GAP, _GAP, "default: five sampling periods"),
            (TAKE_UP_SCANS, scans, "settling of what the law remembers, found by running it"),
        ):
            self.parameters.append(key.of("", float(value)))
            self.sources[key.name] = source

        #: The sensors and the setpoints that each output needs. A setpoint that stands fixed in the
        #: law is no business of the shell.
        self.needed = needed_by_outputs(law, ("pv", "good"))
        self.followed = {
            output: [name for name in names if name in free]
            for output, names in needed_by_outputs(law, ("sp",)).items()
        }

    @property
    def checks(self) -> list[Judged]:
        """What judges the parameters of law and shell."""
        every = (*self.controller.law.parameters, *self.parameters)
        low, high = (key.name for key in RANGE)
        names = {parameter.name for parameter in self.parameters}
        ends = [(path(y, low), path(y, high)) for y in self.sensors]
        return [*judged(every, (pair for pair in ends if pair[0] in names))]

    def limited(self, output: Signal) -> bool:
        """Return whether the law has limits of an output."""
        return {path(output, f"{end}_limit") for end in ("low", "high")} <= self.own

    def _add(
        self, key: Key, owner: Signal, name: str, source: str, default: float | None = None,
        **roles: Signal,
    ) -> float:  # fmt: skip
        """Add a parameter that may be set for a signal, and return its value."""
        given = getattr(self.settings, key.name).get(name)
        parameter = key.of(owner, default if given is None else float(given), **roles)
        self.parameters.append(parameter)
        self.sources[parameter.name] = source if given is None else _SETTING
        return parameter.initial

    def _add_sensor(self, signal: Signal, name: str) -> None:
        low, high = signal.low, signal.high
        self.unwired[path(signal, "good")] = 0.0
        if math.isfinite(low) and math.isfinite(high) and low < high:
            for key, end in zip(RANGE, (low, high), strict=True):
                self.parameters.append(key.of(signal, float(end), measurement=signal))
                self.sources[path(signal, key.name)] = f"range of {name} in the process file"
            # No current.
            self.unwired[path(signal, "pv")] = low - 4.0 * (high - low) / 16.0
        else:
            self.notes.append(
                f"The range of {name} is not known, so the shell cannot tell its current: only "
                "what is not a number and the fault bit of the card count as faults of it."
            )
        source = f"default: {SENSOR_DELAY.default:g} s"
        self._add(SENSOR_DELAY, signal, name, source, measurement=signal)

    def _add_output(self, signal: Signal, name: str) -> float:
        """Add an output, and return its fail-safe value."""
        values, place = self.controller.values, f"{self.controller.name}, plant shell"
        low = values.get(path(signal, "low_limit"), signal.low)
        high = values.get(path(signal, "high_limit"), signal.high)
        given = self.settings.fail_safe.get(name)
        if given is not None and not low <= given <= high:
            port = at_port(replace(signal, low=low, high=high, initial=given))
            raise InputError(
                f"{place}, fail_safe, {name}",
                f"{port.initial:g} {port.unit}".removesuffix(" 1"),
                f"a value from {port.low:g} to {port.high:g} {port.unit}, the limits of {name}",
                "choose one within the limits",
            )  # fmt: skip
        if given is None and not math.isfinite(low):
            raise InputError(
                f"{place}, fail_safe, {name}", "none",
                f"a fail-safe value: {name} has no low limit that could stand for it",
                f'write as in fail_safe={{"{name}": 0.0}}',
            )  # fmt: skip
        source = f"default: low limit of {name}"
        value = self._add(FAIL_SAFE, signal, name, source, low, output=signal)
        self.unwired |= {path(signal, what): value for what in ("manual", "tracking")}
        self.unwired[path(signal, "mode")] = float(Mode.MANUAL)
        if name in self.settings.interlock:
            self._add_interlock(signal, name, low, high)
        rate, own = self.settings.rate_limit.get(name), path(signal, "rate_limit")
        if own in self.own:
            if rate is not None:
                self.own_rates[own], self.sources[own] = float(rate), _SETTING
        elif reason := self._unhurried(signal, name):
            self.notes.append(f"The shell does not limit the rate of {name}: {reason}.")
            if rate is not None:
                raise InputError(
                    f"{place}, rate_limit, {name}", rate, f"none, since {reason}", "leave it out"
                )
        else:
            self._add(RATE_LIMIT, signal, name, "default: no rate limit", output=signal)
        return value

    def _add_interlock(self, signal: Signal, name: str, low: float, high: float) -> None:
        """Let alarms hold an output; one that nobody wires holds it."""
        value = min(high, max(low, self.settings.interlock[name]))
        parameter = INTERLOCK_VALUE.of(signal, value, output=signal)
        self.parameters.append(parameter)
        self.sources[parameter.name] = f"interlock of {name} in the process file"
        self.interlocks.append(replace(INTERLOCK, name=path(signal, INTERLOCK.name), initial=1.0))
        self.interlocked.add(signal.name)

    def _unhurried(self, signal: Signal, name: str) -> str | None:
        """Return why the rate of an output cannot be limited, if it cannot."""
        if path(signal, "running_value") in self.own:
            return f"{name} runs or stands"
        if not self.limited(signal):
            return f"the law has no limits of {name} that could be moved with it"
        if any(loop.form.winding == "clamping" for loop in self.loops):
            return (
                "clamping would keep the integral within the reach of the rate limit; the law "
                "with another anti-windup, or with a rate limit of its own, can have one"
            )
        return None


def _only_joins(law: StepLaw) -> bool:
    """Whether a law computes nothing but what its blocks do, and which conditions hold."""
    program = structured_program_of(law)
    own = [each for each in program.block.statements if not isinstance(each, Call)]
    logic = LOGIC | {"constant", "number", "truth"}
    return bool(program.calls) and all(
        isinstance(each, Operation) and each.code in logic for each in own
    )
