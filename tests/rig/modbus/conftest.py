"""A rig without a plant, whose image a test fills itself, and its door in a thread."""

import asyncio
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import Pipe

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.rig.doors.modbus.door import ModbusDoor
from clepsydra.rig.doors.modbus.register_map import default_map
from clepsydra.rig.image import ImageLayout, ProcessImage
from clepsydra.rig.report import Kind, Report, Reporter
from clepsydra.rig.tag import WIRE_CUT, WIRE_DELAY, WIRE_LOSS, Tag, Writer
from clepsydra.rig.tag_table import WRITES, TagTable
from clepsydra.rig.tags import tags_of


@pytest.fixture(scope="session")
def tags() -> tuple[Tag, ...]:
    return tags_of(cl.load("quadruple-tank").point)


@pytest.fixture
def table(tags, tmp_path) -> TagTable:
    """Tags over an image in which the plant has told nothing yet."""
    told = tuple(tag.cell for tag in tags if tag.writer is Writer.PLANT)
    written = tuple(tag.cell for tag in tags if tag.writer is not Writer.PLANT)
    layout = ImageLayout(told, (*written, WRITES, WIRE_DELAY, WIRE_LOSS, WIRE_CUT), remembered=0)
    return TagTable(tags, ProcessImage(tmp_path / "image", layout, new=True))


@pytest.fixture
def told(table) -> Callable[..., None]:
    """Let the plant tell values, by cells, in SI; the others are 0."""
    sample = iter(range(1_000_000))

    def tell(**values: float) -> None:
        names = table.image.layout.published
        table.image.publish(next(sample), 0.0, np.array([values.get(name, 0.0) for name in names]))

    return tell


@dataclass
class Served:
    """A door that serves.

    Attributes
    ----------
    events : list of str
        What it has reported so far; complete once it has ended.
    """

    host: str
    port: int
    events: list[str] = field(default_factory=list)


@pytest.fixture
def serving(tags, table) -> Callable:
    """Serve a door of a register map, by default that of all tags, in a thread."""

    @contextmanager
    def serve(register_map=None, **options) -> Iterator[Served]:
        door = ModbusDoor(register_map or default_map(tags), port=0, **options)
        door.check()
        ours, its = Pipe(duplex=False)
        loop = asyncio.new_event_loop()
        task = loop.create_task(door.serve(table, Reporter(door.title, its)))

        def run() -> None:
            asyncio.set_event_loop(loop)
            loop.run_until_complete(asyncio.gather(task, return_exceptions=True))
            loop.run_until_complete(loop.shutdown_asyncgens())
            loop.close()
            its.close()

        thread = threading.Thread(target=run)
        thread.start()
        served = None
        try:
            ready: Report = ours.recv()
            assert ready.kind is Kind.READY
            host, _, port = ready.words.rpartition(":")
            served = Served(host, int(port))
            listener = threading.Thread(target=_gather, args=(ours, served.events))
            listener.start()
            yield served
        finally:
            loop.call_soon_threadsafe(task.cancel)
            thread.join()
            if served:
                listener.join()
            ours.close()

    return serve


def _gather(reports, events: list[str]) -> None:
    try:
        while True:
            events.append(reports.recv().words)
    except (EOFError, OSError):
        return
