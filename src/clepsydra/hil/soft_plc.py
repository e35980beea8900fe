"""A soft PLC: an exported controller in a process of its own, which scans in real time."""

from __future__ import annotations

import asyncio
import gc
import logging
import math
import os
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection

from clepsydra.hil.commands import Command, Delay, Finish, PowerCycle, Skip, Stop
from clepsydra.hil.controller_image import ControllerImage
from clepsydra.hil.plc_clock import PlcClock
from clepsydra.hil.scan_log import ScanLog
from clepsydra.hil.scanner import Scanner, Wiring
from clepsydra.rig.bus import Bus, BusFault
from clepsydra.rig.child import Child
from clepsydra.rig.deadlines import Deadlines
from clepsydra.rig.report import Reporter

#: Of the process, where the user may raise it.
_PRIORITY = -10
#: Samples of the plant whose beginnings are watched before the first scan.
_WATCHED = 3
#: Looks at the plant's watchdog in a period, and the shortest time between two [s].
_LOOKS, _BETWEEN = 50, 5e-4
#: How long who asks for a record waits for it before it looks whether the PLC lives [s].
_PATIENCE = 1.0


@dataclass(frozen=True)
class SoftPlcSettings:
    """What a soft PLC runs; it travels to the process that does it.

    Parameters
    ----------
    image : ControllerImage
    wiring : Wiring
    bus : Bus
        Not open yet.
    sampling_period : float
        Of the plant [s].
    speed : float
        Times as fast as real time.
    phase : float
        Where in a sample of the plant a scan begins, as a share of it.
    start : int
        What the first scan is told: 2, to begin at the operating point, as a simulation does; or 1,
        to begin as at a plant.
    """

    image: ControllerImage
    wiring: Wiring
    bus: Bus
    sampling_period: float
    speed: float = 1.0
    phase: float = 0.3
    start: int = 2


class SoftPlc:
    """A soft PLC at work, as the process that started it has it.

    Parameters
    ----------
    settings : SoftPlcSettings
    title : str
        What reports call it.

    Attributes
    ----------
    child : Child
        The process; it reports that it is ready when it begins to scan, in step with the plant.
    """

    def __init__(self, settings: SoftPlcSettings, title: str = "soft PLC") -> None:
        self._pipe, self._theirs = Pipe()
        self.child = Child(title, run_soft_plc, (settings, self._theirs))

    def start(self) -> None:
        """Start the process."""
        self.child.start()
        self._theirs.close()

    def send(self, command: Command) -> None:
        """Let something be done to it."""
        self._pipe.send(command)

    def finish(self, at: int = 0, patience: float = math.inf) -> ScanLog | None:
        """Let it end once it has read a sample of the plant, and return its record.

        Parameters
        ----------
        at : int
            The sample, or a later one.
        patience : float
            After so long it ends where it is, as where the plant stands still [s].

        Returns
        -------
        ScanLog or None
            None where the process has ended by itself.
        """
        log, until = None, time.monotonic() + patience
        with suppress(OSError, EOFError):
            self.send(Finish(at))
            while log is None and (self._pipe.poll(_PATIENCE) or self.child.is_alive):
                if self._pipe.poll():
                    log = self._pipe.recv()
                elif time.monotonic() > until:
                    self.send(Finish())
                    until = math.inf
        self.end()
        return log

    def end(self) -> None:
        """End the process."""
        self.child.end()
        self._pipe.close()


def run_soft_plc(reporter: Reporter, settings: SoftPlcSettings, pipe: Connection) -> None:
    """Scan until the record is asked for, or nobody is there any more who could."""
    with suppress(OSError, AttributeError):  # as far as the user may
        os.nice(_PRIORITY)
    # What a client logs of its server is told by its faults.
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)
    with suppress(EOFError, OSError):
        asyncio.run(_AtWork(reporter, settings, pipe).run())


