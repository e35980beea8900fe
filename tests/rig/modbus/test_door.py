"""What masters are answered by the door of a rig: with pymodbus, and by bytes of the document."""

import asyncio
import socket
import struct

import pytest
from refusals import refused
from tools import need

from clepsydra.rig.doors.modbus.door import ModbusDoor
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.register_map import default_map
from clepsydra.rig.report import Kind, Reporter

#: Where the default map of the quadruple tank has them: 4 levels, 2 positions, then a counter.
WATCHDOG, LEVEL_2 = 12, 2
PUMP_1, PUMP_2, STATUS_1, HEARTBEAT = 0, 2, 4, 8
SETPOINT_1, MODE_1 = 100, 104


@pytest.fixture
def master(serving):
    """A pymodbus client of a door."""
    need("pymodbus")
    from contextlib import contextmanager

    from pymodbus.client import ModbusTcpClient

    @contextmanager
    def connect(*arguments, **options):
        with (
            serving(*arguments, **options) as served,
            ModbusTcpClient(served.host, port=served.port, retries=0) as client,
        ):
            yield client

    return connect


def test_levels_are_read_as_floats(master, told) -> None:
    told(level_1=1.5, level_2=-0.1)
    with master() as client:
        found = client.read_input_registers(0, count=4)
    # 1.5 and −0.1 in IEEE 754: 3FC00000 and BDCCCCCD.
    assert found.registers == [0x3FC0, 0x0000, 0xBDCC, 0xCCCD]


def test_all_of_a_request_is_of_one_sample(master, told, table) -> None:
    told(**{"level_1": 2.5, "plant.watchdog": 7.0})
    with master() as client:
        words = client.read_input_registers(0, count=WATCHDOG + 1).registers
        copies = client.read_holding_registers(1000, count=WATCHDOG + 1).registers
    assert words[WATCHDOG] == 7
    assert struct.unpack(">f", struct.pack(">HH", *words[:2])) == (2.5,)
    assert words == copies


def test_a_value_is_written(master, told, table) -> None:
    told()
    words = list(struct.unpack(">HHHH", struct.pack(">ff", 3.25, 6.5)))
    with master() as client:
        assert not client.write_registers(PUMP_1, words).isError()
        assert client.read_holding_registers(PUMP_1, count=4).registers == words
        assert not client.write_registers(STATUS_1, [0x0007, 0xFFFF]).isError()
        assert not client.write_register(HEARTBEAT, 9).isError()
        assert not client.write_coil(1, True).isError()
        assert client.read_coils(0, count=2).bits[:2] == [False, True]
    read = {name: table.read(tag).value for name, tag in table.tags.items()}
    assert (read["pump_1.out"], read["pump_2.out"]) == (3.25, 6.5)
    assert (read["pump_1.status"], read["controller.heartbeat"]) == (524287.0, 9.0)
    assert read["operator.remote"] == 1.0


def test_counts_of_a_card(master, told, tags, table) -> None:
    told(level_1=5.0, level_2=12.0)
    with master(default_map(tags, Encoding.COUNTS_27648)) as client:
        # Half of 27648; and the last code of over-range.
        assert client.read_input_registers(0, count=2).registers == [13824, 32511]
        assert not client.write_registers(0, [6912, 0xED00]).isError()
    assert table.read(table.tags["pump_1.out"]).value == 2.5
    # −4864 is one count further than 32511 is on the other side; it is taken as the lowest.
    assert table.read(table.tags["pump_2.out"]).value == table.tags["pump_2.out"].lowest


REFUSED = {
    "an address with nothing": (lambda c: c.read_input_registers(500), 2),
    "a request over the end": (lambda c: c.read_input_registers(WATCHDOG, count=2), 2),
    "half of a float": (lambda c: c.write_register(PUMP_1, 0x4000), 2),
    "the second half": (lambda c: c.write_registers(PUMP_1 + 1, [0]), 2),
    "a float and a half": (lambda c: c.write_registers(PUMP_1, [0x4000, 0, 0x4000]), 2),
    "what the plant writes": (lambda c: c.write_registers(1000, [0x4000, 0]), 2),
    "no number": (lambda c: c.write_registers(PUMP_1, [0x7FC0, 0]), 3),
    "infinity": (lambda c: c.write_registers(PUMP_1, [0x7F80, 0]), 3),
    "beyond over-range": (lambda c: c.write_registers(PUMP_1, [0x4140, 0]), 3),  # 12 V of 11.76
    "a mode that there is not": (lambda c: c.write_register(MODE_1, 3), 3),
    "one of two": (lambda c: c.write_registers(PUMP_1, [0x4000, 0, 0x7FC0, 0]), 3),
    "a coil that is not there": (lambda c: c.write_coil(2, True), 2),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_refused_changes_nothing(master, told, table, case) -> None:
    request, code = REFUSED[case]
    told()
    before = table.image.written()
    with master() as client:
        found = request(client)
    assert found.isError() and found.exception_code == code
    assert table.image.written().tolist() == before.tolist()


def test_a_rig_that_is_read_only(master, told, table) -> None:
    told()
    before = table.image.written()
    with master(read_only=True) as client:
        assert client.write_registers(PUMP_1, [0x4000, 0]).exception_code == 1
        assert client.write_coil(1, True).exception_code == 1
        assert not client.read_holding_registers(PUMP_1, count=2).isError()
    assert table.image.written().tolist() == before.tolist()


def test_before_the_first_sample_it_is_busy(master) -> None:
    with master() as client:
        assert client.read_input_registers(0, count=2).exception_code == 6


def test_units(master, told) -> None:
    told()
    with master(units=(1, 7)) as client:
        assert not client.read_input_registers(0, device_id=7).isError()
        assert client.read_input_registers(0, device_id=2).exception_code == 11
    with master() as client:
        assert not client.read_input_registers(0, device_id=200).isError()


def test_a_port_in_use_is_refused(tags) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with refused(place="Modbus TCP", expected="a port that is free", remedy="another port"):
            ModbusDoor(default_map(tags), port=port).check()


def test_a_port_that_is_taken_at_the_last_moment_is_reported(tags, table) -> None:
    reports = []
    with socket.create_server(("127.0.0.1", 0)) as other:
        door = ModbusDoor(default_map(tags), port=other.getsockname()[1])
        asyncio.run(door.serve(table, Reporter(door.title, reports.append)))
    (report,) = reports
    assert report.kind is Kind.REFUSED
    assert "which is in use" in report.words


def test_what_is_refused_before_it_starts(tags) -> None:
    known = default_map(tags)
    with refused(value="10.0.0.0/33", expected="an address or a network"):
        ModbusDoor(known, port=0, peers=("10.0.0.0/33",)).check()
    with refused(value=256, expected="from 0 to 255"):
        ModbusDoor(known, port=0, units=(256,)).check()
    # TEST-NET-1 of RFC 5737 is nobody's.
    with refused(expected="127.0.0.1"):
        ModbusDoor(known, port=0, host="192.0.2.1").check()
