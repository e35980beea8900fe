"""What trend pictures show of a run, be it of a loop or of a process on its own."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.loop.events import Occurrence, events_of
from clepsydra.loop.inner_setpoints import InnerSetpoint, inner_setpoints
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.process.averaging import averaged_flows
from clepsydra.process.process import Process
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
    noise: Mapping[str, np.ndarray] = field(default_factory=dict)
    segments: tuple[Segment, ...] = ()
    marks: tuple[EventMark, ...] = ()
    inner: tuple[InnerSetpoint, ...] = ()
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def recorded_inner_setpoints(run: Run) -> tuple[InnerSetpoint, ...]:
    """Return the inner setpoints of a run's controller that the run has."""
    found = inner_setpoints(run.controller, run.process)
    return tuple(each for each in found if each.name in run.values)


def recording_of(run: Run | Simulation) -> Recording:
    """Return what a picture shows of a run or of a simulation."""
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
        {signal.name: column for signal, column in columns if np.any(column)},
        scenario.segments,
        event_marks(events_of(process, run.values)) if recorded else (),
        recorded_inner_setpoints(run),
        {signal.name: run.limits(signal.name) for signal in process.inputs},
    )


#: An event that happens more often than this is one mark; else each time is one.
_APART = 5


@dataclass(frozen=True)
class EventMark:
    """An event, or all of its times together.

    Parameters
    ----------
    time : float
        The first time [s].
    words : str
    times : int
        How often in all.
    last : float
        The last time [s].

    Examples
    --------
    >>> EventMark(12.0, "pump_1 trips: tank_3 above 27.5 cm", 289, 8000.0).sentence
    'pump_1 trips: tank_3 above 27.5 cm (289 times, the last at 133.3 min)'
    """

    time: float
    words: str
    times: int
    last: float

    @property
    def sentence(self) -> str:
        """What happens, and how often where that is more than once."""
        if self.times == 1:
            return self.words
        last = "" if self.last == self.time else f", the last at {time_text(self.last, 4)}"
        return f"{self.words} ({self.times} times{last})"

    def label(self, number: int) -> str:
        """Return its number, with the count where it stands for several."""
        return str(number) if self.times == 1 else f"{number} (×{self.times})"


def event_marks(events: Sequence[Occurrence]) -> tuple[EventMark, ...]:
    """Return the marks of what happened, in order of their first time.

    Examples
    --------
    >>> often = [Occurrence(float(t), "p.trips", "p trips", 1) for t in range(10, 299)]
    >>> (mark,) = event_marks(often)
    >>> mark.time, mark.times, mark.last
    (10.0, 289, 298.0)
    >>> len(event_marks(often[:3]))
    3
    """
    by_event: defaultdict[str, list[Occurrence]] = defaultdict(list)
    for event in events:
        by_event[event.event].append(event)
    marks = [
        EventMark(group[0].time, group[0].words, sum(each.times for each in group), group[-1].time)
        for every in by_event.values()
        for group in ([every] if len(every) > _APART else [[each] for each in every])
    ]
    return tuple(sorted(marks, key=lambda mark: mark.time))


@dataclass(frozen=True)
class Panel:
    """One panel: which signal it shows and how tall it is.

    Parameters
    ----------
    kind : {"level", "state", "input", "disturbance", "total"}
        "state" for a state that is no level.
    signal : Signal
    height : float
        [inch]
    measurement : str
        The sensor that shows a level, empty for none.
    controlled : bool
    beside : tuple of Signal
        In the same unit, to compare with: what arrives in a tank beside what leaves it.
    """

    kind: str
    signal: Signal
    height: float
    measurement: str = ""
    controlled: bool = False
    beside: tuple[Signal, ...] = ()


def controlled_panels(run: Run) -> list[Panel]:
    """Return one panel for each state that follows a setpoint.

    Before a level that averages comes what leaves its tank, which is to be smooth.
    """
    process = run.process
    shown = []
    for name in process.controlled:
        shown += _outflows(process, name) if name in process.averaging else []
        signal = process.signal(process.measured_state[name])
        shown.append(Panel(_kind(signal), signal, 1.3, name, True))
    return shown


def _outflows(process: Process, name: str) -> list[Panel]:
    """Return the panels of what moves the outflow of an averaging level, beside what arrives."""
    leaving, arriving = (
        [process.signal(each) for each in names] for names in averaged_flows(process, name)
    )
    return [
        Panel("input", signal, 1.3, beside=tuple(d for d in arriving if d.unit == signal.unit))
        for signal in leaving
    ]


def all_panels(run: Run | Simulation) -> list[Panel]:
    """Return the panels of a whole run: states, manipulated variables, disturbances that act.

    Volumes spilt are shown where something was spilt. What an inner loop measures has a panel
    too; the state of its sensor, where that has a lag, gives way to it.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> [panel.signal.name for panel in all_panels(run)][2:6]
    ['tank_3.level', 'tank_4.level', 'pump_1', 'pump_2']
    """
    process = run.process
    sensors = {state: name for name, state in reversed(process.measured_state.items())}
    controlled = [] if isinstance(run, Simulation) else controlled_panels(run)
    shown = {panel.signal.name for panel in controlled}
    height = 0.72 if controlled else 0.95
    others = [
        Panel(_kind(signal), signal, height, sensors.get(signal.name, ""))
        for signal in process.state
        if signal.name not in shown
    ]
    inner = [] if isinstance(run, Simulation) else recorded_inner_setpoints(run)
    for name in dict.fromkeys(each.measurement for each in inner):
        others = [panel for panel in others if panel.signal.name != f"{name}.lagged"]
        if all(panel.measurement != name for panel in (*controlled, *others)):
            others.append(Panel("state", process.signal(name), 0.85))
    inputs = [Panel("input", u, 0.85) for u in process.inputs if u.name not in shown]
    disturbances = [
        Panel("disturbance", signal, 0.45)
        for signal in process.disturbances
        if np.ptp(run.values[signal.name]) > 0.0
        and not any(signal in panel.beside for panel in controlled)
    ]
    totals = [
        Panel("total", signal, 0.45)
        for signal in process.motion.totals
        if signal.name in run.values and np.ptp(run.values[signal.name]) > 0.0
    ]
    return [*controlled, *others, *inputs, *disturbances, *totals]


def _kind(signal: Signal) -> str:
    return "level" if signal.name.endswith(".level") else "state"