class _AtWork:
    """A soft PLC in its process."""

    def __init__(self, reporter: Reporter, settings: SoftPlcSettings, pipe: Connection) -> None:
        self._reporter, self._pipe, self._settings = reporter, pipe, settings
        self._bus = settings.bus
        self._scanner = Scanner(settings.image, settings.wiring, settings.bus)
        self._log = ScanLog(tuple(settings.image.inputs), settings.image.outputs)
        self._period = settings.sampling_period / settings.speed
        self._waiting: list[Command] = []
        self._late: list[float] = []
        self._start, self._power = settings.start, 1
        self._finishes = False

    async def run(self) -> None:
        await self._until_answered(self._bus.open)
        first = await self._in_step()
        self._deadlines = Deadlines(self._period, first=first, makes_up=False)
        self._clock = PlcClock(self._settings.sampling_period, self._period, first)
        gc.collect()
        gc.freeze()
        self._reporter.ready()
        while not self._finishes:
            await self._deadlines.wait_beside()
            if self._late:
                await asyncio.sleep(self._late.pop(0) / self._settings.speed)
            await self._scan()
            await self._obey()
        self._log.left_out = self._deadlines.missed
        await self._bus.close()
        self._pipe.send(self._log)

    async def _scan(self) -> None:
        now = time.monotonic()
        scan = await self._scanner.scan(self._clock.step(now), self._start)
        deadline = self._deadlines.last
        self._log.add(
            scan, began=now - self._clock.origin, lateness=max(0.0, now - deadline),
            took=time.monotonic() - now, power=self._power,
        )  # fmt: skip
        self._start = self._power = 0

    async def _obey(self) -> None:
        """Do what is due."""
        while self._pipe.poll():
            self._waiting.append(self._pipe.recv())
        due = [each for each in self._waiting if each.at <= self._scanner.sample]
        self._waiting = [each for each in self._waiting if each not in due]
        for command in due:
            if isinstance(command, Stop):
                self._log.note(f"STOP for {command.seconds:g} s")
                await self._pause(command.seconds)
            elif isinstance(command, PowerCycle):
                await self._without_power(command)
            elif isinstance(command, Delay):
                self._late += [command.seconds] * command.scans
                self._log.note(f"{command.scans} scans begin {command.seconds:g} s late")
            elif isinstance(command, Skip):
                self._deadlines.leave_out(command.scans)
                self._log.note(f"{command.scans} scans are left out")
            elif isinstance(command, Finish):
                self._finishes = True

    async def _pause(self, seconds: float) -> None:
        await asyncio.sleep(seconds / self._settings.speed)
        self._deadlines.leave_out()

    async def _without_power(self, command: PowerCycle) -> None:
        kept = "with" if command.retained else "without"
        self._log.note(f"no power for {command.seconds:g} s; it comes back {kept} kept state")
        await self._bus.close()
        await self._pause(command.seconds)
        self._scanner.controller.power_cycle(retained=command.retained)
        self._clock.begin()
        self._start, self._power = 1, 2 if command.retained else 1
        with suppress(BusFault):  # the bus connects anew where it has to
            await self._bus.open()

    async def _in_step(self) -> float:
        """Return when the first scan is to begin: at its place in a sample of the plant [s].

        Of some samples the beginning is watched; that which was least late counts.
        """
        period = self._period
        await self._until_answered(self._scanner.look)
        begins = [await self._next_sample() for _ in range(_WATCHED)]
        last = begins[-1]
        # By how much each was later than the last one, within half a period.
        later = [(each - last + period / 2.0) % period - period / 2.0 for each in begins]
        return last + min(later) + (1.0 + self._settings.phase) * period

    async def _next_sample(self) -> float:
        """Return when the next sample of the plant begins, in the middle of what is known [s]."""
        between = max(self._period / _LOOKS, _BETWEEN)
        sample, before = self._scanner.sample, time.monotonic()
        while True:
            if self._pipe.poll() and isinstance(command := self._pipe.recv(), Command):
                self._waiting.append(command)
            now = time.monotonic()
            await self._until_answered(self._scanner.look)
            if self._scanner.sample != sample:
                return (before + time.monotonic()) / 2.0
            before = now
            await asyncio.sleep(between)

    async def _until_answered(self, ask: Callable[[], Awaitable[object]]) -> None:
        """Ask the bus until it answers; say once that it does not."""
        said = False
        while True:
            try:
                await ask()
            except BusFault as fault:
                if not said:
                    self._reporter.event(f"waits for the bus: {fault}")
                said = True
                await asyncio.sleep(self._period)
            else:
                return
