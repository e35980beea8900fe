"""A rig at work: the processes that it is made of, watched, and started again where one dies."""

from __future__ import annotations

import errno
import math
import sqlite3
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from pathlib import Path

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.files import make_folder
from clepsydra.base.history_file import HistoryFile
from clepsydra.rig.child import REFUSED, Child, reports_of
from clepsydra.rig.doors.door_process import serve_door
from clepsydra.rig.historian import Historian, HistorySettings, keep_history
from clepsydra.rig.image import ImageOfAnother, ProcessImage
from clepsydra.rig.instructor import Instructor
from clepsydra.rig.plant_process import run_plant
from clepsydra.rig.report import Kind, Report, Reporter
from clepsydra.rig.screen import ending, opening, standing
from clepsydra.rig.settings import HISTORY, RigSettings
from clepsydra.rig.tag_table import TagTable

#: What stands in the folder of a rig.
IMAGE, _LOCK = "image", "running"
#: A process has so long to begin [s]; one that dies more often than this in a minute stays dead.
_BEGINS, _DIES = 60.0, 5
_MINUTE = 60.0
#: How often it looks into its script [s].
_SCRIPT = 0.05


class RunningRig:
    """A rig at work; a context, at whose end all its processes have ended.

    Parameters
    ----------
    settings : RigSettings

    Attributes
    ----------
    table : TagTable
        Its tags, as they are now.
    instructor : Instructor
        Who lets its sensors and final elements fail.
    run : int
        Its number in the history.
    """

    def __init__(self, settings: RigSettings) -> None:
        self.settings = settings
        self._deaths: dict[str, list[float]] = {}
        self._closed: set[str] = set()
        self._early: list[Report] = []
        self._due = list(settings.script)

    def __enter__(self) -> RunningRig:
        for door in self.settings.doors:
            door.check()
        with ExitStack() as stack:
            self._begin(stack)
            # The plant begins once all who look at it are there.
            history, plant, *doors = self._children
            for children in ([history, *doors], [plant]):
                for child in children:
                    child.start()
                self._await(children)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def _begin(self, stack: ExitStack) -> None:
        settings, folder = self.settings, self.settings.folder
        make_folder(folder, "rig, folder")
        stack.enter_context(_alone(folder))
        path, layout = folder / IMAGE, settings.plant.layout
        self.history = stack.enter_context(HistoryFile(folder / HISTORY))
        self.run = _run(self.history, settings)
        self.image = _image(path, settings)
        self.table = TagTable(settings.tags, self.image)
        self.instructor = Instructor(settings.process, self.image)
        before = self.image.remembered()
        self._first = 0 if before is None else before[0]
        names = tuple(signal.name for signal in settings.kept)
        keeps = HistorySettings(folder / HISTORY, self.run, names, settings.retention)
        # Doors are ended first, so that nobody writes to a plant that is gone; the history last,
        # and what came after its last look is kept here.
        stack.callback(self._keep_rest, keeps)
        self._children = [
            Child("history", keep_history, (keeps, path, layout)),
            Child("plant", run_plant, (settings.plant, path, settings.speed)),
            *(
                Child(door.title, serve_door, (door, settings.tags, path, layout))
                for door in settings.doors
            ),
        ]
        for child in self._children:
            stack.callback(child.end)

    def _keep_rest(self, keeps: HistorySettings) -> None:
        # What cannot be kept, as on a full disk, waits in the image.
        with suppress(InputError):
            historian = Historian(Reporter("history", self._kept), keeps, self.image)
            historian.keep()
            historian.close()

    def _await(self, children: Sequence[Child]) -> None:
        waiting, until = {each.title for each in children}, time.monotonic() + _BEGINS
        while waiting:
            for child, report in reports_of(self._children, 0.2):
                if report.error is not None:
                    raise report.error
                if report.kind is Kind.READY:
                    waiting.discard(child.title)
                else:
                    self._early.append(report)
            for child in children:
                if child.title in waiting and not child.is_alive:
                    raise _ended(child)
            if time.monotonic() > until:
                raise InputError(
                    f"rig, {', '.join(sorted(waiting))}", Finding("nothing within a minute"),
                    "that it is at work", "let less run beside it, and start it again",
                )  # fmt: skip

    def watch(self, seconds: float) -> Iterator[Report]:
        """Yield what is reported within some time, and start again what has died.

        Raises
        ------
        InputError
            The plant or its history dies again and again.
        """
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            found, self._early = [*self._early, *self._reports(min(left, _SCRIPT))], []
            yield from map(self._kept, [*found, *self._actions()])
            for child in self._children:
                if not child.is_alive and child.title not in self._closed:
                    yield self._kept(self._start_again(child))

    def process_of(self, title: str) -> int:
        """Return the number of the process of "plant", "history" or a door."""
        child = next(each for each in self._children if each.title == title)
        assert child.process is not None and child.process.pid is not None
        return child.process.pid

    @property
    def opening(self) -> list[str]:
        """The lines with which it begins: what runs how fast, and where it is found."""
        return opening(self.settings)

    @property
    def standing(self) -> str:
        """How it stands, in a line."""
        return standing(self.table, self.elapsed)

    @property
    def ending(self) -> str:
        """The line with which it ends, once it has: how long it ran, where its history is."""
        before = self.image.remembered()
        last = -1 if before is None else before[0] - 1
        return ending(self.settings, self.elapsed, max(last - self.image.acknowledged, 0))

    @property
    def elapsed(self) -> float:
        """For how long the plant has been at work since it was begun [s of the plant]."""
        period = self.settings.process.sampling_period
        return (self.image.published().sample - self._first) * period

    def left_until(self, ends: float | None) -> float:
        """Return how long it is until a time of the plant [s], on the clock; None never comes."""
        return math.inf if ends is None else (ends - self.elapsed) / self.settings.speed

    def _actions(self) -> Iterator[Report]:
        while self._due and self._due[0].at <= self.elapsed:
            words = self._due.pop(0).do(self.table, self.instructor)
            yield Report("script", Kind.EVENT, words, time.time())

    def _reports(self, seconds: float) -> list[Report]:
        found = reports_of(self._children, seconds)
        return [report for _, report in found if report.kind is Kind.EVENT]

    def _start_again(self, child: Child) -> Report:
        now, before = time.monotonic(), self._deaths.get(child.title, [])
        self._deaths[child.title] = [each for each in before if now - each < _MINUTE] + [now]
        words = f"it ended with {child.exit_code} and was started again"
        if len(self._deaths[child.title]) <= _DIES and child.exit_code != REFUSED:
            child.start()
        elif child in self._children[:2]:
            raise _ended(child)
        else:
            # The plant goes on for who comes in by another door.
            self._closed.add(child.title)
            words = f"it ended with {child.exit_code} again and again, and stays closed; see what "
            words += "it printed, and start the rig again with --resume"
        return Report(child.title, Kind.EVENT, words, time.time())

    def _kept(self, report: Report) -> Report:
        with suppress(sqlite3.Error):
            self.history.tell(self.run, report.time, report.source, report.words)
        return report


