"""The process in which the plant of a rig runs, in real time."""

from __future__ import annotations

import gc
import os
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from clepsydra.rig.deadlines import Deadlines
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.plant import PlantSettings, RigPlant
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag import HEARTBEAT
from clepsydra.rig.tag_table import WRITES

#: The clock of the machine was set where it differs from the plant's by more [s].
_CLOCK_SET = 1.0
#: Reports of lateness are at least so far apart [s].
_BETWEEN = 10.0
#: Of the process, where the user may raise it: of the least urgent in real time, and else "nice".
_REAL_TIME, _NICE = 1, -10


def run_plant(reporter: Reporter, settings: PlantSettings, image: Path, speed: float) -> None:
    """Run a plant until the process is ended.

    Parameters
    ----------
    image : Path
        Of the process image.
    speed : float
        Times as fast as real time.
    """
    raise_priority()
    plant = RigPlant(settings, ProcessImage(image, settings.layout))
    period = settings.station.loop.process.sampling_period / speed
    clock = PlantClock(reporter)
    plant.tell(clock.time())
    silence = Silence(plant.image, settings.silence, reporter)
    # Nothing that lives here makes circles; a collection would cost milliseconds.
    gc.collect()
    gc.freeze()
    gc.disable()
    reporter.ready()
    deadlines, watch = Deadlines(period), Lateness(reporter, period)
    while True:
        deadlines.wait()
        plant.step(
            heard=silence.heard(), time=clock.time(), lateness=deadlines.lateness,
            missed=deadlines.missed,
        )  # fmt: skip
        watch.look(deadlines)
        clock.look()


def raise_priority() -> None:
    """Let this process run before others, as far as its user may.

    On a single core nobody else would run beside a plant that cannot hold its periods.
    """
    try:
        if len(os.sched_getaffinity(0)) > 1:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_REAL_TIME))
            return
    except (OSError, AttributeError):
        pass
    with suppress(OSError, AttributeError):
        os.nice(_NICE)


class PlantClock:
    """The time of day as the plant has it: it never goes back, whoever sets the machine's.

    Parameters
    ----------
    reporter : Reporter
    of_day, steady : callable, optional
        The machine's clock [s since 1970], and one that nobody sets [s].
    """

    def __init__(
        self,
        reporter: Reporter,
        of_day: Callable[[], float] = time.time,
        steady: Callable[[], float] = time.monotonic,
    ) -> None:
        self._reporter, self._of_day, self._steady = reporter, of_day, steady
        self._began, self._clock = of_day(), steady()
        self._set_by = 0.0

    def time(self) -> float:
        """Return it [s since 1970]."""
        return self._began + self._steady() - self._clock

    def look(self) -> None:
        """Say it where the machine's clock was set."""
        set_by = self._of_day() - self.time()
        if abs(set_by - self._set_by) > _CLOCK_SET:
            self._reporter.event(
                f"the clock of the machine was set by {set_by - self._set_by:+.0f} s; the plant "
                "goes on with its own until the rig is started again"
            )
            self._set_by = set_by


class Silence:
    """Whether the controller on the wires gives signs of life.

    Any value that it writes is one; where it counts its heartbeat, that has to move. Before the
    first one nobody is missed: the plant waits at rest. Where it goes on, its controller may have
    gone meanwhile.

    Parameters
    ----------
    image : ProcessImage
    longest : float
        After so long without a sign it is silent [s].
    reporter : Reporter
    steady : callable, optional
        A clock that nobody sets [s].
    """

    def __init__(
        self,
        image: ProcessImage,
        longest: float,
        reporter: Reporter,
        steady: Callable[[], float] = time.monotonic,
    ) -> None:
        self._image, self._longest, self._reporter = image, longest, reporter
        self._beats, self._writes = image.read(HEARTBEAT), image.read(WRITES)
        self._counts, self._has_spoken = self._beats != 0.0, self._writes != 0.0
        self._steady, self._last = steady, steady()
        self._is_silent = False

    def heard(self) -> bool:
        """Return whether the last sign is young enough; report where that changes."""
        beats, writes, now = self._image.read(HEARTBEAT), self._image.read(WRITES), self._steady()
        self._counts = self._counts or beats != self._beats
        if beats != self._beats or (writes != self._writes and not self._counts):
            self._has_spoken, self._last = True, now
            if self._is_silent:
                self._reporter.event("the controller is heard again: its outputs move the plant")
            self._is_silent = False
        self._beats, self._writes = beats, writes
        if self._has_spoken and not self._is_silent and now - self._last > self._longest:
            self._is_silent = True
            self._reporter.event(
                f"no sign of life from the controller for {self._longest:g} s: outputs go to "
                "their fail-safe values"
            )
        return not self._is_silent


class Lateness:
    """Says it where the plant cannot keep its periods."""

    def __init__(self, reporter: Reporter, period: float) -> None:
        self._reporter, self._period = reporter, period
        self._late = self._missed = 0
        self._told = time.monotonic()

    def look(self, deadlines: Deadlines) -> None:
        """Count a period."""
        self._late += deadlines.lateness > self._period
        now = time.monotonic()
        if now - self._told < _BETWEEN:
            return
        missed = deadlines.missed - self._missed
        if self._late or missed:
            words = f"{self._late} periods began more than a period late"
            if missed:
                words += f", and {missed} were left out after a sleep"
            self._reporter.event(f"{words}; take a lower --speed, or let less run beside it")
        self._late, self._missed, self._told = 0, deadlines.missed, now
