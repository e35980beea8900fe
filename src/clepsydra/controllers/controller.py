"""A controller: a step law with values for its parameters, wired to a process."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Self

from clepsydra.controllers.parameters import (
    check_finite,
    check_numbers,
    check_parameters,
    remembered_parameters,
)
from clepsydra.controllers.wiring import (
    check_wiring,
    controller_name,
    input_wires,
    output_wires,
)
from clepsydra.program.step_law import StepLaw

if TYPE_CHECKING:
    from clepsydra.program.program import Program


class Complexity(IntEnum):
    """What a controller is made of; the smaller, the more people can look after it.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> cl.design.simc(plant).complexity.words
    'PI or PID loops'
    >>> cl.design.lqi(plant).complexity.words
    'a model, and more measurements than are controlled'
    """

    LOOPS = 1
    ADVANCED_LOOPS = 2
    MODEL = 3
    MODEL_WITH_MORE_MEASUREMENTS = 4

    @property
    def words(self) -> str:
        """What it is, in a few words."""
        return _WORDS[self]


_WORDS = {
    Complexity.LOOPS: "PI or PID loops",
    Complexity.ADVANCED_LOOPS: "loops with decoupling, feedforward, cascade, rules or schedules",
    Complexity.MODEL: "a model in the controller, and no further sensors",
    Complexity.MODEL_WITH_MORE_MEASUREMENTS: "a model, and more measurements than are controlled",
}


def plain_name(title: str) -> str:
    """Return the name that a title begins with."""
    return re.sub(r", slowed [\d.]+ times$", "", title)


@dataclass(frozen=True)
class Controller:
    """A step law, the values of its parameters, and the process signals it is wired to.

    An output of the law is ``pump.out`` with ``pump.mode``, ``pump.manual``, ``pump.tracking`` and
    ``pump.status``; a measurement ``level.pv`` with ``level.good``, its setpoint ``level.sp``, and
    ``time_step`` is common.

    Parameters
    ----------
    name : str
        What the reader sees: "PI, SIMC".
    family : str
        The kind of law: "multiloop PI".
    design : str
        How the parameters were found, in one sentence.
    values : dict
        Parameter name to its value, in the law's units.
    initial_state : dict
        State name to its value at the operating point, so that the loop starts at rest. A state
        that remembers a parameter, last_K of K, starts at the parameter's value if left out.
    measurements : tuple of str
        Process measurement wired to each pv of the law, in their order.
    setpoints : tuple of str
        Controlled measurement whose setpoint is wired to each sp of the law.
    manipulated : tuple of str
        Process input wired to each out of the law.
    notes : tuple of str
        What the designer must tell the reader.
    free_inputs : dict
        Input of the law that no signal of the process drives, to its value at rest: a choice of
        setpoints, say. In a loop it is the input "controller." + its name.
    free_outputs : tuple of str
        Outputs of the law that no signal of the process takes: a watchdog, say. In a loop it is
        "controller." + its name.
    structure : Complexity
        What its law is made of; a model where nothing else is said.
    slowed : float
        How many times slower than its method asked for it is, so that its loops bear each other;
        1 where it is as the method has it.

    Raises InputError: A parameter or initial state is missing, unknown, no finite number or outside
    its range, or the names of the signals are not one for each signal of the law.

    Examples
    --------
    Gains found by hand for one tank:

    >>> from clepsydra.controllers.pid import multiloop_pid_law
    >>> law = multiloop_pid_law(["level_1"], ["pump_1"])
    >>> values = dict(proportional_gain=2.0, integral_time=40.0, setpoint_weight=1.0,
    ...               tracking_time=40.0, low_limit=0.0, high_limit=10.0)
    >>> by_hand = Controller(
    ...     "PI, by hand", "multiloop PI", "Found on the plant.", law,
    ...     {parameter.name: values[parameter.part] for parameter in law.parameters},
    ...     {"level_1.integral": 3.0, "pump_1.last_output": 3.0},
    ...     ("level_1",), ("level_1",), ("pump_1",))
    >>> by_hand.output_wires
    {'pump_1.out': 'pump_1', 'pump_1.status': 'pump_1.status'}
    """

    name: str
    family: str
    design: str
    law: StepLaw
    values: dict[str, float]
    initial_state: dict[str, float]
    measurements: tuple[str, ...]
    setpoints: tuple[str, ...]
    manipulated: tuple[str, ...]
    notes: tuple[str, ...] = ()
    free_inputs: dict[str, float] = field(default_factory=dict)
    free_outputs: tuple[str, ...] = ()
    structure: Complexity = Complexity.MODEL
    slowed: float = 1.0

    def __post_init__(self) -> None:
        check_parameters(self.law, self.values, self.name)
        complete = remembered_parameters(self.law, self.values) | self.initial_state
        object.__setattr__(self, "initial_state", complete)
        check_numbers(self.law.state, self.initial_state, self.name)
        wires = self.measurements, self.setpoints, self.manipulated
        check_wiring(self.law, *wires, self.name, self.free_inputs, self.free_outputs)
        for name, value in self.free_inputs.items():
            check_finite(f"{self.name}, free inputs, {name}", value)

    @property
    def title(self) -> str:
        """The name, with how much its method was slowed down: what stands where it is judged.

        The name alone is what it is chosen by.

        Examples
        --------
        >>> import clepsydra as cl
        >>> import dataclasses
        >>> controller = cl.design.ziegler_nichols(cl.load("three-tanks"))
        >>> controller.title
        'PI, Ziegler-Nichols, slowed 1.98 times'
        >>> dataclasses.replace(controller, slowed=1.0004).title
        'PI, Ziegler-Nichols, slowed 1.0004 times'
        """
        if self.slowed == 1.0:
            return self.name
        shown = f"{self.slowed:.3g}"
        # One that is hardly slower is so by the digits in which it differs.
        return f"{self.name}, slowed {f'{self.slowed:.7g}' if shown == '1' else shown} times"

    def described(
        self, design: str, notes: Iterable[str] = (), slowed: float | None = None
    ) -> Self:
        """Return it with how it was found, further notes, and how much it was slowed down."""
        slowed = self.slowed if slowed is None else slowed
        return replace(self, design=design, notes=(*self.notes, *notes), slowed=slowed)

    @property
    def further_measurements(self) -> tuple[str, ...]:
        """What it measures and does not control."""
        return tuple(name for name in self.measurements if name not in self.setpoints)

    @property
    def complexity(self) -> Complexity:
        """How much it asks for: its structure, and for a model what it has to measure."""
        if self.structure is Complexity.MODEL and self.further_measurements:
            return Complexity.MODEL_WITH_MORE_MEASUREMENTS
        return self.structure

    @property
    def input_wires(self) -> dict[str, str]:
        """Law input to the loop's signal, "level_1.pv" → "level_1"; time_step is not wired."""
        wired = input_wires(self.law, self.measurements, self.setpoints, self.manipulated)
        return wired | {name: controller_name(name) for name in self.free_inputs}

    @property
    def output_wires(self) -> dict[str, str]:
        """Law output to the loop's signal, "pump_1.out" → "pump_1"."""
        wired = output_wires(self.law, self.manipulated)
        return wired | {name: controller_name(name) for name in self.free_outputs}

    def program(self) -> Program:
        """Return the law as a program that starts with this controller's numbers.

        `print_c` and `print_structured_text` print the parameters and the initial state that
        were designed, as the declarations' initial values.

        Examples
        --------
        >>> import clepsydra as cl
        >>> program = cl.design.simc(cl.load("quadruple-tank")).program()
        >>> gain = program.parameters[0]
        >>> gain.name, round(gain.initial, 6)
        ('level_1.proportional_gain', 3.0)
        """
        from clepsydra.program.defaults import with_defaults  # with all that reads a law
        from clepsydra.program.reader import structured_program_of

        return with_defaults(structured_program_of(self.law), {**self.values, **self.initial_state})
