"""What a user's own law gives, and what is added so that it can run on a plant."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import (
    all_of,
    is_number,
    is_time_step,
    value_or_zero,
)
from clepsydra.controllers.inner_law import inner_equations
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

#: Numbered names of former versions, and what stands for each now.
_FORMER = {
    "measurement": "level.pv", "sensor": "level.good", "setpoint": "level.sp",
    "mode": "pump.mode", "manual": "pump.manual", "tracking": "pump.tracking",
    "manipulated": "pump.out", "status": "pump.status", "last_output": "pump.last_output",
    "low_limit": "pump.low_limit", "high_limit": "pump.high_limit",
}  # fmt: skip


def check_paths(place: str, names: Iterable[str]) -> None:
    """Refuse the numbered names of former versions.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_paths("my_law.py", ["level.pv", "gain"])
    """
    for name in names:
        former = re.fullmatch(r"(.*)_\d+", name)
        if former and former[1] in _FORMER:
            raise InputError(
                place, name, f"a name like {_FORMER[former[1]]}",
                "write what it belongs to, a dot, and what it is of that",
            )  # fmt: skip


@dataclass(frozen=True)
class OwnSignals:
    """The signals of a law that a user wrote, and those of the whole law.

    The user gives what is asked for in automatic. Added are, for each output, mode, manual and
    tracking value, limits, the last output and the status word; for each measurement whether its
    sensor is good; and the time step.

    Parameters
    ----------
    place : str
        File or name of the law, for messages.
    inputs, parameters, outputs : tuple of Signal
    state : tuple of Signal or DelayRing

    Raises
    ------
    InputError
        An output is not the out of something, or a name stands for two signals.

    Examples
    --------
    >>> own = OwnSignals("my_law.py", (Signal("level.pv"),), (Signal("gain"),),
    ...                  (Signal("pump.out"),), ())
    >>> [signal.name for signal in own.whole_inputs]
    ['level.pv', 'level.good', 'pump.mode', 'pump.manual', 'pump.tracking', 'time_step']
    """

    place: str
    inputs: tuple[Signal, ...]
    parameters: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    state: tuple[Signal | DelayRing, ...]

    def __post_init__(self) -> None:
        every = (*self.inputs, *self.parameters, *self.outputs, *self.state)
        check_paths(self.place, [signal.name for signal in every])
        names = [signal.name for signal in self.outputs]
        if not names or any(s.part != "out" or not s.owner for s in self.outputs):
            raise InputError(
                f"{self.place}, outputs", ", ".join(names) or "none", "outputs like pump.out",
                "name each so after what it moves, and wire it to the process by the controller",
            )  # fmt: skip
        # What was written first, since what is added to it would be twice there too.
        whole = *self.outputs, *self.whole_inputs, *self.whole_parameters, *self.whole_state
        every_name = [signal.name for signal in whole]
        for name in every_name:
            if every_name.count(name) > 1:
                raise InputError(
                    self.place, name, "a name for one input, parameter, state or output",
                    "leave out or rename one",
                )  # fmt: skip

    @property
    def moved(self) -> tuple[Signal, ...]:
        """What each output moves."""
        return tuple(replace(signal, name=signal.owner) for signal in self.outputs)

    @property
    def sensors(self) -> tuple[str, ...]:
        """The input good of each measurement."""
        return tuple(path(owner, "good") for owner in signals.owners(self.inputs, "pv"))

    @property
    def plant(self) -> tuple[str, ...]:
        """The inputs that have to be numbers: measurements and setpoints."""
        return tuple(signal.name for signal in self.inputs if signal.part in ("pv", "sp"))

    @property
    def whole_inputs(self) -> list[Signal]:
        """Those of the user, but the last outputs, and those that are added."""
        added = [
            Signal(name, low=0.0, high=1.0, initial=1.0, kind="boolean") for name in self.sensors
        ]
        added += signals.output_inputs(self.moved)
        known = [signal.name for signal in added]
        last = [path(signal, "last_output") for signal in self.moved]
        return [*(s for s in self.inputs if s.name not in (*known, *last)), *added]

    @property
    def whole_parameters(self) -> list[Signal]:
        """Those of the user, and the limits of each output."""
        limits = [p for output in self.moved for p in signals.limit_parameters(output)]
        own = {parameter.name for parameter in self.parameters}
        return [*self.parameters, *(p for p in limits if p.name not in own)]

    @property
    def whole_state(self) -> list[Signal | DelayRing]:
        """That of the user, and the last outputs."""
        return [*self.state, *map(signals.last_output, self.moved)]

    @property
    def whole_outputs(self) -> list[Signal]:
        """out and status of each output."""
        return [result for output in self.moved for result in signals.output_signals(output)]

    def end(self) -> StepLaw:
        """Return what comes after the user's part, as a law with the inputs asked and usable."""
        names = [path(output, "asked") for output in self.moved]

        def equations(symbols: Symbols) -> Equations:
            sample = Sample(symbols)
            conditions = symbols["usable"], symbols["numbers"], symbols["sensors"]
            self._end(sample, [symbols[name] for name in names], *conditions)
            return sample.equations()

        return step_law(
            "end",
            inputs=[
                *(Signal(name) for name in (*names, "usable", "numbers", "sensors")),
                *signals.output_inputs(self.moved),
            ],
            parameters=[p for output in self.moved for p in signals.limit_parameters(output)],
            state=map(signals.last_output, self.moved),
            outputs=self.whole_outputs,
            equations=equations,
        )

    def _end(
        self, sample: Sample, asked: Sequence[ca.SX], usable: ca.SX, numbers: ca.SX, good: ca.SX
    ) -> None:
        for moved, value in zip(self.moved, asked, strict=True):
            final_element(sample, moved, Asked(value, usable, numbers, good))

    def whole_law(self, law: StepLaw) -> StepLaw:
        """Return a law of expressions with the end added; its signals are those of the user."""

        def equations(symbols: Symbols) -> Equations:
            raw = {s.name: symbols[s.name] for s in self.inputs}
            valid = {name: is_number(raw[name]) for name in self.plant}
            known = raw | {n: value_or_zero(raw[n], v) for n, v in valid.items()}
            true = ca.SX(1)
            numbers = all_of([*valid.values()]) if valid else true
            good = all_of([symbols[n] for n in self.sensors]) if self.sensors else true
            time_step_good = is_time_step(symbols["time_step"])
            usable = ca.logic_and(ca.logic_and(numbers, good), time_step_good)
            if "time_step" in known:
                known["time_step"] = ca.if_else(time_step_good, symbols["time_step"], 1)
            found = inner_equations(law, {**symbols, **known})
            sample = Sample(symbols)
            sample.named |= found.intermediates
            sample.next_state |= {
                name: ca.if_else(usable, value, symbols[name])
                for name, value in found.next_state.items()
            }
            asked = [found.outputs[signal.name] for signal in law.outputs]
            self._end(sample, asked, usable, numbers, good)
            return sample.equations()

        return step_law(
            law.name,
            inputs=self.whole_inputs,
            parameters=self.whole_parameters,
            state=self.whole_state,
            outputs=self.whole_outputs,
            equations=equations,
            description=law.description,
        )
