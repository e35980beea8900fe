"""The rig as a client of a PLC: a server of pymodbus, and the test in the place of its program."""

import struct

import pytest
from refusals import refused
from waiting import wait_until

from clepsydra.rig.doors.modbus.client_door import ModbusClientDoor
from clepsydra.rig.doors.modbus.register_map import RegisterMap, default_map, map_of_plc
from clepsydra.rig.tag_table import WRITES

#: Where the map of a PLC has them: two commands, two status words, the heartbeat; then the plant.
PUMP_1, LEVEL_1 = 0, 100
WORDS = 200


@pytest.fixture
def door(tags, free_port) -> ModbusClientDoor:
    return ModbusClientDoor(map_of_plc(tags), "127.0.0.1", free_port, period=0.01, timeout=0.5)


def words(value: float) -> list[int]:
    return list(struct.unpack(">HH", struct.pack(">f", value)))


def scan(client, command: float, beat: int) -> None:
    """Do what a PLC does at the end of a scan: all outputs at once."""
    outputs = [*words(command), *words(2.0), *[0] * 4, beat]
    assert not client.write_registers(PUMP_1, outputs).isError()


def test_plant_and_plc_hear_each_other(plc, door, at_work, told, table) -> None:
    told(level_1=1.25)
    with plc() as client:
        scan(client, 3.5, beat=1)
        with at_work(door) as served:
            wait_until(
                lambda: client.read_holding_registers(LEVEL_1, count=2).registers == words(1.25)
            )
            wait_until(lambda: table.read(table.tags["controller.heartbeat"]).value == 1.0)
            assert table.read(table.tags["pump_1.out"]).value == 3.5
            told(level_1=1.5)
            scan(client, 4.5, beat=2)
            wait_until(lambda: table.read(table.tags["controller.heartbeat"]).value == 2.0)
            assert table.read(table.tags["pump_1.out"]).value == 4.5
    assert served.events == ["the PLC answers"]


def test_a_plc_in_stop_answers_and_is_not_heard(plc, door, at_work, told, table) -> None:
    told()
    with plc() as client, at_work(door):
        scan(client, 3.5, beat=1)
        wait_until(lambda: table.read(table.tags["controller.heartbeat"]).value == 1.0)
        heard = table.image.read(WRITES)
        # Without another beat its registers move nothing, though the exchange goes on.
        client.write_registers(PUMP_1, words(9.0))
        for level in (1.0, 2.0, 3.0):
            told(level_1=level)
            wait_until(
                lambda level=level: (
                    client.read_holding_registers(LEVEL_1, count=2).registers == words(level)
                )
            )
        assert table.image.read(WRITES) == heard
        assert table.read(table.tags["pump_1.out"]).value == 3.5


@pytest.mark.parametrize(("command", "told_off"), [(12.0, "outside"), (float("nan"), "finite")])
def test_what_no_tag_takes_is_reported_and_moves_nothing(
    plc, door, at_work, told, table, command, told_off
) -> None:
    told()
    with plc() as client:
        scan(client, command, beat=1)
        with at_work(door) as served:
            wait_until(lambda: served.events)
            assert "pump_1_out" in served.events[0] and told_off in served.events[0]
            assert table.image.read(WRITES) == 0.0
            scan(client, 3.0, beat=2)
            wait_until(lambda: table.read(table.tags["pump_1.out"]).value == 3.0)
    assert len(served.events) == 2


def test_an_exception_of_the_plc_is_reported_once_with_its_register(
    plc, door, at_work, told, table
) -> None:
    told()
    with plc(words=LEVEL_1) as client, at_work(door) as served:
        scan(client, 3.0, beat=1)
        wait_until(lambda: served.events)
        for beat in range(2, 5):
            scan(client, 3.0, beat)
        assert table.image.read(WRITES) == 0.0
    (event,) = served.events
    assert "write of holding registers 100 to " in event
    assert "exception 2, illegal data address" in event


def test_a_plc_that_is_switched_off_and_on(plc, door, at_work, told, table) -> None:
    told()
    with at_work(door) as served:
        wait_until(lambda: served.events)
        assert "nobody takes the connection" in served.events[0]
        assert table.image.read(WRITES) == 0.0
        for beat in (1, 2):
            with plc() as client:
                scan(client, 3.0, beat)
                wait_until(
                    lambda beat=beat: table.read(table.tags["controller.heartbeat"]).value == beat
                )
            wait_until(lambda beat=beat: len(served.events) >= 1 + 2 * beat)
    assert served.events[1] == "the PLC answers"
    assert "127.0.0.1" in served.events[2]


def test_what_is_refused_before_it_starts(tags, free_port) -> None:
    with refused(place="Modbus TCP client", expected="a map of the PLC's registers"):
        ModbusClientDoor(default_map(tags), "127.0.0.1").check()
    made = map_of_plc(tags)
    only_read = RegisterMap(
        tuple(e for e in made.entries if e.tag.writer.value == "controller"), made.server
    )
    with refused(expected="at least one tag of the plant", remedy="row"):
        ModbusClientDoor(only_read, "127.0.0.1").check()
    with refused(place="period", value="0 s"):
        ModbusClientDoor(made, "127.0.0.1", period=0.0).check()
    with refused(value=0, expected="a port"):
        ModbusClientDoor(made, "127.0.0.1", 0).check()
