"""The course of a signal after a step, along a ramp, or by a recorded profile."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.loop.profile import samples_before
from clepsydra.loop.profile_csv import read_profile_of
from clepsydra.process.averaging import within_band
from clepsydra.process.process import Process
from clepsydra.process.signal_values import check_in_range, read_value
from clepsydra.process.table_reader import TableReader


class Course(NamedTuple):
    """What a signal does from a sample on.

    Parameters
    ----------
    values : ndarray [samples]
        Until the next step of any signal [SI].
    settled : int
        From which of them on it stays where it is.
    size : float
        Its change, of a pulse that before it goes back; of a profile, where it is farthest from
        before [SI].
    """

    values: np.ndarray
    settled: int
    size: float


@dataclass(frozen=True)
class CourseRow:
    """One row of a scenario, of which the course of its signal is read.

    Parameters
    ----------
    table : TableReader
    kind : {"setpoint", "load"}
    signal : Signal
    process : Process
    folder : Path
        Where the path of a profile begins.
    """

    table: TableReader
    kind: Literal["setpoint", "load"]
    signal: Signal
    process: Process
    folder: Path

    def course(self, before: float, samples: int) -> Course:
        """Return the course.

        Parameters
        ----------
        before : float
            The value until then [SI].
        samples : int
            Until the next step of any signal.

        Raises
        ------
        InputError
            Not one of `to`, `by` and `profile` is given, the signal leaves its range or does not
            change, or a ramp, a pulse or a profile takes longer than that.
        """
        table = self.table
        given = [key for key in ("to", "by", "profile") if table.has(key)]
        if len(given) != 1:
            raise table.refused(
                "by" if "by" in given else "to",
                f"both {' and '.join(given)}" if given else "neither to nor by",
                "one of the two: the value after the step, or the size of the step; or a profile",
                'write as in to = "60 %" or by = "10 %"',
            )
        if given == ["profile"]:
            return self._profile(before, samples)
        value = self._value(given[0], before)
        values, ramp = np.full(samples, value), 0
        if table.has("lasts"):
            table.refuse(("over",), "no such key beside a pulse", "remove one of the two")
            return self._pulse(value, before, samples)
        if table.has("over"):
            remedy = "say how long the ramp takes, or leave it out"
            over = table.quantity("over", "s", "a time", remedy, above=0.0)
            ramp = samples_before(over, self.process.sampling_period)
            self._check_ends("over", ramp, samples)
            share = np.arange(ramp) / ramp
            # Written so that it ends on its value exactly.
            values[:ramp] = (1.0 - share) * before + share * value
        return Course(values, ramp, value - before)

    def _pulse(self, value: float, before: float, samples: int) -> Course:
        """Return a value that goes back to the one before after a time."""
        table, period = self.table, self.process.sampling_period
        if self.kind == "setpoint":
            raise table.wrong("lasts", "a load", "write the way back of a setpoint as a step too")
        remedy = "say how long it lasts, or leave it out"
        lasts = table.quantity("lasts", "s", "a time", remedy, at_least=period)
        back = samples_before(lasts, period)
        self._check_ends("lasts", back, samples)
        values = np.full(samples, before)
        values[:back] = value
        return Course(values, back, value - before)

    def _profile(self, before: float, samples: int) -> Course:
        """Return a recorded course, in which each value is held until the next one."""
        table = self.table
        table.refuse(("over", "lasts"), "no such key beside a profile", "remove one of the two")
        remedy = 'write as in profile = "inflow.csv"'
        path = self.folder / table.text("profile", "the path of a CSV file", remedy)
        values, settled = np.full(samples, before), 0
        for change in read_profile_of(path, self.signal):
            settled = samples_before(change.start, self.process.sampling_period)
            self._check_ends("profile", settled, samples)
            self._check_inside("profile", change.value)
            values[settled:] = change.value
        farthest = values[np.argmax(np.abs(values - before))]
        if farthest == before:
            raise table.wrong("profile", f"a change of {self.signal.name}", "leave it out")
        return Course(values, settled, float(farthest) - before)

    def _value(self, key: str, before: float) -> float:
        """Return the value after a step [SI]."""
        table, signal = self.table, self.signal
        if key == "to":
            value = read_value(table, key, signal, "a value", "give the value after the step")
        else:
            remedy = "give the size of the step"
            value = before + read_value(table, key, signal, "a change", remedy, change=True)
        self._check_inside(key, value)
        if value == before:
            raise table.wrong(key, f"a change of {signal.name}", "let it step, or leave it out")
        return value

    def _check_ends(self, key: str, settled: int, samples: int) -> None:
        """Refuse what has not ended when the next step comes, or the end."""
        if settled >= samples:
            later = time_text(samples * self.process.sampling_period, 4)
            raise self.table.wrong(
                key,
                f"an end before the next step, or the end of the scenario, {later} later",
                "shorten it, or let what follows be later",
            )

    def _check_inside(self, key: str, value: float) -> None:
        """Refuse a value outside the range of its signal, or the band of a level."""
        table, signal = self.table, self.signal
        what = "a setpoint" if self.kind == "setpoint" else "a load"
        check_in_range(table, key, signal, value, what)
        band = self.process.bands.get(signal.name, (value, value))
        if not band[0] <= value <= band[1]:
            raise table.refused(key, table.written(key), *within_band(signal, band))
