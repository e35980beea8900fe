"""The commands of the commits, as many at once as there are processors."""

from __future__ import annotations

import datetime
import heapq
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from compare_commits.kept import Kept
from compare_commits.outputs import Normaliser, read_files, read_printed
from compare_commits.plan import WARM_UP, Command, first_commands, following

#: Of a command whose process was lost or stopped, and which is run again the next time.
STOPPED = "stopped"
_WORKER = Path(__file__).with_name("worker.py")


class WorkerError(Exception):
    """A commit whose command line does not start."""


@dataclass
class Side:
    """A commit that runs.

    Parameters
    ----------
    checkout : Path
        Folder of its files.
    version : str
        That it calls itself.
    kept : Kept
        What it has printed before.
    records : dict
        Label of a command to its record.
    modules : list of str
        What its commands import, known when its first worker has run some.
    ran : int
        How many commands were run and not found kept.
    """

    checkout: Path
    version: str
    kept: Kept
    records: dict[str, dict[str, Any]] = field(default_factory=dict)
    modules: list[str] = field(default_factory=list)
    ran: int = 0


class Worker:
    """A process that runs commands of one side, one after the other."""

    def __init__(self, side: Side, folder: Path, limit: float) -> None:
        self.side, self.folder, self.limit = side, folder, limit
        environment = {
            **{k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "CLEPSYDRA_"))},
            "PYTHONPATH": str(side.checkout / "src"),
            "PYTHONHASHSEED": "0",
            "PYTHONIOENCODING": "utf-8",
            "CLEPSYDRA_CACHE": str(side.kept.objects),
            "OPENBLAS_NUM_THREADS": "1",
            "COLUMNS": "100",
            "NO_COLOR": "1",
        }
        self.process = subprocess.Popen(
            [sys.executable, str(_WORKER)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment, text=True,
            cwd=folder, start_new_session=True,
        )  # fmt: skip
        with tempfile.TemporaryDirectory(dir=folder) as own:
            answer = self._ask(
                {"modules": side.modules, "warm_up": WARM_UP, "folder": own, "limit": limit}
            )
        side.modules = answer.get("modules", side.modules)
        source = Path(str(answer.get("source", "")))
        if not source.is_relative_to(side.checkout):
            self.close()
            raise WorkerError(
                f"{side.checkout}: its command line does not start"
                + (f", since {source} is imported in its place" if answer.get("source") else "")
            )

    def run(self, command: Command) -> dict[str, Any]:
        """Return the record of a command, run in an empty folder."""
        with tempfile.TemporaryDirectory(dir=self.folder) as own:
            paths = {
                own: "<folder>",
                str(self.side.checkout): "<checkout>",
                str(self.side.kept.objects): "<objects>",
            }
            now = datetime.datetime.now(datetime.UTC)
            normaliser = Normaliser(command.verb, paths, self.side.version, now)
            shown: dict[str, Any] = {}
            used: Counter[str] = Counter()
            for number, arguments in enumerate(command.steps, 1):
                answer = self._ask({"arguments": arguments, "folder": own, "limit": self.limit})
                status = answer.get("status")
                used.update({k: v for k, v in answer.items() if k != "status"})
                printed, said = (
                    (Path(own) / name).read_text(encoding="utf-8", errors="replace")
                    if (Path(own) / name).exists()
                    else ""
                    for name in (".stdout", ".stderr")
                )
                shown[f"step {number}" if len(command.steps) > 1 else "run"] = {
                    "status": STOPPED if status is None or status < 0 else status,
                    "printed": read_printed(printed, normaliser),
                    "messages": normaliser.text(said),
                }
                if status != 0:
                    break
            return {
                "label": command.label,
                "group": command.verb,
                "steps": [list(step) for step in command.steps],
                "shown": {**shown, "files": read_files(Path(own), normaliser)},
                "left out": dict(normaliser.left_out),
                **used,
            }

    def close(self) -> None:
        """End the process and what it runs."""
        with suppress(ProcessLookupError):
            for child in _children(self.process.pid):
                with suppress(ProcessLookupError):
                    os.killpg(child, signal.SIGKILL)
            self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            with suppress(OSError):  # a request that nobody reads any more
                stream and stream.close()

    def _ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Return the worker's answer; nothing where it has died."""
        assert self.process.stdin is not None and self.process.stdout is not None
        try:
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
            return dict(json.loads(self.process.stdout.readline() or "{}"))
        except (BrokenPipeError, ValueError):
            return {}


class Runner:
    """Runs the commands of all sides.

    Parameters
    ----------
    sides : list of Side
        Each is run where it has no record.
    folder : Path
        For what runs.
    limit : float
        Longest time of a command [s].
    tell : callable
        Told of each command that has run: label, seconds, and how many are done of how many known.
    first : list of Command
        Where it begins.
    """

    def __init__(
        self,
        sides: list[Side],
        folder: Path,
        limit: float,
        tell: Callable[[str, float, int, int], None],
        first: list[Command] | None = None,
    ) -> None:
        self._folder, self._limit, self._tell = folder, limit, tell
        self._condition = threading.Condition()
        self._waiting: list[tuple[int, int, Side, Command]] = []
        self._workers: list[Worker] = []
        self._known = self._done = self._running = 0
        self._failure: BaseException | None = None
        self._stop = False
        for command in first_commands() if first is None else first:
            for side in sides:
                self._take(side, command)

    def run(self) -> None:
        """Run until nothing is left."""
        count = len(os.sched_getaffinity(0))
        threads = [threading.Thread(target=self._work, daemon=True) for _ in range(count)]
        try:
            for thread in threads:
                thread.start()
            for thread in threads:
                while thread.is_alive() and not self._stop:
                    thread.join(0.2)  # an interrupt is heard in between
        finally:
            self._stop = True
            for worker in self._workers:
                worker.close()
        if self._failure is not None:
            raise self._failure

    def _take(self, side: Side, command: Command) -> None:
        """Put a command into the queue, or what follows it where it has run before."""
        self._known += 1
        record = side.kept.load(command)
        if record is None:
            heapq.heappush(self._waiting, (-command.urgency, self._known, side, command))
        else:
            self._finish(side, command, record)

    def _finish(self, side: Side, command: Command, record: dict[str, Any]) -> None:
        self._done += 1
        side.records[command.label] = record
        printed = [part["printed"] for part in record["shown"].values() if "printed" in part]
        for next_one in following(command, printed[-1]):
            self._take(side, next_one)

    def _work(self) -> None:
        workers: dict[int, Worker] = {}
        while (chosen := self._next()) is not None:
            side, command = chosen
            try:
                worker = workers.get(id(side))
                if worker is None or worker.process.poll() is not None:
                    worker = workers[id(side)] = Worker(side, self._folder, self._limit)
                    self._workers.append(worker)
                record = worker.run(command)
            except BaseException as error:
                with self._condition:
                    self._failure = self._failure or error
                    self._stop = True
                    self._condition.notify_all()
                return
            with self._condition:
                if self._stop:
                    return
                if not was_stopped(record):
                    side.kept.store(command, record)
                side.ran += 1
                self._finish(side, command, record)
                self._running -= 1
                self._tell(command.label, record.get("seconds", 0.0), self._done, self._known)
                self._condition.notify_all()

    def _next(self) -> tuple[Side, Command] | None:
        """Return what is to be run next; wait where a running command may have a successor."""
        with self._condition:
            while not self._stop:
                if self._waiting:
                    self._running += 1
                    return heapq.heappop(self._waiting)[2:]
                if self._running == 0:
                    return None
                self._condition.wait()
            return None


def was_stopped(record: dict[str, Any]) -> bool:
    """Return whether a command took too long or was ended from outside."""
    return any(part.get("status") == STOPPED for part in record["shown"].values())


def _children(process: int) -> list[int]:
    try:
        listed = Path(f"/proc/{process}/task/{process}/children").read_text(encoding="utf-8")
    except OSError:
        return []
    return [int(number) for number in listed.split()]
