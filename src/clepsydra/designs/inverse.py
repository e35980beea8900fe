"""One-step inverse: each output at its setpoint in one sample, with a disturbance observer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from clepsydra.base.words import listed, time_text
from clepsydra.controllers.blocks.shared_limits import MOST_INPUTS
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.observers.state_source import sensors_of_states
from clepsydra.controllers.one_step_inverse import FAMILY, one_step_inverse_law
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import number
from clepsydra.designs.arguments.of_process import MEASUREMENTS
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.control_authority import check_ranges, control_authorities
from clepsydra.designs.sampled.steps_in_a_sample import steps_in_a_sample
from clepsydra.designs.slowing_down import as_given, note_on_peak, note_on_slowing, slow_down
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_errors
from clepsydra.designs.states.linear_quadratic import refuse_feedthrough
from clepsydra.designs.states.model_observer import (
    FoundModelObserver,
    model_observer,
    note_on_observer,
)
from clepsydra.designs.states.state_controllers import note_on_sensors, sensitivity_peak
from clepsydra.linear.control_authority import DESIGN_STEP
from clepsydra.linear.internal_dynamics import internal_dynamics
from clepsydra.linear.lie_derivatives import NotLinearisable
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.process_equations import ProcessEquations, process_equations
from clepsydra.linear.relative_degree import elimination_order, linear_relative_degrees

NAME = "One-step inverse"
#: Time of the observer in sampling periods: for a tank without a level of its own max|S| is then
#: 4/(1 + p)² with p = 1.725/2.725, which is 1.5.
OBSERVER_PERIODS = 1.725

# Its equations do not depend on the time of the observer, of which a search tries several.
_law = lru_cache(maxsize=8)(one_step_inverse_law)


@design(
    "inverse",
    "one-step inverse with disturbance observer",
    Studied(255, NAME),
    keys=(
        MEASUREMENTS,
        DEVIATIONS[0],
        number(
            "observer_time",
            "a time",
            "time in which the observer follows what the model lacks",
            unit="s",
            example='"5 s"',
        ),
    ),
    method="one-step inverse",
)
def design_inverse(
    model: LinearModel,
    *,
    measurements: Sequence[str] | None = None,
    maximum_errors: Mapping[str, float] | None = None,
    observer_time: float | None = None,
) -> Controller:
    """Design the one-step inverse of a process, with an observer of what its model lacks.

    In each sample the controller solves the equations of the process for the inputs that bring
    the outputs to their setpoints within one sample, or as near to it as the limits allow: then
    the sum of the errors, each over its largest acceptable one, is the least. Without noise and
    with a true model no controller reaches a setpoint sooner.

    How hard it answers to what the model did not predict is up to the observer: its time is 1.7
    sampling periods, with which max|S| is about 1.5, and longer where max|S| would be above 2.
    Where a state acts on the outputs that no sensor shows, or the measurements are chosen, another
    observer runs the equations of the process beside it, corrected by the gain of a Kalman filter.

    Parameters
    ----------
    measurements : sequence of str, optional
        What that observer reads, with the controlled outputs among them; by default there is none
        where every state that acts on the outputs is measured.
    maximum_errors : mapping, optional
        Output to its largest acceptable error, which says how much it counts beside the others
        while inputs are at their limits; a tenth of its range if left out.
    observer_time : float, optional
        Of all outputs [s]: longer is quieter, and slower against loads.

    Raises
    ------
    NotApplicable
        There are not as many inputs as outputs, or more than two; the process has dead time; an
        output does not answer at once with its rate; the inputs do not move the outputs apart;
        what goes on while the outputs are held does not come to rest; a state that acts on the
        outputs can neither be measured nor estimated; or the loop is not robust.
    InputError
        The model has no operating point, a name is unknown, or a number is not above zero.

    References
    ----------
    C. G. Economou, M. Morari and B. O. Palsson, Internal model control: extension to nonlinear
    systems, Industrial & Engineering Chemistry Process Design and Development 25(2), 1986,
    403-411, doi 10.1021/i200033a010.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.states.state_controllers import sensitivity_peak
    >>> model = cl.load("averaging-tank").linear
    >>> found = design_inverse(model)
    >>> found.values["volume.observer_time"], round(sensitivity_peak(found, model), 2)
    (0.1725, 1.5)
    >>> design_inverse(cl.load("three-tanks").linear)
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: one-step inverse is not applicable: level_3 \
answers to the inputs only by its derivative of order 3, so that nothing brings it to its setpoint \
within a sample.
    """
    equations = _invertible(model)
    errors = acceptable_errors(model, maximum_errors)
    period = equations.point.process.sampling_period
    fading = _fading_times(model, period)
    by = None
    if measurements is not None or not _all_shown(equations):
        by = model_observer(model, equations, measurements, float(max(fading)))

    def observed_in(time: float) -> Controller:
        return inverse_controller(equations, errors, time, fading, by)

    def peak(controller: Controller) -> float:
        return sensitivity_peak(controller, model)

    if observer_time is None:
        shortest = OBSERVER_PERIODS * period
        found = slow_down(lambda factor: observed_in(shortest * factor), peak)
        time, notes = shortest * found.factor, note_on_slowing(found, "the observer")
    else:
        time = float(observer_time)
        found = as_given(observed_in(time), peak, f"an observer time of {time_text(time)}")
        notes = note_on_peak(found.peak, "choose a longer observer time")
    controller = found.design
    return controller.described(
        f"Inverse of the process within a sample of {time_text(period)}, observers of "
        f"{time_text(time)} for what the model lacks; sensitivity peak {found.peak:.2f}.",
        (*_notes(model, equations, controller, by), *notes),
        found.factor,
    )


def inverse_controller(
    equations: ProcessEquations,
    largest_errors: Mapping[str, float],
    observer_time: float,
    fading_times: np.ndarray,
    by: FoundModelObserver | None = None,
) -> Controller:
    """Return a one-step inverse at rest at the operating point, judged by no rule.

    Parameters
    ----------
    equations : ProcessEquations
        Each output of relative degree one.
    largest_errors : mapping
        Output to its largest acceptable error [its unit].
    observer_time : float
        Of all outputs [s].
    fading_times : ndarray [q]
        In which a bumpless start of each output fades [s].
    by : FoundModelObserver, optional
        Where not every state that acts on the outputs is measured.

    Raises
    ------
    InputError
        A state is neither measured nor estimated.
    NotApplicable
        A number is outside of what a controller takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = process_equations(cl.load("averaging-tank").linear)
    >>> errors = {"concentration": 900.0, "volume": 0.4}
    >>> found = inverse_controller(equations, errors, 0.5, np.array([2.0, 2.0]))
    >>> found.values["concentration.largest_error"], found.setpoints
    (900.0, ('concentration', 'volume'))
    """
    point, (substeps, _) = equations.point, steps_in_a_sample(equations)
    correction = np.zeros((0, 0)) if by is None else by.correction
    law = _law(equations, substeps=substeps, observer=by.observer if by else None)
    values = numbers_at(
        point,
        law.parameters,
        largest_error=[largest_errors[name] for name in equations.outputs],
        observer_time=observer_time,
        fading_time=fading_times,
        correction=correction[correction != 0.0],
    )
    at = point.as_dict()
    state = numbers_at(
        point,
        law.state,
        expected=[at[name] for name in equations.outputs],
        estimate=[at[name] for name in by.observer.states] if by else [],
        was_in_force=1.0,
    )
    return controller_at(point, NAME, FAMILY, law, values, state)


def _invertible(model: LinearModel) -> ProcessEquations:
    """Return the equations of a process that has an inverse within a sample, or refuse it."""
    process = operating_point_of(model).process
    outputs, inputs = listed(model.outputs), listed(model.inputs)
    check_ranges(process, model.outputs, model.inputs)
    if len(model.outputs) != len(model.inputs):
        raise NotApplicable(
            f"it takes as many inputs as controlled outputs, and {inputs} move {outputs}"
        )
    if len(model.inputs) > MOST_INPUTS:
        raise NotApplicable(
            f"{len(model.inputs)} inputs have too many ways to share their limits; it takes at "
            f"most {MOST_INPUTS}"
        )
    if process.delayed or model.delays is not None:
        raise NotApplicable(
            "the process has dead time, and nothing brings an output to its setpoint before it is "
            "over"
        )
    refuse_feedthrough(model)
    try:
        degrees = linear_relative_degrees(model)
        late = [pair for pair in zip(model.outputs, degrees, strict=True) if pair[1] > 1]
        if late:
            name, degree = late[0]
            raise NotApplicable(
                f"{name} answers to the inputs only by its derivative of order {degree}, so that "
                "nothing brings it to its setpoint within a sample"
            )
        elimination_order(model.C @ model.B, model)
    except NotLinearisable as refusal:
        raise NotApplicable(
            f"{refusal.place} ({refusal.value}): it needs {refusal.expected}; {refusal.remedy}"
        ) from None
    internal = internal_dynamics(model)
    if not internal.stable:
        raise NotApplicable(internal.words)
    return process_equations(model)


def _all_shown(equations: ProcessEquations) -> bool:
    """Return whether sensors show every state that acts on the outputs."""
    return set(sensors_of_states(equations)) >= set(equations.states)


def _fading_times(model: LinearModel, period: float) -> np.ndarray:
    """Return for each output in what time a tenth of its range just uses up an input [s]."""
    point = operating_point_of(model)
    spans = np.array([point.process.signal(name).span for name in model.outputs])
    needed = np.abs(np.linalg.inv(model.C @ model.B)) * (DESIGN_STEP * spans)
    return np.maximum(np.max(needed.T / control_authorities(point, model.inputs), axis=1), period)


def _notes(
    model: LinearModel,
    equations: ProcessEquations,
    controller: Controller,
    by: FoundModelObserver | None,
) -> tuple[str, ...]:
    process = equations.point.process
    notes = [note_on_sensors(controller.measurements), internal_dynamics(model).words]
    if by is not None:
        notes.append(note_on_observer(by.observer))
    taken = {each.signal.name for each in equations.constants}
    loads = [d.name for d in process.disturbances if d.name in taken]
    loads = [name for name in loads if f"model.{name}" in controller.values]
    if loads:
        notes.append(f"Takes {listed(loads)} as constant; its observers make up for the rest.")
    return tuple(notes)
