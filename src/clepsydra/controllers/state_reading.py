"""The state that a feedback law acts on: measured as a whole, or estimated by an observer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
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
    setpoints, measurements : list of casadi.SX
        Zero where they are no numbers.
    signals_are_numbers, sensors_are_good : casadi.SX
    named : dict
        Names for values on the way.

    Examples
    --------
    >>> true = ca.SX(1)
    >>> StateReading([ca.SX(0.5)], [ca.SX(5)], [ca.SX(4.5)], true, true, {}).state
    [SX(0.5)]
    """

    state: list[ca.SX]
    setpoints: list[ca.SX]
    measurements: list[ca.SX]
    signals_are_numbers: ca.SX
    sensors_are_good: ca.SX
    named: dict[str, ca.SX]


@dataclass(frozen=True)
class StateSignals:
    """The signals of a law that feeds a state back.

    Parameters
    ----------
    measured, manipulated : tuple of Signal
    controlled : tuple of int
        For setpoint_1, setpoint_2, … the number (from 1) of its measurement.
    observer : ObserverStructure or None
        None where the measurements show the whole state.

    Raises
    ------
    InputError
        A setpoint belongs to no measurement, or the observer is for other signals.

    Examples
    --------
    >>> state = StateSignals((Signal("level", "V"),), (Signal("pump", "V"),), (1,))
    >>> [signal.name for signal in state.inputs()]
    ['setpoint_1', 'measurement_1', 'sensor_1', 'mode_1', 'manual_1', 'tracking_1', 'time_step']
    """

    measured: tuple[Signal, ...]
    manipulated: tuple[Signal, ...]
    controlled: tuple[int, ...]
    observer: ObserverStructure | None = None

    def __post_init__(self) -> None:
        known = range(1, len(self.measured) + 1)
        if not self.controlled or any(number not in known for number in self.controlled):
            raise InputError(
                "state feedback, controlled",
                self.controlled,
                f"numbers of measurements from 1 to {len(self.measured)}",
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

    def inputs(self) -> list[Signal]:
        """Return setpoint_j, measurement_j, sensor_j, mode_i, manual_i, tracking_i, time_step."""
        return [
            *signals.setpoint_inputs([self.measured[number - 1] for number in self.controlled]),
            *signals.measurement_inputs(self.measured),
            *signals.output_inputs(self.manipulated),
        ]

    def reference_parameters(self) -> list[Signal]:
        """Return reference_measurement_j, and the matrices of the observer."""
        references = [
            signals.gain(
                f"reference_measurement_{j}",
                measurement.unit,
                0.0,
                f"{measurement.name} at the operating point",
            )
            for j, measurement in enumerate(self.measured, start=1)
        ]
        if self.observer is None:
            return references
        return references + observer_parameters(self.observer, self.measured, self.manipulated)

    def feedback_parameters(self, i: int) -> list[Signal]:
        """Return feedback_i_j for every quantity of the state, and bias_i."""
        output = self.manipulated[i - 1]
        feedback = [
            signals.gain(
                f"feedback_{i}_{j}",
                signals.ratio_of_units(output.unit, quantity.unit),
                0.0,
                f"feedback gain from {quantity.name} to {output.name}",
            )
            for j, quantity in enumerate(self.state, start=1)
        ]
        at_rest = f"{output.name} at the operating point"
        return [*feedback, signals.gain(f"bias_{i}", output.unit, 0.0, at_rest)]

    def states(self) -> list[Signal]:
        """Return integral_i and last_output_i, and estimate_j of the observer."""
        own = [
            state
            for i, output in enumerate(self.manipulated, start=1)
            for state in signals.output_state(i, output)
        ]
        return own if self.observer is None else own + observer_state(self.observer)

    def outputs(self) -> list[Signal]:
        """Return manipulated_i and status_i."""
        return [
            result
            for i, output in enumerate(self.manipulated, start=1)
            for result in signals.output_signals(i, output)
        ]

    def read(self, symbols: Symbols) -> StateReading:
        """Return what is known of the state in this sample."""
        p = len(self.measured)
        raw = [symbols[f"measurement_{j}"] for j in range(1, p + 1)]
        raw += [symbols[f"setpoint_{j}"] for j in range(1, len(self.controlled) + 1)]
        valid = [is_number(value) for value in raw]
        numbers = [value_or_zero(*pair) for pair in zip(raw, valid, strict=True)]
        good = all_of([symbols[f"sensor_{j}"] for j in range(1, p + 1)])
        deviations = [
            measurement - symbols[f"reference_measurement_{j}"]
            for j, measurement in enumerate(numbers[:p], start=1)
        ]
        state, named = deviations, {}
        if self.observer is not None:
            known = ca.logic_and(all_of(valid[:p]), good)
            state, surprise = corrected(symbols, self.observer, self.measured, deviations, known)
            named = {f"surprise_{j}": value for j, value in enumerate(surprise, start=1)}
        named |= {f"deviation_{j}": value for j, value in enumerate(state, start=1)}
        return StateReading(state, numbers[p:], numbers[:p], all_of(valid), good, named)

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
        moves = [stage.manipulated - symbols[f"bias_{stage.number}"] for stage in stages]
        following = predicted(symbols, self.observer, self.manipulated, reading.state, moves)
        return Equations({**ended.next_state, **following}, ended.outputs, ended.intermediates)


def weighted_sum(symbols: Symbols, prefix: str, values: Sequence[ca.SX]) -> ca.SX:
    """Return prefix_1 · values[0] + prefix_2 · values[1] + …

    Examples
    --------
    >>> gains = {"feedback_1_1": ca.DM(2.0), "feedback_1_2": ca.DM(3.0)}
    >>> float(weighted_sum(gains, "feedback_1", [ca.DM(10.0), ca.DM(1.0)]))
    23.0
    """
    total = symbols[f"{prefix}_1"] * values[0]
    for number, value in enumerate(values[1:], start=2):
        total = total + symbols[f"{prefix}_{number}"] * value
    return total
