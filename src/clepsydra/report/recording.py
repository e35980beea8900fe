"""What trend pictures show of a run, be it of a loop or of a process on its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from clepsydra.loop.events import events_of
from clepsydra.loop.inner_setpoints import InnerSetpoint, inner_setpoints
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.process.process import Process
from clepsydra.report.event_marks import EventMark, event_marks
from clepsydra.scores.plant_flows import forced_flows


@dataclass(frozen=True, eq=False)
class Recording:
    """Trajectories with what happened beside them.

    Parameters
    ----------
    process : Process
    time : ndarray [samples]
        [s]
    end : float
        Of the last sample [s].
    values : mapping
        Name to trajectory [samples] in SI.
    controlled : tuple of str
        Measurements with a setpoint.
    noise : mapping
        Measurement to its noise [samples], where it has some.
    segments : tuple of Segment
        Of the scenario.
    marks : tuple of EventMark
        Of the events, in order of time.
    inner : tuple of InnerSetpoint
        What outer loops ask of inner ones.
    limits : mapping
        Input to the limits that hold it [SI], where they may be narrower than its range.

    Examples
    --------
    >>> import clepsydra as cl
    >>> recording_of(cl.simulate(cl.load("quadruple-tank"), duration="60 s")).end
    60.0
    """

    process: Process
    time: np.ndarray
    end: float
    values: Mapping[str, np.ndarray]
    controlled: tuple[str, ...] = ()
    noise: Mapping[str, np.ndarray] = field(default_factory=dict)
    segments: tuple[Segment, ...] = ()
    marks: tuple[EventMark, ...] = ()
    inner: tuple[InnerSetpoint, ...] = ()
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def recorded_inner_setpoints(run: Run) -> tuple[InnerSetpoint, ...]:
    """Return the inner setpoints of a run's controller that the run has.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> recorded_inner_setpoints(run)  # no cascade
    ()
    """
    found = inner_setpoints(run.controller, run.process)
    return tuple(each for each in found if each.name in run.values)


def recording_of(run: Run | Simulation) -> Recording:
    """Return what a picture shows of a run or of a simulation.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> recording_of(cl.simulate(plant, cl.design.simc(plant), duration="1 min")).controlled
    ('level_1', 'level_2')
    """
    process = run.process
    if isinstance(run, Simulation):
        marks = event_marks(run.events)
        return Recording(process, run.time, float(run.time[-1]), run.values, marks=marks)
    scenario = run.scenario
    columns = zip(process.measurements, scenario.noise.T, strict=True)
    recorded = all(event.counted in run.values for event in process.motion.events)
    return Recording(
        process,
        run.time,
        float(run.time[-1]) + scenario.sampling_period,
        # What a controller asks of a forced flow is its command; a picture shows what flows.
        {**run.values, **forced_flows(process, run.time, run.values)},
        process.controlled,
        {signal.name: column for signal, column in columns if np.any(column)},
        scenario.segments,
        event_marks(events_of(process, run.values)) if recorded else (),
        recorded_inner_setpoints(run),
        {signal.name: run.limits(signal.name) for signal in process.inputs},
    )
