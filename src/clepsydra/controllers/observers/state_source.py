"""What tells a law the state of its process: sensors that show it, or an observer."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.sample import Reading, Sample, control_law
from clepsydra.controllers.process_model import evaluated, models_in
from clepsydra.linear.process_equations import ProcessEquations
from clepsydra.program.step_law import StepLaw


class StateSource(ABC):
    """The process signals of a law that feeds a state back, and where the state comes from.

    `measured`, `controlled`, `manipulated`: those that are controlled have setpoints; `fed_back`:
    the quantities of the state.

    Attributes
    ----------
    feedback, integral_gain : Matrix
        F and G, from the state and from the errors to the outputs.
    """

    #: Whether what is known of the state are its deviations from the operating point.
    from_rest = False

    def __init__(
        self,
        measured: Sequence[Signal],
        controlled: Sequence[Signal],
        manipulated: Sequence[Signal],
        fed_back: Sequence[Signal],
    ) -> None:
        self.measured, self.controlled = measured, controlled
        self.manipulated, self.fed_back = manipulated, fed_back
        words = "feedback gain from {by} to {to}"
        self.feedback = Matrix("feedback", manipulated, fed_back, words)
        words = "integral gain from the error of {by} to {to}"
        self.integral_gain = Matrix("integral_gain", manipulated, controlled, words, per=("s",))

    def gains(self) -> list[Signal]:
        """Return the numbers of both, as parameters of a law with integral action."""
        return signals.growing([*self.feedback.signals(), *self.integral_gain.signals()])

    @abstractmethod
    def known(self, sample: Sample, reading: Reading) -> list[ca.SX]:
        """Return the state in this sample, always numbers, and what `move_on` needs beyond it."""

    def deviations(self, sample: Sample, known: Sequence[ca.SX]) -> list[ca.SX]:
        """Return the deviations of a known state from the operating point."""
        found = list(known[: len(self.fed_back)])
        if not self.from_rest:
            at_rest = sample.parameters(*(signals.at_rest(x, "reference") for x in self.fed_back))
            found = [value - reference for value, reference in zip(found, at_rest, strict=True)]
        for x, value in zip(self.fed_back, found, strict=True):
            sample.name(x, {"deviation": value})
        return found

    def move_on(self, sample: Sample, known: Sequence[ca.SX], applied: Sequence[ca.SX]) -> None:
        """Write the state of the next sample, under the inputs that were applied; none here."""
        return

    def law(
        self,
        name: str,
        applied: Callable[[Sample, Reading, Sequence[ca.SX]], Sequence[ca.SX]],
        description: tuple[str, ...] = (),
    ) -> StepLaw:
        """Write the step law of these signals.

        `applied` writes the outputs from what is read and what is known of the state.
        """
        names = [y.name for y in self.measured], [y.name for y in self.controlled]

        def equations(sample: Sample) -> None:
            reading = Reading.of(sample, *names)
            known = self.known(sample, reading)
            self.move_on(sample, known, applied(sample, reading, known))

        return control_law(
            name,
            equations,
            measured=self.measured,
            controlled=self.controlled,
            manipulated=self.manipulated,
            description=description,
        )


class ProcessState(StateSource):
    """The state x of the `ProcessEquations`; `measurements`: what the law reads."""

    def __init__(self, equations: ProcessEquations, measurements: Sequence[str]) -> None:
        self.equations, self.measurements = equations, tuple(measurements)
        of = measurements, equations.outputs, equations.inputs, equations.states
        signal = equations.point.process.signal
        super().__init__(*([signal(name) for name in names] for names in of))


def sensors_of_states(equations: ProcessEquations) -> dict[str, str]:
    """Return each state with the measurement that shows it alone and in proportion, if one does."""
    found: dict[str, str] = {}
    for name, state in equations.point.process.measured_state.items():
        if state not in equations.states:
            continue
        slope = ca.jacobian(equations.reading(name), equations.state)
        others = set(slope.sparsity().get_col()) - {equations.states.index(state)}
        if others or ca.depends_on(slope, equations.state):
            continue
        # Where two sensors show a state, the one that is controlled is meant.
        if state not in found or name in equations.outputs:
            found[state] = name
    return found


class ShownStates:
    """States by the sensors that show them, in the place of an observer: nothing is kept.

    `sensors`: state to its sensor, as in `sensors_of_states`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> shown = ShownStates(
    ...     process_equations(cl.load("quadruple-tank").linear), {"tank_1.level": "level_1"})
    >>> shown.correct(Sample({"model.level_1.gain": ca.SX(50.0)}), [ca.SX(5.0)], ca.SX(1))
    [SX(0.1)]
    """

    def __init__(self, equations: ProcessEquations, sensors: Mapping[str, str]) -> None:
        self.equations = equations
        self.states, self.measurements = tuple(sensors), tuple(sensors.values())
        #: What it computes with: of each sensor what it shows at a state of zero, and its slope.
        self.expressions: list[ca.SX] = []
        zero = ca.SX.zeros(len(equations.states))
        for state, sensor in sensors.items():
            reading, place = equations.reading(sensor), equations.states.index(state)
            self.expressions.append(ca.substitute(reading, equations.state, zero))
            self.expressions.append(ca.jacobian(reading, equations.state[place]))

    def correct(self, sample: Sample, measured: Iterable[ca.SX], known: ca.SX) -> list[ca.SX]:
        """Return the states that the measurements show [p], see `Observer.correct`."""
        sample.parameters(*models_in(self.equations, self.expressions))
        at = evaluated(self.equations, self.expressions, sample.symbols)
        return [
            (value - zero) / ca.if_else(slope == 0, 1, slope)
            for value, zero, slope in zip(measured, at[::2], at[1::2], strict=True)
        ]

    def predict(self, sample: Sample, estimate: Sequence[ca.SX], inputs: Sequence[ca.SX]) -> None:
        """Write the state of the next sample: none."""


class MeasuredState(ProcessState):
    """Each state by the measurement that shows it alone and in proportion.

    Raises InputError: A state is not measured so.
    """

    def __init__(self, equations: ProcessEquations) -> None:
        found = sensors_of_states(equations)
        if missing := [name for name in equations.states if name not in found]:
            raise InputError(
                "state",
                ", ".join(missing),
                "a measurement that shows the state alone and in proportion",
                "add a sensor, or an observer",
            )
        self._shown = ShownStates(equations, {name: found[name] for name in equations.states})
        # The controlled outputs come first, then what shows the other states.
        measurements = dict.fromkeys((*equations.outputs, *self._shown.measurements))
        super().__init__(equations, [*measurements])

    def known(self, sample: Sample, reading: Reading) -> list[ca.SX]:
        """Return what the sensors show."""
        measured = (reading.measurements[y] for y in self._shown.measurements)
        return self._shown.correct(sample, measured, reading.known)