def _ended(child: Child) -> InputError:
    return InputError(
        f"rig, {child.title}", Finding(f"a process that ended with {child.exit_code}"),
        "that it is at work", "see what it printed, and start the rig again",
    )  # fmt: skip


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Hold a folder for one rig; the lock of a process that is killed goes with it."""
    with closing(sqlite3.connect(folder / _LOCK, timeout=0.0, isolation_level=None)) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.Error:
            raise InputError(
                "rig, folder", str(folder), "a folder in which no other rig is at work",
                "end the other one, or choose another folder",
            ) from None  # fmt: skip
        yield


def _run(history: HistoryFile, settings: RigSettings) -> int:
    """Return the number of the run: a new one, or the last where it goes on."""
    last = history.last_run()
    if settings.resume and last is not None and last.title == settings.title:
        return last.number
    period = settings.process.sampling_period
    return history.begin(settings.title, time.time(), period, settings.kept)


def _image(path: Path, settings: RigSettings) -> ProcessImage:
    try:
        return ProcessImage(path, settings.plant.layout, new=not settings.resume)
    except (OSError, ImageOfAnother) as error:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
            raise InputError(
                f"rig, {path.parent}", Finding("a disk that is full"),
                f"room for {settings.plant.layout.size / 1e6:.0f} MB and the history",
                "make room on it, or choose another folder",
            ) from None  # fmt: skip
        missing = isinstance(error, FileNotFoundError)
        found = Finding("nothing to go on from" if missing else "what another rig left there")
        raise InputError(
            f"rig, {path.parent}", found, "a folder in which this rig was at work",
            "leave --resume out, or choose the folder",
        ) from None  # fmt: skip
