"""The state that a feedback law acts on: measured as a whole, or estimated by an observer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.output_stage import OutputStage, stage_equations
from clepsydra.controllers.blocks.validity import all_of, is_number, value_or_zero
from clepsydra.controllers.observers.current_observer import (
    corrected,
    observer_parameters,
    observer_state,
    predicted,
)
from clepsydra.controllers.observers.structure import ObserverStructure
from clepsydra.program.step_law import Equations, Symbols


@dataclass(frozen=True)
class StateReading:
    """What is known of the state in a sample.

    Parameters
    ----------
    state : list of casadi.SX
        The state's deviation from the operating point: of the measurements themselves, or of
        what an observer estimates.
    setpoints, measurements : dict
        By the name of the measurement, zero where they are no numbers.
    signals_are_numbers, sensors_are_good : casadi.SX
    named : dict
        Names for values on the way.

    Examples
    --------
    >>> true = ca.SX(1)
    >>> reading = StateReading(
    ...     [ca.SX(0.5)], {"level": ca.SX(5)}, {"level": ca.SX(4.5)}, true, true, {})
    >>> reading.errors
    {'level.error': SX(0.5)}
    """

    state: list[ca.SX]
    setpoints: dict[str, ca.SX]
    measurements: dict[str, ca.SX]
    signals_are_numbers: ca.SX
    sensors_are_good: ca.SX
    named: dict[str, ca.SX]

    @property
    def errors(self) -> dict[str, ca.SX]:
        """The error of each controlled measurement."""
        return {path(y, "error"): r - self.measurements[y] for y, r in self.setpoints.items()}


@dataclass(frozen=True)
class StateSignals:
    """The signals of a law that feeds a state back.

    Parameters
    ----------
    measured, manipulated : tuple of Signal
    controlled : tuple of str
        The measurements that have setpoints.
    observer : ObserverStructure or None
        None where the measurements show the whole state.

    Raises
    ------
    InputError
        A setpoint belongs to no measurement, or the observer is for other signals.

    Examples
    --------
    >>> state = StateSignals((Signal("level", "V"),), (Signal("pump", "V"),), ("level",))
    >>> [signal.name for signal in state.inputs()][:4]
    ['level.sp', 'level.pv', 'level.good', 'pump.mode']
    """

    measured: tuple[Signal, ...]
    manipulated: tuple[Signal, ...]
    controlled: tuple[str, ...]
    observer: ObserverStructure | None = None

    @classmethod
    def of(
        cls,
        measured: Sequence[Signal | str],
        manipulated: Sequence[Signal | str],
        controlled: Sequence[str],
        observer: ObserverStructure | None,
        place: str,
    ) -> Self:
        """Return those of a law, where a signal that has but a name is of unit 1."""
        return cls(
            signals.process_signals(measured, f"{place}, measured"),
            signals.process_signals(manipulated, f"{place}, manipulated"),
            tuple(controlled),
            observer,
        )

    def __post_init__(self) -> None:
        known = [signal.name for signal in self.measured]
        if not self.controlled or any(name not in known for name in self.controlled):
            raise InputError(
                "state feedback, controlled",
                self.controlled,
                f"some of the measurements {', '.join(known)}",
                "give for each setpoint the measurement that follows it",
            )
        heard = len(self.measured), len(self.manipulated)
        if self.observer and (self.observer.measurements, self.observer.inputs) != heard:
            raise InputError(
                "state feedback, observer",
                (self.observer.measurements, self.observer.inputs),
                f"an observer for {heard[0]} measurements and {heard[1]} inputs",
                "give it the measurements and inputs of the law",
            )

    @property
    def state(self) -> tuple[Signal, ...]:
        """What is fed back."""
        return self.measured if self.observer is None else self.observer.estimated

    @property
    def followed(self) -> list[Signal]:
        """The measurements that have setpoints."""
        known = {signal.name: signal for signal in self.measured}
        return [known[name] for name in self.controlled]

    def inputs(self) -> list[Signal]:
        """Return setpoints, then pv and good, then mode, manual and tracking, and time_step."""
        return [
            *signals.setpoint_inputs(self.followed),
            *signals.measurement_inputs(self.measured),
            *signals.output_inputs(self.manipulated),
        ]

    def reference_parameters(self) -> list[Signal]:
        """Return reference of each measurement, and the matrices of the observer."""
        references = [signals.at_rest(y, "reference") for y in self.measured]
        if self.observer is None:
            return references
        return references + observer_parameters(self.observer, self.measured, self.manipulated)

    def feedback_parameters(self, u: Signal) -> list[Signal]:
        """Return feedback of an output for every quantity of the state."""
        return [
            signals.number_of("feedback", u, x, f"feedback gain from {x.name} to {u.name}")
            for x in self.state
        ]

    def integral_parameters(self, u: Signal) -> list[Signal]:
        """Return integral_gain of an output for every controlled measurement."""
        return integral_gains(u, self.followed)

    def fed_back(self, symbols: Symbols, u: Signal, reading: StateReading) -> ca.SX:
        """Return F x of an output."""
        names = [effect(u, "feedback", x) for x in self.state]
        return weighted_sum(symbols, names, reading.state)

    def of_controlled(
        self, symbols: Symbols, u: Signal, matrix: str, values: Sequence[ca.SX]
    ) -> ca.SX:
        """Return the row of an output in a matrix by the controlled measurements, times values."""
        return weighted_sum(symbols, [effect(u, matrix, y) for y in self.controlled], values)

    def states(self) -> list[Signal]:
        """Return integral and last_output of each output, and the estimates of the observer."""
        own = [state for u in self.manipulated for state in signals.output_state(u)]
        return own if self.observer is None else own + observer_state(self.observer)

    def outputs(self) -> list[Signal]:
        """Return out and status of each output."""
        return [result for u in self.manipulated for result in signals.output_signals(u)]

    def read(self, symbols: Symbols) -> StateReading:
        """Return what is known of the state in this sample."""
        names, p = [signal.name for signal in self.measured], len(self.measured)
        raw = [symbols[path(y, "pv")] for y in names]
        raw += [symbols[path(y, "sp")] for y in self.controlled]
        valid = [is_number(value) for value in raw]
        numbers = [value_or_zero(*pair) for pair in zip(raw, valid, strict=True)]
        good = all_of([symbols[path(y, "good")] for y in names])
        measurements = dict(zip(names, numbers[:p], strict=True))
        state = [value - symbols[path(y, "reference")] for y, value in measurements.items()]
        named: dict[str, ca.SX] = {}
        if self.observer is not None:
            known = ca.logic_and(all_of(valid[:p]), good)
            state, surprise = corrected(symbols, self.observer, self.measured, state, known)
            named = {path(y, "surprise"): e for y, e in zip(names, surprise, strict=True)}
        named |= {path(x, "deviation"): e for x, e in zip(self.state, state, strict=True)}
        setpoints = dict(zip(self.controlled, numbers[p:], strict=True))
        return StateReading(state, setpoints, measurements, all_of(valid), good, named)

    def equations(
        self,
        symbols: Symbols,
        reading: StateReading,
        stages: Sequence[OutputStage],
        intermediates: dict[str, ca.SX],
    ) -> Equations:
        """Return the equations of a law that ends in these stages, and moves the observer on."""
        ended = stage_equations(stages, reading.named | intermediates)
        if self.observer is None:
            return ended
        moves = [stage.manipulated - symbols[path(stage.moved, "bias")] for stage in stages]
        following = predicted(symbols, self.observer, self.manipulated, reading.state, moves)
        return Equations({**ended.next_state, **following}, ended.outputs, ended.intermediates)


def integral_gains(u: Signal, followed: Sequence[Signal], when: str = "") -> list[Signal]:
    """Return integral_gain of an output for every controlled measurement.

    Examples
    --------
    >>> integral_gains(Signal("pump", "V"), [Signal("level", "m")])[0].unit
    'V/(m s)'
    """
    words = "integral gain from the error of"
    return [
        signals.number_of("integral_gain", u, y, f"{words} {y.name} to {u.name}{when}", "s")
        for y in followed
    ]


def weighted_sum(symbols: Symbols, names: Sequence[str], values: Sequence[ca.SX]) -> ca.SX:
    """Return the sum of the signals of these names times the values.

    Examples
    --------
    >>> gains = {"pump.feedback.tank_1": ca.DM(2.0), "pump.feedback.tank_2": ca.DM(3.0)}
    >>> float(weighted_sum(gains, list(gains), [ca.DM(10.0), ca.DM(1.0)]))
    23.0
    """
    first, *others = (symbols[name] * value for name, value in zip(names, values, strict=True))
    return sum(others, first)
