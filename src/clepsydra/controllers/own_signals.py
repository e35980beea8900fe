"""What a user's own law gives, and what is added so that it can run on a plant."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.ports import Asked
from clepsydra.controllers.blocks.sample import Sample, control_law, inner_equations
from clepsydra.controllers.blocks.validity import (
    all_of,
    is_number,
    is_time_step,
    value_or_zero,
)
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

#: Numbered names of former versions, and what stands for each now.
_FORMER = {
    "measurement": "level.pv", "sensor": "level.good", "setpoint": "level.sp",
    "mode": "pump.mode", "manual": "pump.manual", "tracking": "pump.tracking",
    "manipulated": "pump.out", "status": "pump.status", "last_output": "pump.last_output",
    "low_limit": "pump.low_limit", "high_limit": "pump.high_limit",
}  # fmt: skip

#: When what is asked for counts, and what the status word is told.
_COUNTS = ("usable", "numbers", "sensors")


@dataclass(frozen=True)
class OwnSignals:
    """The signals of a law that a user wrote, and those of the whole law.

    The user gives what is asked for in automatic. Added are, for each output, mode, manual and
    tracking value, limits, the last output and the status word; for each measurement whether its
    sensor is good; and the time step.

    `place`: file or name of the law, for messages.

    Raises InputError: an output is not the out of something, or a name stands for two signals.
    """

    place: str
    inputs: tuple[Signal, ...]
    parameters: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    state: tuple[Signal | DelayRing, ...]

    def __post_init__(self) -> None:
        every = (*self.inputs, *self.parameters, *self.outputs, *self.state)
        for name in (signal.name for signal in every):
            former = re.fullmatch(r"(.*)_\d+", name)
            if former and former[1] in _FORMER:
                raise InputError(
                    self.place, name, f"a name like {_FORMER[former[1]]}",
                    "write what it belongs to, a dot, and what it is of that",
                )  # fmt: skip
        names = [signal.name for signal in self.outputs]
        if not names or any(s.part != "out" or not s.owner for s in self.outputs):
            raise InputError(
                f"{self.place}, outputs", ", ".join(names) or "none", "outputs like pump.out",
                "name each so after what it moves, and wire it to the process by the controller",
            )  # fmt: skip
        # What is added to an output that was written twice would be there twice, too.
        self._refuse_twice(self.outputs)
        self._refuse_twice([signal for group in self.whole.values() for signal in group])

    def _refuse_twice(self, signals: Sequence[Signal | DelayRing]) -> None:
        names = [signal.name for signal in signals]
        for name in names:
            if names.count(name) > 1:
                raise InputError(
                    self.place, name, "a name for one input, parameter, state or output",
                    "leave out or rename one",
                )  # fmt: skip

    @property
    def sensors(self) -> tuple[str, ...]:
        """The input good of each measurement."""
        return tuple(path(owner, "good") for owner in signals.owners(self.inputs, "pv"))

    @property
    def plant(self) -> tuple[str, ...]:
        """The inputs that have to be numbers: measurements and setpoints."""
        return tuple(signal.name for signal in self.inputs if signal.part in ("pv", "sp"))

    @cached_property
    def end(self) -> StepLaw:
        """What comes after the user's part; what that asks, and when it counts, are parameters."""
        moved = [replace(signal, name=signal.owner) for signal in self.outputs]

        def equations(sample: Sample) -> None:
            for output in moved:
                told = sample.parameters(*map(Signal, (path(output, "asked"), *_COUNTS)))
                final_element(sample, output, Asked(*told))

        return control_law("end", equations, measured=(), controlled=(), manipulated=moved)

    @cached_property
    def whole(self) -> dict[str, Any]:
        """The signals of the whole law by their groups: the user's, and those that are added."""
        good = (Signal(n, low=0.0, high=1.0, initial=1.0, kind="boolean") for n in self.sensors)
        added = [*good, *self.end.inputs]
        known = {signal.name for signal in (*added, *self.end.state)}
        limits = {p.name: p for p in self.end.parameters if p.part in ("low_limit", "high_limit")}
        # Limits that the user declares himself are limits of the output all the same.
        own = [replace(p, below=limits[p.name].below) if p.name in limits else p
               for p in self.parameters]  # fmt: skip
        added_limits = (p for name, p in limits.items() if name not in {p.name for p in own})
        return {
            "inputs": (*(signal for signal in self.inputs if signal.name not in known), *added),
            "parameters": (*own, *added_limits),
            "state": (*self.state, *self.end.state),
            "outputs": self.end.outputs,
        }

    def whole_law(self, law: StepLaw) -> StepLaw:
        """Return a law of expressions with the end added; its signals are those of the user."""

        def equations(symbols: Symbols) -> Equations:
            valid = {name: is_number(symbols[name]) for name in self.plant}
            known = {name: value_or_zero(symbols[name], sound) for name, sound in valid.items()}
            true = ca.SX(1)
            numbers = all_of([*valid.values()]) if valid else true
            good = all_of([symbols[n] for n in self.sensors]) if self.sensors else true
            time_step_good = is_time_step(symbols["time_step"])
            usable = ca.logic_and(ca.logic_and(numbers, good), time_step_good)
            if any(signal.name == "time_step" for signal in self.inputs):
                known["time_step"] = ca.if_else(time_step_good, symbols["time_step"], 1)
            found = inner_equations(law, {**symbols, **known})
            asked = {path(s.owner, "asked"): found.outputs[s.name] for s in self.outputs}
            counts = dict(zip(_COUNTS, (usable, numbers, good), strict=True))
            end = inner_equations(self.end, {**symbols, **asked, **counts})
            kept = {
                name: ca.if_else(usable, value, symbols[name])
                for name, value in found.next_state.items()
            }
            names = {**found.intermediates, **end.intermediates}
            return Equations({**kept, **end.next_state}, end.outputs, names)

        return step_law(law.name, **self.whole, equations=equations, description=law.description)
