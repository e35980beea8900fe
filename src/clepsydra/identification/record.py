"""Recorded signals, sampled regularly, and how they are read from a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clepsydra.base.arguments import require_signal
from clepsydra.base.csv_table import read_csv
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible, to_si
from clepsydra.base.words import time_text
from clepsydra.loop.noise import Noise
from clepsydra.loop.open_loop import Simulation
from clepsydra.process.process import Process

#: Fewer rows are no record.
FEWEST_ROWS = 30
#: A fit runs over each row thousands of times: of more, it takes many minutes.
MOST_ROWS = 100_000
#: Steps of time may differ from their mean by this share: clocks of loggers jitter.
_JITTER = 0.05
#: Units that the house counts in; of any other kind of quantity numbers stay as written.
_SI = ("m", "V", "1", "m^3/s", "A", "m^3", "m^2", "s", "kg/m^3", "mol/m^3", "K", "Pa", "kg/s")
_GAP = "fill the gap, or cut the record there: nothing is interpolated"


@dataclass(frozen=True, eq=False)
class Record:
    """Signals over time [SI], sampled regularly with a period [s]; at least 30 samples.

    An input is held from its sample to the next. `place` tells messages where it was read from.

    Examples
    --------
    >>> pump = Signal("pump", "V")
    >>> record = Record("by hand", (pump,), {"pump": np.arange(40.0)}, period=2.0)
    >>> record.samples, float(record.time[-1]), record.held_back
    (40, 78.0, 27)
    """

    place: str
    signals: tuple[Signal, ...]
    values: Mapping[str, np.ndarray]
    period: float
    start: float = 0.0

    def __post_init__(self) -> None:
        if self.samples < FEWEST_ROWS:
            raise InputError(
                self.place, f"{self.samples} samples",
                f"at least {FEWEST_ROWS}, of which the last third is held back to validate",
                "record for longer, or sample faster",
            )  # fmt: skip

    @property
    def samples(self) -> int:
        """How many."""
        return len(self.values[self.signals[0].name])

    @property
    def time(self) -> np.ndarray:
        """Time of each sample [s]."""
        return self.start + self.period * np.arange(self.samples)

    @property
    def held_back(self) -> int:
        """The first sample that no fit sees: the last third validates."""
        return -(-2 * self.samples // 3)

    def signal(self, name: str, place: str) -> Signal:
        """Return one of the signals; an unknown name is an InputError."""
        return require_signal(place, name, self.signals, f"a column of {self.place}")

    def column(self, name: str) -> str:
        """Return the place of a column, for messages."""
        return f"{self.place}, column '{name}'"

    def moving(self, name: str) -> np.ndarray:
        """Return the values of a signal that moves before the held-back third, or refuse it."""
        values = np.asarray(self.values[name], float)
        fitted = values[: self.held_back]
        if np.ptp(fitted) <= 1e-12 * np.max(np.abs(fitted)):
            raise InputError(
                self.column(name),
                f"{fitted[0]:g} in all of the first {self.held_back} rows",
                "a signal that moves in the first two thirds of the record, which are fitted",
                "record steps of the input in both directions, and some before they end",
            )
        return values


def sampling_period(time: np.ndarray, place_of: Callable[[int], str]) -> float:
    """Return the period of times that follow each other regularly [s].

    Times that stand or go back, missing rows, and steps that differ by more than 5 % are an
    InputError at the place of their row.

    Examples
    --------
    >>> sampling_period(np.array([0.0, 1.0, 2.0, 5.0, 6.0]), "run.csv, line {}".format)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: run.csv, line 3: got '3 s after the row before', expected a row each 1 s; fill in the missing rows, or cut the record at the gap.
    """  # noqa: E501
    steps = np.diff(time)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        place = place_of(int(back[0]) + 1)
        raise InputError(
            place, time_text(float(time[back[0] + 1]), 6), "a time after that of the row before",
            "sort the rows by time, with one row for each time",
        )  # fmt: skip
    usual = float(np.median(steps))
    # What was rounded when it was written moves each of two times by half a digit.
    wrong = np.flatnonzero(np.abs(steps - usual) > _JITTER * usual)
    if wrong.size:
        first = int(wrong[0])
        shown = f"{time_text(float(steps[first]), 4)} after the row before"
        gap = steps[first] > 1.5 * usual
        raise InputError(
            place_of(first + 1),
            shown,
            f"a row each {time_text(usual, 4)}",
            "fill in the missing rows, or cut the record at the gap"
            if gap
            else "sample regularly, or interpolate the record to a regular grid",
        )
    return float(time[-1] - time[0]) / len(steps)


def record_of(
    run: Simulation, noise: Mapping[str, float] | None = None, *, seed: int = 1
) -> Record:
    """Return the signals of a simulation as a record, with white noise on some.

    Parameters
    ----------
    run : Simulation
        Of at least 30 samples.
    noise : mapping, optional
        Signal to the standard deviation of its noise [SI].
    seed : int
        Of the noise, not negative.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.identification import identify_model
    >>> moves = {"1 min": "3.5 V", "8 min": "2.5 V", "14 min": "3.2 V"}
    >>> steps = [cl.step("pump_1", to=value, at=time) for time, value in moves.items()]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, steps, duration="20 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> found.best.name, round(found.best.estimates[0].value, 1)  # [V/V]
    ('FOPDT', 2.6)
    """
    values = dict(run.values)
    for name, deviation in (noise or {}).items():
        values[name] = values[name] + Noise(name, deviation, 0, len(run.time)).values(seed)
    period = run.process.sampling_period
    return Record(f"simulation of {run.process.name}", run.signals, values, period)


def read_record(path: str | Path, process: Process | None = None) -> Record:
    """Read a record from a CSV file.

    The head names time and signals with their units: ``time [s],pump_1 [V],level_1 [cm]``.
    Columns are separated by commas or semicolons; numbers have a decimal point. Rows follow each
    other regularly; an input is held from its row to the next.

    Parameters
    ----------
    path : str or Path
    process : Process, optional
        Whose signals have names and units of their own.

    Raises
    ------
    InputError
        The file cannot be read, a cell is empty or no number, a column appears twice or has no
        unit, time is irregular, or there are fewer than 30 rows or more than 100,000: line and
        column are named.

    Examples
    --------
    >>> import tempfile
    >>> rows = "".join(f"{k},{3 + k % 2},{12 + k}\\n" for k in range(40))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "tank.csv")
    ...     _ = path.write_text("time [min],pump [V],level [cm]\\n" + rows)
    ...     record = read_record(path)
    >>> record.period, record.signals[1].unit, float(record.values["level"][0])
    (60.0, 'm', 0.12)
    """
    file = Path(path)
    if file.suffix.lower() == ".parquet":
        raise InputError(str(file), Finding("a Parquet file"), "a CSV file", "write it as one")
    known = {}
    if process is not None:
        groups = (process.state, process.inputs, process.disturbances, process.measurements)
        known = {signal.name: signal for group in groups for signal in group}

    def signal_of(name: str, unit: str | None, head: str, number: int) -> Signal:
        if not name:
            raise InputError(
                f"{head}, column {number}", "", "a name", "name every column, as in pump_1 [V]"
            )
        signal, where = known.get(name), f"{head}, column '{name}'"
        if not unit and (signal is None or signal.unit != "1"):
            shown = signal.shown_unit if signal else "V"
            raise InputError(
                where, name, f"its unit in brackets, as in {name} [{shown}]",
                "write the unit of the numbers, [1] for a pure number",
            )  # fmt: skip
        return signal or _signal(name, unit or "1", where)

    table = read_csv(file, MOST_ROWS, _GAP, signal_of)
    if len(table.time) < 2:
        raise InputError(str(file), "1 row", "rows of numbers", "record for longer")
    period = sampling_period(table.time, table.place)
    values = {signal.name: table.values[:, at] for at, signal in enumerate(table.signals)}
    return Record(str(file), tuple(table.signals), values, period, float(table.time[0]))


def _signal(name: str, unit: str, place: str) -> Signal:
    """Return a signal that is known by its column only."""
    if unit == "1":
        return Signal(name)
    for si in _SI:
        if convertible(unit, si):
            return Signal(name, si, display_unit=unit)
    try:
        to_si(f"1 {unit}", unit, place)
    except InputError:
        raise InputError(
            place, unit, "a unit that is known", "write it as in [cm], [l/min] or [%]"
        ) from None
    return Signal(name, unit)
