"""What a user's own law gives, and what is added so that it can run on a plant."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.validity import (
    all_of,
    is_number,
    is_time_step,
    value_or_zero,
)
from clepsydra.controllers.inner_law import inner_equations
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

_PLANT = ("setpoint", "measurement")


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
        The outputs are not manipulated_1, manipulated_2, …, or a name stands for two signals.

    Examples
    --------
    >>> own = OwnSignals("my_law.py", (Signal("measurement_1"),), (Signal("gain"),),
    ...                  (Signal("manipulated_1"),), ())
    >>> [signal.name for signal in own.whole_inputs]
    ['measurement_1', 'sensor_1', 'mode_1', 'manual_1', 'tracking_1', 'time_step']
    """

    place: str
    inputs: tuple[Signal, ...]
    parameters: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    state: tuple[Signal | DelayRing, ...]

    def __post_init__(self) -> None:
        names = [signal.name for signal in self.outputs]
        wanted = [f"manipulated_{i}" for i in range(1, len(names) + 1)]
        if not names or names != wanted:
            raise InputError(
                f"{self.place}, outputs", ", ".join(names) or "none",
                f"{', '.join(wanted) or 'manipulated_1'}",
                "name the outputs so, and wire them to the process by the controller",
            )  # fmt: skip
        every = [s.name for s in (*self.whole_inputs, *self.whole_parameters, *self.whole_state)]
        for name in every:
            if every.count(name) > 1:
                raise InputError(
                    self.place, name, "a name for one input, parameter or state", "rename one"
                )

    @property
    def moved(self) -> tuple[Signal, ...]:
        """What each output moves; nameless but for its number."""
        return tuple(
            replace(signal, name=f"output_{i}") for i, signal in enumerate(self.outputs, start=1)
        )

    @property
    def sensors(self) -> tuple[str, ...]:
        """sensor_j of each measurement_j."""
        found = (re.fullmatch(r"measurement_(\d+)", signal.name) for signal in self.inputs)
        return tuple(f"sensor_{match[1]}" for match in found if match)

    @property
    def whole_inputs(self) -> list[Signal]:
        """Those of the user, but the last outputs, and those that are added."""
        asked = {signal.name: signal for signal in self.inputs}
        added = [
            Signal(name, low=0.0, high=1.0, initial=1.0, kind="boolean") for name in self.sensors
        ]
        added += signals.output_inputs(self.moved)
        known = [signal.name for signal in added]
        last = [f"last_{signal.name}" for signal in self.moved]
        own = [s for name, s in asked.items() if name not in (*known, *last)]
        return [*own, *added]

    @property
    def whole_parameters(self) -> list[Signal]:
        """Those of the user, and the limits of each output."""
        limits = [p for i, s in enumerate(self.moved, 1) for p in signals.limit_parameters(i, s)]
        own = {parameter.name for parameter in self.parameters}
        return [*self.parameters, *(p for p in limits if p.name not in own)]

    @property
    def whole_state(self) -> list[Signal | DelayRing]:
        """That of the user, and the last outputs."""
        return [*self.state, *(signals.last_output(i, s) for i, s in enumerate(self.moved, 1))]

    @property
    def whole_outputs(self) -> list[Signal]:
        """manipulated_i and status_i."""
        return [r for i, s in enumerate(self.moved, 1) for r in signals.output_signals(i, s)]

    def end(self) -> StepLaw:
        """Return what comes after the user's part, as a law with the inputs asked_i and usable."""
        numbers = range(1, len(self.outputs) + 1)
        names = [f"asked_{i}" for i in numbers]

        def equations(symbols: Symbols) -> Equations:
            conditions = symbols["usable"], symbols["numbers"], symbols["sensors"]
            return self._ended(symbols, [symbols[name] for name in names], *conditions)

        return step_law(
            "end",
            inputs=[
                *(Signal(name) for name in (*names, "usable", "numbers", "sensors")),
                *signals.output_inputs(self.moved),
            ],
            parameters=[
                p for i, s in enumerate(self.moved, 1) for p in signals.limit_parameters(i, s)
            ],
            state=[signals.last_output(i, s) for i, s in enumerate(self.moved, 1)],
            outputs=self.whole_outputs,
            equations=equations,
        )

    def _ended(
        self, symbols: Symbols, asked: Sequence[ca.SX], usable: ca.SX, numbers: ca.SX, good: ca.SX
    ) -> Equations:
        state: dict[str, ca.SX] = {}
        outputs: dict[str, ca.SX] = {}
        named: dict[str, ca.SX] = {}
        for i, (moved, value) in enumerate(zip(self.moved, asked, strict=True), start=1):
            element = final_element(symbols, i, moved, Asked(value, usable, numbers, good))
            state[f"last_output_{i}"] = element.manipulated
            outputs |= {f"manipulated_{i}": element.manipulated, f"status_{i}": element.status}
            named |= element.named
        return Equations(state, outputs, named)

    def whole_law(self, law: StepLaw) -> StepLaw:
        """Return a law of expressions with the end added; its signals are those of the user."""

        def equations(symbols: Symbols) -> Equations:
            raw = {s.name: symbols[s.name] for s in self.inputs}
            valid = {n: is_number(raw[n]) for n in raw if n.rpartition("_")[0] in _PLANT}
            known = raw | {n: value_or_zero(raw[n], v) for n, v in valid.items()}
            true = ca.SX(1)
            numbers = all_of([*valid.values()]) if valid else true
            good = all_of([symbols[n] for n in self.sensors]) if self.sensors else true
            time_step_good = is_time_step(symbols["time_step"])
            usable = ca.logic_and(ca.logic_and(numbers, good), time_step_good)
            if "time_step" in known:
                known["time_step"] = ca.if_else(time_step_good, symbols["time_step"], 1)
            found = inner_equations(law, {**symbols, **known})
            asked = [found.outputs[signal.name] for signal in law.outputs]
            ended = self._ended(symbols, asked, usable, numbers, good)
            state = {
                name: ca.if_else(usable, value, symbols[name])
                for name, value in found.next_state.items()
            }
            return Equations(
                {**state, **ended.next_state},
                ended.outputs,
                {**found.intermediates, **ended.intermediates},
            )

        return step_law(
            law.name,
            inputs=self.whole_inputs,
            parameters=self.whole_parameters,
            state=self.whole_state,
            outputs=self.whole_outputs,
            equations=equations,
            description=law.description,
        )
