"""The one-step inverse: the inputs that bring each output to its setpoint within one sample."""

from __future__ import annotations

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.final_element import declare_output, final_element
from clepsydra.controllers.blocks.ports import Asked
from clepsydra.controllers.blocks.sample import Reading, Sample, control_law
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.blocks.validity import any_of, is_number, time_step_of
from clepsydra.controllers.observers.observer import ModelObserver
from clepsydra.controllers.observers.state_source import ShownStates, sensors_of_states
from clepsydra.controllers.observers.unmodelled_rate import UnmodelledRate
from clepsydra.controllers.one_step_model import OneStepModel
from clepsydra.linear.process_equations import NEARLY_EMPTY, ProcessEquations
from clepsydra.program.step_law import StepLaw

FAMILY = "one-step inverse"
_OFFSET = Key(
    "start_offset", "{measurement}", "how far beside the setpoint of {measurement} a start began"
)
_FADES = signals.amount(
    "fading_time", "s", "time in which a bumpless start of {measurement} fades",
    60.0, low=signals.SHORTEST_TIME,
)  # fmt: skip
_WAS_IN_FORCE = Key(
    "was_in_force", "1", "{output} was in automatic in the last sample", 0.0, 1.0, kind="boolean"
)
_LOST = Signal(
    "lost", low=0.0, high=1.0, kind="boolean",
    description="the measurements were not known in the last sample",
)  # fmt: skip
_DESCRIPTION = (
    "y⁺ = ŷ + Δt d + Δy(x, u): Δy is what the equations of the process say of a sample, d the rate "
    "that they lack, from an observer of each output.",
    "u makes y⁺ the setpoint; where limits do not allow it, Σ |r − y⁺|/largest_error is the least "
    "that they do.",
)


def one_step_inverse_law(
    equations: ProcessEquations, *, substeps: int = 1, observer: ModelObserver | None = None
) -> StepLaw:
    """Write the step law of the one-step inverse with a disturbance observer.

    In each sample, with Δy(x, u) what the outputs gain in a sample by the equations of the
    process, the inputs solve::

        ŷ + Δt d + Δy(x, u) = r

    within their limits; where these do not allow it, the sum of the errors that are left,
    Σ_j |r_j − y_j⁺|/ē_j, is the least that they do (`blocks.shared_limits`). ŷ and the rate d that
    the model lacks are those of an observer of each output (`observers.unmodelled_rate`), so that
    no load leaves an offset, and the setpoint is followed in one sample however slow the observer.
    It hears of the inputs that were applied: there is nothing that could wind up. Levels count as
    2 % of their height at least.

    An input that is not in automatic stands where it is, and the others do their best around it.
    When automatic takes over, after a change of mode or a fault, the outputs are meant to go where
    the inputs bring them as they stand; what that is beside the setpoint fades,
    o⁺ = o − min(Δt/Tf, 1) o.

    `equations`: of a process at an operating point, each output of relative degree one;
    `substeps`: of the Runge-Kutta method in a sample; `observer`: where not every state that acts
    on the outputs is measured.

    Raises InputError: A state that acts on the outputs is neither measured nor estimated.

    References
    ----------
    C. G. Economou, M. Morari and B. O. Palsson, Internal model control: extension to nonlinear
    systems, Industrial & Engineering Chemistry Process Design and Development 25(2), 1986,
    403-411, doi 10.1021/i200033a010.
    """
    law = _Law(equations, substeps, observer)
    return control_law(
        "one_step_inverse",
        law.equations,
        measured=[equations.point.process.signal(name) for name in law.measurements],
        controlled=law.model.outputs,
        manipulated=law.model.inputs,
        description=_DESCRIPTION,
    )


