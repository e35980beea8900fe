"""What LQI laws share whose state comes from the equations of the process themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca

from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup
from clepsydra.controllers.blocks.output_stage import OutputStage, stage_equations
from clepsydra.controllers.blocks.validity import all_of, is_number, value_or_zero
from clepsydra.controllers.blocks.varying_gains import Feedback, varying_lqi
from clepsydra.controllers.linear_quadratic_integral import check_lqi_anti_windup
from clepsydra.controllers.observers.measured_state import KnownState, StateSource
from clepsydra.controllers.process_equations import ProcessEquations, model_parameter
from clepsydra.controllers.state_reading import integral_gains
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law


class LqiReading(NamedTuple):
    """What an LQI law knows in a sample.

    Parameters
    ----------
    feedback : Feedback
        With deviations from the references of the states.
    known : KnownState

    Examples
    --------
    >>> true = ca.SX(1)
    >>> known = KnownState([ca.SX(3)], lambda applied: {}, {})
    >>> LqiReading(Feedback([ca.SX(1)], {"level.error": ca.SX(0)}, true, true), known).known.state
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
    ['inflow.feedback.tank.level', 'inflow.feedback.tank.impurity']
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
        """Return setpoints, then pv and good, then mode, manual and tracking, and time_step."""
        process = self.equations.point.process
        measured = [process.signal(name) for name in self.source.measurements]
        return [
            *signals.setpoint_inputs(self.controlled),
            *signals.measurement_inputs(measured),
            *signals.output_inputs(self.manipulated),
        ]

    def outputs(self) -> list[Signal]:
        """Return out and status of each output."""
        return [result for u in self.manipulated for result in signals.output_signals(u)]

    def gain_signals(self, *, kept: bool = False) -> list[Signal]:
        """Return feedback and integral_gain of each output; as states what they were last.

        Parameters
        ----------
        kept : bool
            Whether they are states.
        """
        when = " in the last sample" if kept else ""
        found = []
        for u in self.manipulated:
            found += [
                signals.number_of(
                    "feedback", u, x, f"feedback gain from {x.name} to {u.name}{when}"
                )
                for x in self.equations.signals_of_states()
            ]
            found += integral_gains(u, self.controlled, when)
        return found

    def output_parameters(self) -> list[Signal]:
        """Return references of states, biases, limits and, for back-calculation, tracking times."""
        found = [signals.at_rest(x, "reference") for x in self.equations.signals_of_states()]
        for u in self.manipulated:
            found.append(signals.at_rest(u, "bias"))
            found += signals.output_parameters(u, self.anti_windup)
        return found

    def states(self) -> list[Signal]:
        """Return integral and last_output of each output, and the memory of the source."""
        own = [state for u in self.manipulated for state in signals.output_state(u)]
        return [*own, *self.source.memory()]

    def names_of(self, matrix: str) -> list[list[str]]:
        """Return the names of the rows of feedback or integral_gain."""
        by = self.equations.states if matrix == "feedback" else self.equations.outputs
        return [[effect(u, matrix, each) for each in by] for u in self.equations.inputs]

    def gains_in(self, symbols: Symbols, matrix: str) -> list[list[ca.SX]]:
        """Return the rows of feedback or integral_gain."""
        return [[symbols[name] for name in row] for row in self.names_of(matrix)]

    def read(self, symbols: Symbols) -> LqiReading:
        """Return what is known in this sample."""
        names, controlled = self.source.measurements, self.equations.outputs
        p = len(names)
        raw = [symbols[path(y, "pv")] for y in names]
        raw += [symbols[path(y, "sp")] for y in controlled]
        valid = [is_number(value) for value in raw]
        values = [value_or_zero(*pair) for pair in zip(raw, valid, strict=True)]
        sensors = all_of([symbols[path(y, "good")] for y in names])
        usable = ca.logic_and(all_of(valid[:p]), sensors)
        known = self.source.known(symbols, values[:p], usable)
        errors = {
            path(y, "error"): setpoint - values[names.index(y)]
            for y, setpoint in zip(controlled, values[p:], strict=True)
        }
        deviations = [
            value - symbols[path(x, "reference")]
            for x, value in zip(self.equations.states, known.state, strict=True)
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
        deviations = zip(self.equations.states, reading.feedback.state, strict=True)
        before = reading.known.named | {path(x, "deviation"): value for x, value in deviations}
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
        Inputs as for `lqi_law`; parameters feedback and integral_gain [per second] of each
        output, reference of each state, model.*, bias, limits and, for back-calculation,
        tracking_time [s], and those of the observer; state integral and last_output of each
        output, and that of the observer.

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
    >>> sum(signal.matrix == "feedback" for signal in law.parameters)
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
