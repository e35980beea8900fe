"""A master over a register map: by names, in the units of tags; what fails is told in words."""

import asyncio
import math
import socket
from dataclasses import replace

import pytest
from tools import need

from clepsydra.rig.bus import BusFault
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.entry import Entry
from clepsydra.rig.doors.modbus.master import ModbusMaster
from clepsydra.rig.doors.modbus.register_map import RegisterMap, default_map
from clepsydra.rig.doors.modbus.spans import spans
from clepsydra.rig.doors.modbus.table import Table
from clepsydra.rig.tag import WIRE_CUT, WIRE_LOSS

NAMES = ["pump_1.out", "level_2.pv", "level_1.pv", "plant.watchdog", "level_3.good"]


@pytest.fixture
def with_master(tags):
    """Run a coroutine function with the master of a door."""
    need("pymodbus")

    def run(served, act, register_map=None, **options):
        async def body():
            made = register_map or default_map(tags)
            master = ModbusMaster(made, served.host, served.port, **options)
            await master.open()
            try:
                return await act(master)
            finally:
                await master.close()

        return asyncio.run(body())

    return run


@pytest.mark.parametrize("encoding", [Encoding.FLOAT32_LOW_WORD_FIRST, Encoding.COUNTS_65535])
def test_what_is_written_is_read(serving, with_master, tags, table, told, encoding) -> None:
    told(level_1=2.0, level_2=8.0, **{"plant.watchdog": 3.0})
    made = default_map(tags, encoding)

    async def no_place(master):
        await master.write({"level_3.good": 1.0})

    async def act(master):
        await master.write({"pump_1.out": 4.0, "operator.remote": 1.0})
        return await master.read(NAMES)

    with serving(made) as served:
        with pytest.raises(BusFault, match=r"level_3\.good: the register map has no place"):
            with_master(served, no_place, made)
        found = with_master(served, act, made)
    assert list(found) == NAMES
    # In 65535 counts of 10 V: 4, 8 and 2 V are whole counts, whose share is rounded.
    assert list(found.values()) == pytest.approx([4.0, 8.0, 2.0, 3.0, 0.0], abs=4e-15)
    assert table.read(table.tags["operator.remote"]).value == 1.0


def test_a_refusal_names_register_tag_and_code(serving, with_master, told) -> None:
    told()

    async def act(master):
        await master.write({"pump_1.out": 4.0, "pump_2.out": math.nan})

    with serving() as served, pytest.raises(BusFault) as caught:
        with_master(served, act)
    fault = caught.value
    assert fault.answered
    assert fault.tag == "pump_1.out and 1 more"
    assert fault.words == (
        "write of holding registers 0 to 3 (40001) was answered by exception 3, illegal data value"
    )


def test_silence_is_told_and_the_bus_goes_on(serving, with_master, table, told) -> None:
    told(level_1=2.5)

    async def act(master):
        table.image.write(WIRE_LOSS, 1.0)
        with pytest.raises(BusFault, match="30001") as caught:
            await master.read(["level_1.pv"])
        table.image.write(WIRE_LOSS, 0.0)
        return caught.value.answered, await master.read(["level_1.pv"])

    with serving() as served:
        assert with_master(served, act, timeout=0.2) == (False, {"level_1.pv": 2.5})


def test_the_end_of_a_connection_is_told_at_once(serving, with_master, table, told) -> None:
    told(level_1=2.5)

    async def act(master):
        table.image.write(WIRE_CUT, 1.0)
        # Until the door has let its clients go, it answers.
        with pytest.raises(BusFault, match=r"nobody takes|was closed") as caught:
            while True:
                await master.read(["level_1.pv"])
        table.image.write(WIRE_CUT, 0.0)
        return caught.value.answered, await master.read(["level_1.pv"])

    # An hour would not go by.
    with serving() as served:
        assert with_master(served, act, timeout=3600.0) == (False, {"level_1.pv": 2.5})


def test_nobody_is_there(tags) -> None:
    need("pymodbus")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
    with pytest.raises(BusFault, match="nobody takes the connection") as caught:
        asyncio.run(ModbusMaster(default_map(tags), "127.0.0.1", port).open())
    assert not caught.value.answered


def test_requests_are_few_and_touch_no_gap(tags) -> None:
    made = default_map(tags)
    found = spans((made.by_tag[name] for name in NAMES), 125, 2000)
    # Levels 1 and 2, the counter, the command, and a switch.
    assert sorted((s.table.value, s.address, s.count) for s in found) == [
        ("discrete input", 2, 1),
        ("holding register", 0, 2),
        ("input register", 0, 4),
        ("input register", 12, 1),
    ]


def test_no_request_is_longer_than_there_may_be(tags) -> None:
    level = tags[0]
    many = [replace(level, name=f"level_{number}.pv") for number in range(130)]
    entries = default_map(many).entries[:130]
    found = spans(entries, 125, 2000)
    # 62 floats are 124 registers; the half of another would be one more.
    assert [(span.address, span.count) for span in found] == [(0, 124), (124, 124), (248, 12)]
    assert [entry for span in found for entry in span.entries] == list(entries)


def test_a_map_of_own_addresses_is_read(serving, with_master, tags, told) -> None:
    level = tags[0]
    made = RegisterMap((Entry(level, Table.HOLDING_REGISTERS, 65534, Encoding.FLOAT32),))
    told(level_1=7.5)

    async def act(master):
        return await master.read([level.name])

    with serving(made) as served:
        assert with_master(served, act, made) == {"level_1.pv": 7.5}
