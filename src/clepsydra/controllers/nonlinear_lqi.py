"""What LQI laws share whose state comes from the equations of the process themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup
from clepsydra.controllers.blocks.output_stage import OutputStage, stage_equations
from clepsydra.controllers.blocks.validity import all_of, is_number, value_or_zero
from clepsydra.controllers.blocks.varying_gains import Feedback, varying_lqi
from clepsydra.controllers.linear_quadratic_integral import check_lqi_anti_windup
from clepsydra.controllers.observers.measured_state import KnownState, StateSource
from clepsydra.controllers.process_equations import ProcessEquations, model_parameter
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law


class LqiReading(NamedTuple):
    """What an LQI law knows in a sample.

    Parameters
    ----------
    feedback : Feedback
        With deviations from reference_state_j.
    known : KnownState

    Examples
    --------
    >>> true = ca.SX(1)
    >>> known = KnownState([ca.SX(3)], lambda applied: {}, {})
    >>> LqiReading(Feedback([ca.SX(1)], [ca.SX(0)], true, true), known).known.state
    [SX(3)]
    """

    feedback: Feedback
    known: KnownState


@dataclass(frozen=True, eq=False)
class NonlinearLqi:
    """Signals and reading of LQI on the state x of the `ProcessEquations`.

    Parameters
    ----------
    source : StateSource
    anti_windup : AntiWindup

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.observers.measured_state import MeasuredState
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("averaging-tank").linear)
    >>> common = NonlinearLqi(MeasuredState(equations), "none")
    >>> [signal.name for signal in common.gain_signals()][:2]
    ['feedback_1_1', 'feedback_1_2']
    """

    source: StateSource
    anti_windup: AntiWindup

    @property
    def equations(self) -> ProcessEquations:
        """Of the process."""
        return self.source.equations

    @property
    def manipulated(self) -> list[Signal]:
        """The signals of the inputs."""
        return [self.equations.point.process.signal(name) for name in self.equations.inputs]

    @property
    def controlled(self) -> list[Signal]:
        """The signals of the controlled outputs."""
        return [self.equations.point.process.signal(name) for name in self.equations.outputs]

    def inputs(self) -> list[Signal]:
        """Return setpoint_j, measurement_j, sensor_j, mode_i, manual_i, tracking_i, time_step."""
        process = self.equations.point.process
        measured = [process.signal(name) for name in self.source.measurements]
        return [
            *signals.setpoint_inputs(self.controlled),
            *signals.measurement_inputs(measured),
            *signals.output_inputs(self.manipulated),
        ]

    def outputs(self) -> list[Signal]:
        """Return manipulated_i and status_i."""
        numbered = enumerate(self.manipulated, start=1)
        return [result for i, output in numbered for result in signals.output_signals(i, output)]

    def gain_signals(self, *, kept: bool = False) -> list[Signal]:
        """Return feedback_i_j and integral_gain_i_j; as states what they were last.

        Parameters
        ----------
        kept : bool
            Whether they are states.
        """
        when = " in the last sample" if kept else ""
        found = []
        for i, output in enumerate(self.manipulated, start=1):
            for j, state in enumerate(self.equations.signals_of_states(), start=1):
                words = f"feedback gain from {state.name} to {output.name}{when}"
                unit = signals.ratio_of_units(output.unit, state.unit)
                found.append(signals.gain(f"feedback_{i}_{j}", unit, 0.0, words))
            for j, shown in enumerate(self.controlled, start=1):
                words = f"integral gain from the error of {shown.name} to {output.name}{when}"
                unit = signals.ratio_of_units(output.unit, shown.unit, "s")
                found.append(signals.gain(f"integral_gain_{i}_{j}", unit, 0.0, words))
        return found

    def output_parameters(self) -> list[Signal]:
        """Return reference_state_j, bias_i, limits and, for back-calculation, tracking times."""
        found = [
            signals.gain(
                f"reference_state_{j}", state.unit, 0.0, f"{state.name} at the operating point"
            )
            for j, state in enumerate(self.equations.signals_of_states(), start=1)
        ]
        for i, output in enumerate(self.manipulated, start=1):
            at_rest = f"{output.name} at the operating point"
            found.append(signals.gain(f"bias_{i}", output.unit, 0.0, at_rest))
            found += signals.output_parameters(i, output, self.anti_windup)
        return found

    def states(self) -> list[Signal]:
        """Return integral_i and last_output_i, and the memory of the source."""
        own = [
            state
            for i, output in enumerate(self.manipulated, start=1)
            for state in signals.output_state(i, output)
        ]
        return [*own, *self.source.memory()]

    def last_outputs(self, symbols: Symbols) -> list[ca.SX]:
        """Return what was applied in the last sample."""
        return [symbols[f"last_output_{i}"] for i in range(1, len(self.manipulated) + 1)]

    def gains_in(self, symbols: Symbols, what: str) -> list[list[ca.SX]]:
        """Return the rows of feedback_i_j or integral_gain_i_j."""
        of_states, of_errors = len(self.equations.states), len(self.equations.outputs)
        count = of_states if what == "feedback" else of_errors
        rows = range(1, len(self.manipulated) + 1)
        return [[symbols[f"{what}_{i}_{j}"] for j in range(1, count + 1)] for i in rows]

    def read(self, symbols: Symbols) -> LqiReading:
        """Return what is known in this sample."""
        names = self.source.measurements
        p, q = len(names), len(self.controlled)
        raw = [symbols[f"measurement_{k}"] for k in range(1, p + 1)]
        raw += [symbols[f"setpoint_{j}"] for j in range(1, q + 1)]
        valid = [is_number(value) for value in raw]
        values = [value_or_zero(*pair) for pair in zip(raw, valid, strict=True)]
        sensors = all_of([symbols[f"sensor_{k}"] for k in range(1, p + 1)])
        usable = ca.logic_and(all_of(valid[:p]), sensors)
        known = self.source.known(symbols, values[:p], usable)
        errors = [
            values[p + j] - values[names.index(name)]
            for j, name in enumerate(self.equations.outputs)
        ]
        deviations = [
            value - symbols[f"reference_state_{j}"] for j, value in enumerate(known.state, start=1)
        ]
        return LqiReading(Feedback(deviations, errors, all_of(valid), sensors), known)

    def ended(
        self,
        reading: LqiReading,
        stages: Sequence[OutputStage],
        named: Mapping[str, ca.SX],
        kept: Mapping[str, ca.SX],
    ) -> Equations:
        """Return the equations of a law that ends in these stages, and moves its observer on."""
        deviations = enumerate(reading.feedback.state, start=1)
        before = reading.known.named | {f"deviation_{j}": value for j, value in deviations}
        ended = stage_equations(stages, {**before, **named})
        following = reading.known.following([stage.manipulated for stage in stages])
        return Equations(
            {**ended.next_state, **following, **kept}, ended.outputs, ended.intermediates
        )


def nonlinear_lqi_law(source: StateSource, anti_windup: AntiWindup = "back_calculation") -> StepLaw:
    """Write the step law of LQI with fixed gains on the state of the process's equations.

    As `linear_quadratic_integral.lqi_law`, u = u° − F (x − x°) + I, with x from the extended
    Kalman filter, for one.

    Parameters
    ----------
    source : StateSource
    anti_windup : {"back_calculation", "conditional_integration", "none"}

    Returns
    -------
    StepLaw
        Inputs as for `lqi_law`; parameters feedback_i_j, integral_gain_i_j [per second],
        reference_state_j, model_*, bias_i, limits, tracking_time_i [s] for back-calculation,
        and those of the observer; state integral_i, last_output_i and that of the observer.

    Raises
    ------
    InputError
        The anti-windup is unknown or clamping.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.observers.extended_kalman import ExtendedKalman
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("quadruple-tank").linear)
    >>> law = nonlinear_lqi_law(ExtendedKalman(equations, ("level_1", "level_2"), (), 1, 0))
    >>> sum(signal.name.startswith("feedback") for signal in law.parameters)
    8
    """
    check_lqi_anti_windup(anti_windup)
    common = NonlinearLqi(source, anti_windup)

    def equations(symbols: Symbols) -> Equations:
        reading = common.read(symbols)
        gains = common.gains_in(symbols, "feedback"), common.gains_in(symbols, "integral_gain")
        stages, named = varying_lqi(
            symbols, common.manipulated, reading.feedback, gains[0], None, gains[1], anti_windup
        )
        return common.ended(reading, stages, named, {})

    return step_law(
        "nonlinear_lqi",
        inputs=common.inputs(),
        parameters=[
            *common.gain_signals(),
            *(model_parameter(each) for each in source.constants),
            *source.parameters(),
            *common.output_parameters(),
        ],
        state=common.states(),
        outputs=common.outputs(),
        equations=equations,
        description=(f"Anti-windup: {IN_WORDS[anti_windup]}.",),
    )
