"""A found input under our own kernel, open loop: what it truly costs, as a run is scored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.engine.many_points import at_many_points
from clepsydra.limits.course import Course
from clepsydra.limits.event import Event
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.open_loop import simulate
from clepsydra.loop.step_size import substeps_for
from clepsydra.optimal_control.plant_model import PlantModel
from clepsydra.scores.iae import IAE


@dataclass(frozen=True, eq=False)
class Replayed:
    """What the engine makes of an input.

    Parameters
    ----------
    time : ndarray [samples + 1]
        From the event on to the end of its segment [s].
    values : dict
        Signal to trajectory [samples + 1], SI: states, true measurements, inputs.
    errors : dict
        Output to the integral of its absolute error [its unit s].
    index : float
        Their sum, each over its step [s].
    """

    time: np.ndarray
    values: dict[str, np.ndarray]
    errors: dict[str, float]
    index: float


def replay(event: Event, model: PlantModel, course: Course, linear: LinearModel) -> Replayed:
    """Run the found input through the kernel of all simulations.

    Parameters
    ----------
    event : Event
    model : PlantModel
        Of the event.
    course : Course
    linear : LinearModel
        Of the process, which says how long an integration step is.
    """
    samples = course.grid.samples
    process = event.process
    given = model.inputs_from(course.input_samples(samples))
    profiles = {u.name: row for u, row in zip(process.inputs, given, strict=True)}
    loads = event.held(event.disturbances, samples)
    profiles |= {d.name: row for d, row in zip(process.disturbances, loads.T, strict=True)}
    run = simulate(event.start, profiles, substeps=substeps_for(linear))
    states = np.array([run.values[x.name] for x in process.state])
    read = at_many_points(process.measure, [states, process.parameter_values])
    true = {y.name: row for y, row in zip(process.measurements, read, strict=True)}
    errors = errors_of(event, run.time, true)
    index = sum(errors[name] / size for name, size in event.sizes)
    kept = [signal.name for signal in (*process.state, *process.inputs)]
    values = {name: run.values[name] for name in kept} | true
    within = slice(event.samples + 1)
    shown = {name: np.array(column[within]) for name, column in values.items()}
    return Replayed(run.time[within], shown, errors, index)


def errors_of(event: Event, time: np.ndarray, true: dict[str, np.ndarray]) -> dict[str, float]:
    """Return the integral of the absolute error of each output, by the score of that name."""
    held = event.held(event.setpoints, len(time))
    return {
        name: IAE.along(time, held[:, column], true[name])
        for column, name in enumerate(event.outputs)
    }