class _Law:
    def __init__(
        self, equations: ProcessEquations, substeps: int, observer: ModelObserver | None
    ) -> None:
        sensors = sensors_of_states(equations)
        known = observer.states if observer else sensors
        if missing := [name for name in equations.states if name not in known]:
            raise InputError(
                "one-step inverse, state",
                ", ".join(missing),
                "a measurement that shows the state alone and in proportion",
                "add a sensor, or an observer",
            )
        # Beside an observer only the outputs show a state.
        shown = {
            name: sensors[name]
            for name in equations.states
            if name in sensors and (observer is None or sensors[name] in equations.outputs)
        }
        self.model = OneStepModel(equations, substeps)
        self._process = equations
        self._shown, self._observer = ShownStates(equations, shown), observer
        # What the law reads: the outputs, then what shows the other states.
        further = (observer or self._shown).measurements
        self.measurements = tuple(dict.fromkeys((*equations.outputs, *further)))
        self._observers = [UnmodelledRate(y) for y in self.model.outputs]

    def equations(self, sample: Sample) -> None:
        model, names = self.model, [y.name for y in self.model.outputs]
        reading = Reading.of(sample, self.measurements, names)
        time, time_good = time_step_of(sample.symbols)
        sample.memory(_LOST)
        sample.parameters(*model.constants)
        found = [
            each.corrected(sample, reading.measurements[name], reading.known)
            for each, name in zip(self._observers, names, strict=True)
        ]
        estimate = self._estimate(sample, reading)
        x = self._state(sample, reading, [corrected for corrected, _ in found], estimate)
        drifting = [corrected + time * rate for corrected, rate in found]
        begins = any_of([self._begins(sample, u) for u in model.inputs])
        last = [sample[path(u, "last_output")] for u in model.inputs]
        aims = self._aims(sample, reading, drifting, begins, model.gained(sample, "last", x, last))
        wanted = [aim - value for aim, value in zip(aims, drifting, strict=True)]
        at_rest = sample.parameters(*(signals.at_rest(u, "bias") for u in model.inputs))
        largest = sample.parameters(
            *(
                signals.size(path(y, "largest_error"), y, f"largest acceptable error of {y.name}")
                for y in model.outputs
            )
        )
        solved = model.inverse(sample, x, wanted, self._limits(sample), largest, at_rest)
        # Where automatic begins the last inputs are what is looked for, but for rounding.
        asked = [ca.if_else(begins, u, v) for u, v in zip(last, solved, strict=True)]
        usable = ca.logic_and(reading.numbers, reading.sensors)
        applied = [
            final_element(sample, u, Asked(value, usable, reading.numbers, reading.sensors))
            for u, value in zip(model.inputs, asked, strict=True)
        ]
        given = [each.applied for each in applied]
        gained = model.gained(sample, "applied", x, given)
        if self._observer:
            self._observer.predict(sample, list(estimate.values()), given)
        goes_on = ca.logic_and(reading.known, time_good)
        for observer, now, increment in zip(self._observers, found, gained, strict=True):
            observer.move_on(sample, goes_on, *now, increment)
        sample.next_state[_LOST.name] = ca.logic_not(reading.known)
        for u, value, each in zip(model.inputs, asked, applied, strict=True):
            sample.next_state[path(u, "was_in_force")] = each.in_force
            sample.name(u, {"asked": value})

    def _estimate(self, sample: Sample, reading: Reading) -> dict[str, ca.SX]:
        """Return the states that an observer estimates, if there is one."""
        if self._observer is None:
            return {}
        measured = [reading.measurements[name] for name in self._observer.measurements]
        found = self._observer.correct(sample, measured, reading.known)
        return dict(zip(self._observer.states, found, strict=True))

    def _state(
        self,
        sample: Sample,
        reading: Reading,
        corrected: list[ca.SX],
        estimate: dict[str, ca.SX],
    ) -> list[ca.SX]:
        """Return x, of which the outputs show what their own observers say."""
        shown = dict(reading.measurements)
        shown |= zip((y.name for y in self.model.outputs), corrected, strict=True)
        measured = [shown[name] for name in self._shown.measurements]
        states = self._shown.correct(sample, measured, reading.known)
        known = estimate | dict(zip(self._shown.states, states, strict=True))
        x = ca.vertcat(*(known[name] for name in self._process.states))
        # In a tank that runs empty within the sample a mixture would be divided by nothing.
        return ca.vertsplit(self._process.bounded(x, NEARLY_EMPTY))

    def _aims(
        self,
        sample: Sample,
        reading: Reading,
        drifting: list[ca.SX],
        begins: ca.SX,
        standing: list[ca.SX],
    ) -> list[ca.SX]:
        """Return where each output is to be in the next sample, and write how a start fades.

        `drifting`: where it would be if neither state nor inputs moved it; `begins`: whether
        automatic takes over an input; `standing`: what it gains if the inputs stand.
        """
        time, _ = time_step_of(sample.symbols)
        aims = []
        for y, value, gained in zip(self.model.outputs, drifting, standing, strict=True):
            (fades,) = sample.parameters(_FADES.of(y, measurement=y))
            (kept,) = sample.memory(_OFFSET.of(y, measurement=y))
            setpoint = reading.setpoints[y.name]
            offset = ca.if_else(begins, value + gained - setpoint, kept)
            offset = ca.if_else(is_number(offset), offset, 0)
            left = offset - tracking_share(time, fades) * offset
            sample.next_state[path(y, "start_offset")] = ca.if_else(is_number(left), left, 0)
            aims.append(setpoint + offset)
            sample.name(y, {"aim": aims[-1]})
        return aims

    def _begins(self, sample: Sample, moved: Signal) -> ca.SX:
        """Return whether automatic takes over an input."""
        declare_output(sample, moved)
        (was_in_force,) = sample.memory(_WAS_IN_FORCE.of(moved, output=moved))
        return ca.logic_and(self._controls(sample, moved), ca.logic_not(was_in_force))

    def _limits(self, sample: Sample) -> tuple[list[ca.SX], list[ca.SX]]:
        """Return between which values each input may be chosen: one that stands is at both."""
        ends: list[list[ca.SX]] = [[], []]
        for u in self.model.inputs:
            controls, last, *limits = (
                self._controls(sample, u),
                *sample.of(u, "last_output", "low_limit", "high_limit"),
            )
            for found, value in zip(ends, limits, strict=True):
                found.append(ca.if_else(controls, value, last))
        low, high = ends
        return low, high

    def _controls(self, sample: Sample, moved: Signal) -> ca.SX:
        """Return whether an input is in automatic."""
        return sample[path(moved, "mode")] == Mode.AUTOMATIC
