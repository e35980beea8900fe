"""How late a rig's samples begin, with three clients and its history, beside a bare loop."""

from __future__ import annotations

import multiprocessing
import os
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import clepsydra as cl
from benchmarks.rig import clients
from benchmarks.rig.clients import Reads
from benchmarks.rig.plants import RigPlant, plants
from clepsydra.rig.running import RunningRig
from clepsydra.rig.tag import HEARTBEAT, Writer

#: So much counts as in time [s].
IN_TIME = 0.005
#: While clients come in nothing is measured [s].
_SETTLES = 10.0
#: Of a publishing interval of OPC UA, and between two looks of the second reader [s].
_INTERVAL, _LOOKS = 0.1, 0.1
#: A client that is told to end has so long [s].
_PATIENCE = 60.0


@dataclass(frozen=True)
class Punctuality:
    """How late the periods of a loop began.

    Parameters
    ----------
    lateness : ndarray
        Of each [s].
    """

    lateness: np.ndarray

    @property
    def in_time(self) -> float:
        """The share that began within 5 ms of its deadline [1]."""
        return float(np.mean(self.lateness <= IN_TIME))

    def quantile(self, share: float) -> float:
        """Return the lateness [s] that so many do not exceed."""
        return float(np.quantile(self.lateness, share))


@dataclass(frozen=True)
class RigTimes:
    """What was measured of one plant.

    Parameters
    ----------
    plant : RigPlant
    tags : int
    rig, bare : Punctuality
        Of the plant of the rig, and of a loop beside it that only sleeps.
    missed : int
        Samples that the history lacks.
    clients : tuple of str
        What each got.
    load : float
        Of the machine over the last minute, at the end.
    """

    plant: RigPlant
    tags: int
    rig: Punctuality
    bare: Punctuality
    missed: int
    clients: tuple[str, ...]
    load: float


def measure(seconds: float, folder: Path, tell: Callable[[str], None]) -> list[RigTimes]:
    """Run each plant for so long, with all that is beside it.

    Raises
    ------
    RuntimeError
        A client has ended before its time.
    """
    found = []
    for plant in plants(folder):
        tell(f"{plant.words}, {seconds:g} s")
        found.append(_measured(plant, seconds, folder / f"rig-{plant.period:g}"))
    return found


def _measured(plant: RigPlant, seconds: float, folder: Path) -> RigTimes:
    doors = cl.Doors(["modbus", "opc-ua"], ports=_free_ports(), anonymous=True)
    running = cl.run_rig(plant.plant, speed=plant.speed, folder=folder, doors=doors)
    tags = running.settings.tags
    commands = [tag for tag in tags if tag.name.endswith(".out")]
    shown = [tag.name for tag in tags if tag.writer is Writer.PLANT]
    real = [tag for tag in tags if tag.writer is Writer.PLANT and tag.signal.kind == "real"]
    heartbeat = doors.register_map(tags).by_tag[HEARTBEAT].address
    values = tuple(tag.signal.initial or 3.0 for tag in commands)
    ports = doors.ports or {}
    with running:
        # Every measurement is another one in every sample, for all who look on.
        running.instructor.noise(True)
        master = Reads(2 * len(real), values, heartbeat, plant.period)
        reader = Reads(2 * len(real), (), heartbeat, _LOOKS)
        address = f"opc.tcp://127.0.0.1:{ports['opc-ua']}/clepsydra"
        others: tuple[tuple[Callable[..., None], tuple[Any, ...]], ...] = (
            (clients.scan, (ports["modbus"], master)),
            (clients.scan, (ports["modbus"], reader)),
            (clients.subscribe, (address, shown, _INTERVAL)),
            (clients.sleep_bare, (plant.period,)),
        )
        with _beside(others) as end:
            _watch(running, _SETTLES)
            first = running.image.published()
            _watch(running, seconds)
            last = running.image.published()
            *told, bare = end()
        load = os.getloadavg()[0]
    samples = _lateness(running, first.sample, last.sample)
    late = [each for at, each in bare if first.time <= at < last.time]
    wanted = last.sample - first.sample
    return RigTimes(
        plant, len(tags), Punctuality(samples), Punctuality(np.array(late)),
        wanted - len(samples), tuple(told), load,
    )  # fmt: skip


def _watch(running: RunningRig, seconds: float) -> None:
    for report in running.watch(seconds):
        print(report)


def _free_ports() -> dict[str, int]:
    import socket

    with socket.create_server(("127.0.0.1", 0)) as one, socket.create_server(("127.0.0.1", 0)) as b:
        return {"modbus": one.getsockname()[1], "opc-ua": b.getsockname()[1]}


def _lateness(running: RunningRig, first: int, last: int) -> np.ndarray:
    sql = 'SELECT "plant.lateness" FROM samples WHERE run = ? AND sample >= ? AND sample < ?'
    with closing(sqlite3.connect(running.history.path)) as connection:
        rows = connection.execute(sql, (running.run, first, last)).fetchall()
    return np.array([row[0] for row in rows])


@contextmanager
def _beside(
    works: Sequence[tuple[Callable[..., None], tuple[Any, ...]]],
) -> Iterator[Callable[[], list[Any]]]:
    """Run each in a process of its own; gives what ends them and returns what they found."""
    context = multiprocessing.get_context("spawn")
    pipes, processes = [], []
    for work, arguments in works:
        ours, theirs = context.Pipe()
        process = context.Process(target=work, args=(theirs, *arguments), daemon=True)
        process.start()
        theirs.close()
        pipes.append(ours)
        processes.append(process)

    def end() -> list[Any]:
        for pipe in pipes:
            pipe.send("end")
        try:
            return [pipe.recv() if pipe.poll(_PATIENCE) else "no answer" for pipe in pipes]
        except EOFError:
            raise RuntimeError("a client of the rig has ended before its time") from None

    try:
        yield end
    finally:
        for process in processes:
            process.terminate()
            process.join()
