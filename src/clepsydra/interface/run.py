"""Runs that draw themselves and know their scores."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.section import Line, Section
from clepsydra.base.units import from_si, unit_text
from clepsydra.base.words import listed, time_text
from clepsydra.interface.scores import Scores
from clepsydra.interface.shown import Answered
from clepsydra.loop import run as inner
from clepsydra.loop.alarm_times import AlarmTimes, alarm_times, alarms_as_dict
from clepsydra.loop.open_loop import Simulation
from clepsydra.studies.trial import scores_of

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from clepsydra.base.signal import Signal
    from clepsydra.loop.open_loop_plan import Plan
    from clepsydra.loop.profile import Change


#: An output that moves by less than this share of its range stands still.
_STILL = 1e-6


class _Drawn(Answered):
    def plot(self) -> Figure:
        """Draw everything that was recorded, as a Matplotlib figure."""
        from clepsydra.report.trends import plot

        return plot(self)  # type: ignore[arg-type]

    def save(self, path: str | Path) -> None:
        """Write the trajectories as .csv or .parquet; `cl.identify` reads the former."""
        from clepsydra.loop.trajectory_file import write_trajectories

        write_trajectories(self, Path(path))  # type: ignore[arg-type]


@dataclass(frozen=True, repr=False, eq=False)
class Run(_Drawn, inner.Run):
    """What a plant did under a controller: trajectories, scores, plot.

    Printed, it says what was simulated and how each controlled measurement did. Trajectories are in
    `values` [SI] by name, and in `to_pandas()` and `to_xarray()`.

    Parameters
    ----------
    changes : tuple of Change
        The events, if it had other ones than the default scenario.
    """

    changes: tuple[Change, ...] = field(default=(), kw_only=True)

    @cached_property
    def scores(self) -> Scores:
        """Every score of the run by its name, "iae[level_1]"; printed with units and words."""
        return Scores(scores_of(self), self.process, self.scenario.duration)

    @cached_property
    def alarms(self) -> tuple[AlarmTimes, ...]:
        """The alarms of the process: when each was there, how often, and for how long."""
        return alarm_times(self)

    def answer(self, *, every: bool = False) -> Section:
        """Return what was simulated, and the scores that say most, or every score."""
        from clepsydra.report.alarm_tables import alarms_of_run

        said = "; ".join(self._happened())
        noisy = [noise.signal for noise in self.scenario.noises if not noise.first]
        if noisy:
            said += f"; {listed(noisy)} from seed {self.scenario.seed}"
        head = (
            f"{self.controller.title} on {self.process.name}, {time_text(self.scenario.duration)}"
        )
        happened = (Line(f"{said}."),) if said else ()
        scores = self.scores.answer() if every else self.scores.short()
        return Section(head, (*self._begins(), *happened, *scores.parts, *alarms_of_run(self)))

    def as_dict(self) -> dict[str, Any]:
        """Return what was simulated and what came of it as values for JSON, in SI."""
        begin, scenario = self.scenario.begin, self.scenario
        return {
            "process": self.process.name,
            "controller": self.controller.name,
            "start": "at rest" if begin is None else begin.words,
            "duration": scenario.duration,
            "sampling_period": scenario.sampling_period,
            "samples": scenario.samples,
            "seed": scenario.seed,
            "noise": {noise.signal: noise.deviation for noise in scenario.noises},
            "segments": [asdict(segment) for segment in scenario.segments],
            "signals": extremes(self.signals, self.values, self.time),
            "scores": dict(self.scores),
            "substeps": self.substeps,
            "error_estimate": self.error_estimate,
            "final_state": dict(self.final_state),
            **alarms_as_dict(self),
        }

    def _begins(self) -> tuple[Line, ...]:
        """Say where it begins, if not at rest, and what its controller makes of that."""
        begin = self.scenario.begin
        if begin is None:
            return ()
        stay, move = [], []
        for name in self.controller.manipulated:
            stood, first = begin.inputs[name], float(self.values[name][0])
            if abs(first - stood) <= _STILL * max(self.process.signal(name).span, abs(stood)):
                stay.append(f"{name} begins at {self._shown(name, first)}")
            else:
                ends = f"{self._shown(name, stood)} to {self._shown(name, first)}"
                move.append(f"{name} goes from {ends} at once")
        way = begin.way_of(self.controller.initial_state, bump=bool(move))
        words = f"Begins {begin.words}; the controller starts {way}"
        return (Line(f"{words}: {', '.join(stay + move)}."),)

    def _happened(self) -> list[str]:
        """Return what happened, in words."""
        if not self.changes:
            return [
                f"{each.signal} by {self._shown(each.signal, each.size, '+')} at "
                f"{time_text(each.start)}"
                for each in self.scenario.segments
                if each.signal
            ]
        words = []
        for each in self.changes:
            over = f" over {time_text(each.stop - each.start)}" if each.is_ramp else ""
            if each.back is not None:
                over = f" for {time_text(each.back - each.start)}"
            value = self._shown(each.signal, each.value)
            words.append(f"{each.signal} to {value} at {time_text(each.start)}{over}")
        return words

    def _shown(self, name: str, value: float, sign: str = "") -> str:
        signal = self.process.signal(name)
        shown = from_si(value, signal.unit, signal.shown_unit)
        return f"{shown:{sign}.4g} {unit_text(signal.shown_unit)}".strip()


def extremes(
    signals: Iterable[Signal], values: Mapping[str, np.ndarray], time: np.ndarray
) -> dict[str, Any]:
    """Return where each signal starts and ends, and its smallest and largest value, in SI."""
    found = {}
    for signal in signals:
        column = values[signal.name]
        low, high = int(np.argmin(column)), int(np.argmax(column))
        found[signal.name] = {
            "unit": signal.unit,
            "start": float(column[0]),
            "end": float(column[-1]),
            "smallest": {"value": float(column[low]), "time": float(time[low])},
            "largest": {"value": float(column[high]), "time": float(time[high])},
        }
    return found


@dataclass(frozen=True, repr=False, eq=False)
class OpenLoopRun(_Drawn, Simulation):
    """What a plant did without a controller: trajectories, events, balances, plot.

    Parameters
    ----------
    plan : Plan
        What was to happen.
    """

    plan: Plan = field(kw_only=True)

    @cached_property
    def alarms(self) -> tuple[AlarmTimes, ...]:
        """The alarms of the process: when each was there, how often, and for how long."""
        return alarm_times(self)

    def to_xarray(self) -> xarray.Dataset:
        """Return a dataset over time [s]; each variable carries its unit and description."""
        return inner.dataset(self.signals, self.values, self.time, {"process": self.process.name})

    def answer(self, *, every: bool = False) -> Section:
        """Return what it did and how sure that is, or every signal and balance."""
        from clepsydra.report.simulation_page import simulation_answer

        return simulation_answer(self.plan, self, every=every)

    def report(self, path: str | Path) -> None:
        """Write the simulation as one HTML file."""
        from clepsydra.report.page import write_page
        from clepsydra.report.simulation_page import simulation_text

        write_page(simulation_text(self.plan, self), path)

    def as_dict(self) -> dict[str, Any]:
        """Return plan and result as values for JSON, in SI."""
        plan, process = self.plan, self.process
        return {
            "process": process.name,
            "start": plan.begins,
            "duration": plan.duration,
            "sampling_period": process.sampling_period,
            "samples": plan.samples,
            "changes": [
                {
                    "signal": change.signal,
                    "value": change.value,
                    "unit": process.signal(change.signal).unit,
                    "start": change.start,
                    "stop": change.stop,
                    **({} if change.back is None else {"back": change.back}),
                }
                for change in plan.changes
            ],
            "signals": extremes(self.signals, self.values, self.time),
            "events": [asdict(event) for event in self.events],
            "balances": [{**asdict(each), "error": each.error} for each in self.balances],
            "ended": self.end and {"time": self.end.time, "event": self.end.event},
            "substeps": self.substeps,
            "error_estimate": self.error_estimate,
            "warnings": list(plan.point.warnings),
            **alarms_as_dict(self),
        }
