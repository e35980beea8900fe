"""What the wires of an instructor do to a rig that is the client: with a bus that only counts."""

import asyncio

import pytest

from clepsydra.rig.doors.exchange import Exchange
from clepsydra.rig.doors.modbus.register_map import map_of_plc
from clepsydra.rig.doors.wire_faults import WireFaults
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag import WIRE_CUT
from clepsydra.rig.tag_table import WRITES


class CountingBus:
    """A PLC whose outputs are all 0 but for its heartbeat, which counts reads."""

    def __init__(self) -> None:
        self.written: list[dict[str, float]] = []
        self.read_times = self.closed_times = 0

    async def open(self) -> None:
        pass

    async def read(self, names) -> dict[str, float]:
        self.read_times += 1
        return dict.fromkeys(names, 0.0) | {"controller.heartbeat": float(self.read_times)}

    async def write(self, values) -> None:
        self.written.append(dict(values))

    async def close(self) -> None:
        self.closed_times += 1


@pytest.fixture
def run(tags, table):
    """Exchange with a bus until a condition holds."""

    def until(bus: CountingBus, condition) -> None:
        async def body() -> None:
            reporter = Reporter("test", lambda report: None)
            exchange = Exchange(
                map_of_plc(tags).tags, bus, table, WireFaults(table.image, 1), reporter
            )
            task = asyncio.create_task(exchange.run(0.001))
            while not condition():
                await asyncio.sleep(0.001)
            task.cancel()

        asyncio.run(asyncio.wait_for(body(), 600.0))

    return until


def test_over_a_pulled_cable_nothing_is_exchanged(run, told, table) -> None:
    told()
    table.image.write(WIRE_CUT, 1.0)
    bus = CountingBus()
    run(bus, lambda: bus.closed_times == 5)
    assert (bus.written, bus.read_times, table.image.read(WRITES)) == ([], 0, 0.0)


def test_before_the_first_sample_nothing_is_exchanged(run, told, table) -> None:
    bus = CountingBus()
    polls = iter(range(5))
    run(bus, lambda: next(polls, None) is None)
    assert (bus.written, bus.read_times) == ([], 0)


def test_every_exchange_has_one_sample(run, told, table, tags) -> None:
    told(level_1=2.0, **{"plant.watchdog": 9.0})
    bus = CountingBus()
    run(bus, lambda: bus.read_times >= 3)
    assert {(sent["level_1.pv"], sent["plant.watchdog"]) for sent in bus.written} == {(2.0, 9.0)}
    told_by_plc = sum(tag.writer.value == "controller" for tag in tags)
    # Each beat moves all that the controller tells, the last one maybe not yet.
    assert table.image.read(WRITES) % told_by_plc == 0.0
    assert table.image.read(WRITES) >= 2 * told_by_plc
