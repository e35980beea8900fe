"""A rig without a plant, whose image a test fills itself, and its door in a thread."""

import asyncio
import socket
import threading
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing import Pipe

import numpy as np
import pytest
from tools import need
from waiting import wait_until

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
    """A door at work.

    Attributes
    ----------
    events : list of str
        What it has reported so far; complete once it has ended.
    """

    host: str
    port: int
    events: list[str] = field(default_factory=list)


@pytest.fixture
def at_work(table) -> Callable:
    """Let a door work in a thread, over the tags."""

    @contextmanager
    def work(door) -> Iterator[Served]:
        door.check()
        ours, its = Pipe(duplex=False)

        async def serve() -> None:
            try:
                await door.serve(table, Reporter(door.title, its.send))
            finally:
                its.close()

        with in_thread(serve):
            ready: Report = ours.recv()
            assert ready.kind is Kind.READY
            host, _, port = ready.words.rpartition(":")
            served = Served(host, int(port))
            listener = threading.Thread(target=_gather, args=(ours, served.events))
            listener.start()
            yield served
        listener.join()
        ours.close()

    return work


def _gather(reports, events: list[str]) -> None:
    try:
        while True:
            events.append(reports.recv().words)
    except (EOFError, OSError):
        return


@contextmanager
def in_thread(work: Callable[[], Coroutine]) -> Iterator[None]:
    """Run a coroutine in a thread, until it is left."""
    loop = asyncio.new_event_loop()

    async def until_cancelled() -> None:
        with suppress(asyncio.CancelledError):
            await work()

    task = loop.create_task(until_cancelled())

    def run() -> None:
        asyncio.set_event_loop(loop)
        loop.run_until_complete(task)
        loop.run_until_complete(asyncio.sleep(0))  # transports that were closed are gone then
        loop.close()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        loop.call_soon_threadsafe(task.cancel)
        thread.join()


@pytest.fixture
def in_a_thread() -> Callable:
    """Run a coroutine function in a thread, until it is left."""
    return in_thread


@pytest.fixture
def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as other:
        return other.getsockname()[1]


@pytest.fixture
def plc(free_port, in_a_thread):
    """A PLC with holding registers, and what its program has in hand: a client of its own."""
    need("pymodbus")
    from pymodbus.client import ModbusTcpClient
    from pymodbus.server import ModbusTcpServer
    from pymodbus.simulator import DataType, SimData, SimDevice

    @contextmanager
    def switched_on(words: int = 200):
        async def serve() -> None:
            memory = SimData(0, count=words, values=0, datatype=DataType.REGISTERS)
            server = ModbusTcpServer(SimDevice(0, [memory]), address=("127.0.0.1", free_port))
            await server.serve_forever(background=True)
            try:
                await asyncio.Event().wait()
            finally:
                await server.shutdown()

        with in_a_thread(serve), ModbusTcpClient("127.0.0.1", port=free_port) as client:
            wait_until(client.connect)
            yield client

    return switched_on


@pytest.fixture
def serving(tags, at_work) -> Callable:
    """Serve a door of a register map, by default that of all tags, in a thread."""

    def serve(register_map=None, **options):
        return at_work(ModbusDoor(register_map or default_map(tags), port=0, **options))

    return serve
