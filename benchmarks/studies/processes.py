"""Processor time of a process: until its end, and until it has written its first row."""

from __future__ import annotations

import ctypes
import os
import re
import resource
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

#: The first row of a ranking on a terminal, and the first line elsewhere.
ROW_ON_TERMINAL = re.compile(rb"\n *1 +\w")
_LINE = re.compile(rb"\n")


class ProcessFailed(RuntimeError):
    """A command that ended with an error, or without what it was to write."""


@dataclass(frozen=True)
class Ended:
    """A process that has ended.

    Parameters
    ----------
    processor, clock : float
        User and system time of it and of what it started and waited for, and the time that went
        by [s].
    status : int
    said : str
        On standard output and standard error.
    """

    processor: float
    clock: float
    status: int
    said: str


def ended(command: list[str], environment: dict[str, str], folder: Path) -> Ended:
    """Run a command to its end."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(
        command, cwd=folder, env=environment, text=True, errors="replace",
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return Ended(processor, time.perf_counter() - start, done.returncode, done.stdout)


def succeeded(command: list[str], environment: dict[str, str], folder: Path) -> Ended:
    """Run a command to its end.

    Raises
    ------
    ProcessFailed
        Its exit status is not 0.
    """
    done = ended(command, environment, folder)
    if done.status:
        raise ProcessFailed(f"{' '.join(command[-4:])} failed:\n{done.said}")
    return done


def until_first_row(
    command: list[str], environment: dict[str, str], folder: Path, *, terminal: bool
) -> float:
    """Return the processor time of a study until its first row is written [s].

    It is stopped there, since the system does not count to the end what is running, and then
    killed.

    Raises
    ------
    ProcessFailed
        It ended without a row.
    """
    ours, theirs = os.openpty() if terminal else os.pipe()
    process = subprocess.Popen(
        command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=theirs,
        stderr=theirs,
    )  # fmt: skip
    os.close(theirs)
    try:
        _wait_for(ROW_ON_TERMINAL if terminal else _LINE, ours)
        process.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
        return _processor_time_of(process.pid)
    finally:
        process.kill()
        process.wait()
        os.close(ours)


def _wait_for(row: re.Pattern[bytes], stream: int) -> None:
    said = b""
    while not row.search(said):
        try:
            part = os.read(stream, 65_536)
        except OSError:  # how a terminal ends that nobody has open any more
            part = b""
        if not part:
            raise ProcessFailed(f"no row was written:\n{said.decode(errors='replace')}")
        said += part


def _processor_time_of(process: int) -> float:
    clock = ctypes.c_int()
    failure = ctypes.CDLL(None).clock_getcpuclockid(process, ctypes.byref(clock))
    if failure:
        raise OSError(failure, os.strerror(failure))
    return time.clock_gettime(clock.value)
