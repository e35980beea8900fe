"""A case of hardware in the loop: what happens to a loop on its wires, and how it takes it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.base.registry import Registry
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.plant_shell.status import SHELL_STATUS_BITS
from clepsydra.hil.commands import Command
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.scan_log import ScanLog
from clepsydra.loop.faults import APPLIED
from clepsydra.process.process import Process
from clepsydra.rig.instructor import Instructor
from clepsydra.rig.tag import ACKNOWLEDGE, HEARD
from clepsydra.rig.tag_table import TagTable


@dataclass(frozen=True)
class Hands:
    """All that may be done to a loop on its wires.

    Parameters
    ----------
    table : TagTable
        Of the rig.
    instructor : Instructor
    command : callable
        Lets something be done to the PLC.
    """

    table: TagTable
    instructor: Instructor
    command: Callable[[Command], None]

    def operate(self, name: str, value: float) -> None:
        """Give a tag of the operator a value, in its unit."""
        self.table.write(self.table.tags[name], value)

    def press(self, is_pressed: bool) -> None:
        """Press the button that acknowledges, or let it go."""
        self.operate(ACKNOWLEDGE, float(is_pressed))


@dataclass(frozen=True)
class Subject:
    """The loop that the cases are about, and what it is to meet.

    Parameters
    ----------
    process : Process
    level : Signal
        The first that is controlled.
    pump : Signal
        The first that is moved.
    fail_safe : mapping
        Input to where it goes after a fault [SI].
    period : float
        Of the plant by a real clock [s].
    silence : int
        After so many samples without a sign of life the controller is silent for the rig.
    sensor_delay : float
        For so long a fault of a sensor is ridden through [s].
    """

    process: Process
    level: Signal
    pump: Signal
    fail_safe: Mapping[str, float]
    period: float
    silence: int
    sensor_delay: float

    @property
    def ridden(self) -> int:
        """Scans for which a fault of a sensor is ridden through."""
        return int(np.ceil(self.sensor_delay / self.process.sampling_period))


@dataclass(frozen=True)
class Episode:
    """What came of a case in its samples.

    Parameters
    ----------
    subject : Subject
    rows : PlantRows
        Of the whole run.
    log : ScanLog
        Of the whole run.
    first, last : int
        The samples of the case: from the one to before the other.
    """

    subject: Subject
    rows: PlantRows
    log: ScanLog
    first: int
    last: int

    def column(self, name: str) -> np.ndarray:
        """Return what the plant told, or was given, in the samples of the case [SI]."""
        return self.rows.column(name)[self.first : self.last]

    def scans(self, output: str) -> np.ndarray:
        """Return an output of the controller in the scans of the case, in its unit."""
        sample = self.log.column("sample")
        return self.log.found()[output][(sample >= self.first) & (sample < self.last)]

    def applied(self, signal: Signal) -> np.ndarray:
        """Return where the plant had an input [SI]."""
        return self.column(path(signal, APPLIED))

    def told(self, bit: str) -> np.ndarray:
        """Return in which scans any output told a condition, see `SHELL_STATUS_BITS`."""
        word = SHELL_STATUS_BITS[bit].value
        found = [
            (self.scans(name).astype(int) & word) != 0
            for name in self.log.outputs
            if Signal(name).part == "status"
        ]
        return np.any(found, axis=0)

    @property
    def heard(self) -> np.ndarray:
        """In which samples the rig heard the controller."""
        return self.column(HEARD) != 0.0

    @property
    def all_safe(self) -> np.ndarray:
        """In which samples every output of the plant stood at its fail-safe value."""
        subject = self.subject
        found = [self.applied(u) == subject.fail_safe[u.name] for u in subject.process.inputs]
        return np.all(found, axis=0)

    @property
    def some_safe(self) -> np.ndarray:
        """In which samples an output of the plant stood at its fail-safe value."""
        subject = self.subject
        found = [self.applied(u) == subject.fail_safe[u.name] for u in subject.process.inputs]
        return np.any(found, axis=0)


@dataclass(frozen=True)
class Verdict:
    """Whether a loop took a case as it has to, and what it did.

    Parameters
    ----------
    holds : bool
    words : str
    """

    holds: bool
    words: str


Act = Callable[[Hands], None]


@dataclass(frozen=True)
class Case:
    """A case.

    Parameters
    ----------
    place : int
        Among the others: what leaves nothing behind comes first.
    title : str
    is_ideal : bool
        Whether a simulation in which every scan is in time can be compared.
    acts : callable
        Subject to what is done at which sample of the case.
    samples : callable
        Subject to how many samples it lasts.
    judge : callable
    """

    place: int
    title: str
    is_ideal: bool
    acts: Callable[[Subject], Mapping[int, Act]]
    samples: Callable[[Subject], int]
    judge: Callable[[Episode], Verdict]


CASES: Registry[Case] = Registry("clepsydra.hil.cases", order=lambda case: case.place)
