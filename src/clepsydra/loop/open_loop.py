"""A process on its own: its motion under inputs that are given as profiles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.engine.kernel import Kernel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.alarms import LoopAlarms, alarm_signals, without_controller
from clepsydra.loop.events import Occurrence, events_of
from clepsydra.loop.motion_block import (
    MotionBlock,
    motion_at_rest,
    recorded_signals,
    steps_told,
)
from clepsydra.loop.process_period import process_period
from clepsydra.loop.reference_motion import ReferenceMotion
from clepsydra.loop.reported_readings import reporting_at
from clepsydra.loop.shown_levels import shown_levels
from clepsydra.loop.step_size import Solver
from clepsydra.loop.stepped_alarms import SteppedAlarms
from clepsydra.loop.told_readings import ToldReadings
from clepsydra.process.balance import DELAYED, ENTERED, LEFT
from clepsydra.process.process import Process
from clepsydra.scores.plant_flows import forced_flows

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Balance:
    """Conservation of the liquid or of a component over a run.

    Parameters
    ----------
    name : str
        "liquid" or a component.
    unit : str
        SI unit of the amounts.
    entered, left, gained : float
        Through the boundary of the plant, and more in its tanks and delays than at first.
    """

    name: str
    unit: str
    entered: float
    left: float
    gained: float

    @property
    def error(self) -> float:
        """What does not close, relative to the throughput [1]."""
        missing = self.entered - self.left - self.gained
        throughput = max(abs(self.entered), abs(self.left), abs(self.gained))
        return abs(missing) / throughput if throughput else 0.0


@dataclass(frozen=True)
class Simulation:
    """What a process did under given inputs.

    Parameters
    ----------
    process : Process
    time : ndarray [samples + 1]
        Start of each sample, and the end [s]; fewer where the run ended before its time.
    signals : tuple of Signal
        One for each trajectory.
    values : dict
        Name to trajectory [samples + 1] in SI: states, measurements (without noise), inputs,
        disturbances (held during a sample), volumes spilt, memories of switches, alarms.
    events : tuple of Occurrence
        Events in order of time.
    balances : tuple of Balance
        Of the liquid and of each component.
    substeps : int
        Integration steps in a sampling period; 0 for the reference solver.
    error_estimate : float or None
        Of the error of the integration, as a fraction of the state's range.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> run = simulate(point, {"pump_1": np.full(600, 3.2)}, substeps=1)
    >>> round(100 * float(run.values["tank_1.level"][-1]), 3), run.balances[0].error < 1e-12
    (13.323, True)
    """

    process: Process
    time: np.ndarray
    signals: tuple[Signal, ...]
    values: dict[str, np.ndarray]
    events: tuple[Occurrence, ...]
    balances: tuple[Balance, ...]
    substeps: int
    error_estimate: float | None = None

    @property
    def samples(self) -> int:
        """How many sampling periods it lasted."""
        return len(self.time) - 1

    @property
    def end(self) -> Occurrence | None:
        """What ended the run before its time; None where nothing did."""
        ending = {event.name for event in self.process.motion.events if event.ends}
        return next((each for each in self.events if each.event in ending), None)

    def until_end(self) -> Simulation:
        """Return the run without what comes after its end, where all that is known stands still."""
        if self.end is None:
            return self
        kept = int(np.searchsorted(self.time, self.end.time)) + 1
        values = {name: column[:kept] for name, column in self.values.items()}
        return replace(self, time=self.time[:kept], values=values)

    def to_pandas(self) -> pandas.DataFrame:
        """Return a table with one row a sample, indexed by time [s], one column a signal."""
        import pandas

        return pandas.DataFrame(self.values, index=pandas.Index(self.time, name="time"))


def simulate(
    point: OperatingPoint,
    profiles: Mapping[str, np.ndarray],
    *,
    substeps: int,
    state: Mapping[str, float] | None = None,
    solver: Solver = "kernel",
) -> Simulation:
    """Simulate a process whose inputs and disturbances follow profiles.

    Parameters
    ----------
    point : OperatingPoint
        Where it starts, and where signals without a profile stay.
    profiles : mapping
        Input or disturbance to its values [samples], all of one length, SI; held over a sample.
    substeps : int
        Integration steps in a sampling period, see `clepsydra.loop.step_size.substeps_for`.
    state : mapping, optional
        States that do not start at the point, "tank_1.level" to its value.
    solver : {"kernel", "reference"}
    """
    run = _OpenLoop(point, profiles, state or {})
    return run.by_reference(substeps) if solver == "reference" else run.by_kernel(substeps)


def simulations(
    point: OperatingPoint, profiles: Mapping[str, np.ndarray], state: Mapping[str, float]
) -> Callable[[int], Simulation]:
    """Return steps in a sampling period → what `simulate` returns, by one kernel where it can.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> runs = simulations(point, {"pump_1": np.full(600, 3.2)}, {})
    >>> round(100 * float(runs(1).values["tank_1.level"][-1]), 3), runs(2).substeps
    (13.323, 2)
    """
    run = _OpenLoop(point, profiles, state)
    if point.process.motion.delays:
        return run.by_kernel
    kernel = run.kernel(1, adjustable=True)
    return lambda substeps: run.moved(kernel, substeps, steps_told(run.period, [substeps]))


def state_from(point: OperatingPoint, state: Mapping[str, float]) -> np.ndarray:
    """Return the state of a point [n] but for what is given by name [SI]."""
    signals = zip(point.process.state, point.state, strict=True)
    return np.array([state.get(signal.name, value) for signal, value in signals], float)


class _OpenLoop:
    def __init__(
        self,
        point: OperatingPoint,
        profiles: Mapping[str, np.ndarray],
        state: Mapping[str, float],
    ) -> None:
        self.point, self.process = point, point.process
        process = self.process
        self.outside = (*process.inputs, *process.disturbances)
        self.samples = len(next(iter(profiles.values())))
        at = point.as_dict()
        self.profiles = {
            signal.name: np.asarray(
                profiles.get(signal.name, np.full(self.samples, at[signal.name])), float
            )
            for signal in self.outside
        }
        self.period = process.sampling_period
        self.totals = tuple(signal.name for signal in process.motion.totals)
        start = state_from(point, state)
        self.contents = np.array(
            process.motion.to_contents(start, process.parameter_values)
        ).ravel()

    def kernel(self, substeps: int, *, adjustable: bool = False) -> Kernel:
        process = self.process
        motion = MotionBlock(
            process.motion, self.period, substeps, self.totals, adjustable=adjustable
        )
        states = {signal.name for signal in process.state}
        recorded = tuple(s for s in motion.state if s.name not in states)
        alarms = LoopAlarms(process) if process.alarms else None
        return Kernel(process_period(process, motion, recorded, shown="start", alarms=alarms))

    def _reporting(self) -> dict[str, float]:
        """Return what the sensors have to tell where they have shown the start for ever."""
        process, values = self.process, self.process.parameter_values
        shown = np.array(process.show(process.motion.to_state(self.contents, values), values))
        names = (y.name for y in process.measurements)
        return reporting_at(process, dict(zip(names, shown.ravel().tolist(), strict=True)))

    def by_kernel(self, substeps: int) -> Simulation:
        return self.moved(self.kernel(substeps), substeps, {})

    def moved(self, kernel: Kernel, substeps: int, told: Mapping[str, np.ndarray]) -> Simulation:
        """Return the run by a kernel that is told about its steps, or knows them."""
        contents = {
            s.name: float(v)
            for s, v in zip(self.process.motion.contents, self.contents, strict=True)
        }
        result = kernel.run(
            self.samples + 1,
            inputs={name: np.append(values, values[-1]) for name, values in self.profiles.items()},
            state=motion_at_rest(self.point) | contents | self._reporting(),
            parameters=told,
            turns=substeps,
        )
        values = {s.name: result.output(s.name)[0] for s in kernel.program.outputs}
        return self._collect(values, substeps)

    def by_reference(self, substeps: int) -> Simulation:
        process = self.process
        start = dict(zip((s.name for s in process.motion.contents), self.contents, strict=True))
        motion = ReferenceMotion(self.point, substeps, self.totals, start=start)
        shown = self._shown(motion)
        sensors = ToldReadings(process, shown)
        alarms, missing = SteppedAlarms(process), without_controller(process)
        rows = []
        for sample in range(self.samples + 1):
            state = motion.state()
            shown = self._shown(motion)
            measured = sensors.told(shown)
            now = {
                name: float(profile[min(sample, self.samples - 1)])
                for name, profile in self.profiles.items()
            }
            now |= {s.name: v for s, v in zip(process.state, state, strict=True)}
            now |= {s.name: v for s, v in zip(process.measurements, measured, strict=True)}
            now |= motion.recorded()
            now |= alarms.look(now | missing)
            alarms.moved(now)
            rows.append(now)
            if sample < self.samples:
                groups = (process.inputs, process.disturbances)
                motion.advance(*(np.array([now[s.name] for s in group]) for group in groups))
                sensors.advance(shown)
        values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        return self._collect(values, 0)

    def _shown(self, motion: ReferenceMotion) -> np.ndarray:
        return np.array(self.process.show(motion.state(), self.process.parameter_values)).ravel()

    def _collect(self, values: dict[str, np.ndarray], substeps: int) -> Simulation:
        process, motion = self.process, self.process.motion
        for name, profile in self.profiles.items():
            # An alarm may have held it elsewhere.
            values.setdefault(name, np.append(profile, profile[-1]))
        time = process.sampling_period * np.arange(self.samples + 1, dtype=float)
        values |= forced_flows(process, time, values)
        # Not from the last states: an emptied tank holds what was dissolved, which its volume
        # of nothing times a concentration does not give back.
        last = np.array([values[s.name][-1] for s in motion.contents])
        signals = (
            *process.state,
            *process.measurements,
            *self.outside,
            *recorded_signals(process),
            *alarm_signals(process),
        )
        totals = {s.name: float(values[s.name][-1]) for s in motion.totals}
        shown = values | shown_levels(process, values)
        return Simulation(
            process=process,
            time=time,
            signals=signals,
            values={s.name: shown[s.name] for s in signals},
            events=events_of(process, values),
            balances=_balances(process, self.contents, last, totals),
            substeps=substeps,
        )


def _balances(
    process: Process, first: np.ndarray, last: np.ndarray, totals: Mapping[str, float]
) -> tuple[Balance, ...]:
    """Return the balances of a run from its first and last contents and its totals from 0."""
    motion, parameters = process.motion, process.parameter_values
    units = {signal.name: signal.unit for signal in motion.totals}
    before, after = (np.array(motion.stored(c, parameters)).ravel() for c in (first, last))
    return tuple(
        Balance(
            name,
            units[f"{ENTERED}.{name}"],
            float(totals[f"{ENTERED}.{name}"]),
            float(totals[f"{LEFT}.{name}"]),
            float(after[place] - before[place]) + totals.get(f"{DELAYED}.{name}", 0.0),
        )
        for place, name in enumerate(motion.stored_names)
    )
