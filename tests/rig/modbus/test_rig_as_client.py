"""A rig as the client of a PLC: from the address on its command line to the plant that moves."""

import struct

import pytest
from refusals import refused
from waiting import wait_until

import clepsydra as cl
from clepsydra.rig.doors.modbus.client_door import ModbusClientDoor
from clepsydra.rig.doors.opc_ua.client_door import OpcUaClientDoor

#: As the registers of OpenPLC are laid out: %MW0 is holding register 1024, %QW0 register 0.
MAP = """tag,table,address,encoding
level_1.pv,holding register,124,float32
level_1.good,coil,5,bit
pump_1.out,holding register,0,float32
pump_2.out,holding register,2,float32
controller.heartbeat,holding register,4,uint16
"""
NODES = "tag,node\nlevel_1.pv,ns=4;s=GVL.level\npump_1.out,ns=4;s=GVL.pump\n"


@pytest.fixture
def built(tmp_path):
    def build(address, text=MAP):
        (tmp_path / "plc.csv").write_text(text)
        doors = cl.Doors((), client=address, client_map=tmp_path / "plc.csv")
        (door,) = cl.run_rig("quadruple-tank", folder=tmp_path, doors=doors).settings.doors
        return door

    return build


def test_an_address_says_where_the_plc_is(built):
    assert built("modbus://plc.local").address == "plc.local:502"
    found = built("modbus://[::1]:1502?unit=7")
    assert isinstance(found, ModbusClientDoor)
    assert (found.host, found.port, found.unit, found.period) == ("::1", 1502, 7, 0.1)
    assert {entry.tag.name for entry in found.register_map.entries} >= {"level_1.pv", "pump_1.out"}


def test_an_address_says_how_to_come_in(built):
    pytest.importorskip("asyncua")
    found = built(
        "opc.tcp://10.0.0.2:4840/plc?user=rig&password-file=secret&certificate=plc.der", NODES
    )
    assert isinstance(found, OpcUaClientDoor)
    access = found.access
    assert access.address == "opc.tcp://10.0.0.2:4840/plc" and access.user == "rig"
    assert (access.server_certificate.name, access.password_file.name) == ("plc.der", "secret")
    assert access.policy == "Basic256Sha256"


@pytest.mark.parametrize(
    ("address", "told"),
    [
        ("192.168.0.10", "modbus://192.168.0.10"),
        ("http://192.168.0.10", "modbus://192.168.0.10"),
        ("modbus://", "modbus://192.168.0.10"),
        ("modbus://plc:port", "modbus://192.168.0.10"),
        ("modbus://plc/tanks", "modbus://192.168.0.10"),
        ("modbus://plc?unti=1", "perhaps 'unit' was meant"),
        ("modbus://plc?unit=-1", "unit=1"),
        ("modbus://rig:secret@plc", "leave it out"),
    ],
)
def test_what_is_no_address_is_refused(built, address, told):
    with pytest.raises(cl.InputError, match="client") as error:
        built(address)
    assert told in str(error.value) and "secret" not in str(error.value)


def test_a_map_and_an_address_belong_together(tmp_path):
    folder = tmp_path / "rig"
    with refused(place="rig, client_map"):
        cl.run_rig("quadruple-tank", folder=folder, doors=cl.Doors((), client="modbus://plc"))
    with refused(place="rig, client", remedy='client="modbus://192.168.0.10"'):
        cl.run_rig("quadruple-tank", folder=folder, doors=cl.Doors((), client_map="plc.csv"))
    assert not folder.exists()


@pytest.mark.thorough
def test_a_plc_that_is_a_server_moves_the_plant_and_its_silence_is_told(plc, free_port, tmp_path):
    (tmp_path / "plc.csv").write_text(MAP.replace("level_1.good,coil,5,bit\n", ""))
    doors = cl.Doors((), client=f"modbus://127.0.0.1:{free_port}", client_map=tmp_path / "plc.csv")
    with cl.run_rig(
        "quadruple-tank", folder=tmp_path / "rig", doors=doors, speed=20.0, silence="0.5 s"
    ) as running:
        table = running.table

        def position(volts):
            list(running.watch(0.05))
            return table.read(table.tags["pump_1.position"]).value == volts

        def told(words):
            return any(words in each.words for each in running.watch(0.05))

        with plc() as client:
            beat = iter(range(1, 60_000))

            def commands(volts):
                # What a PLC does at the end of a scan: all outputs at once.
                words = struct.unpack(">HHHH", struct.pack(">ff", volts, 3.0))
                client.write_registers(0, [*words, next(beat)])
                return position(volts)

            wait_until(lambda: commands(3.5))
            wait_until(lambda: commands(4.5))

            def shown():
                registers = client.read_holding_registers(124, count=2).registers
                return struct.unpack(">f", struct.pack(">HH", *registers))[0]

            rising = shown()
            wait_until(lambda: commands(4.5) and shown() > rising + 0.1)
            # A PLC in STOP still answers, and counts no scans.
            wait_until(lambda: told("fail-safe"))
            wait_until(lambda: position(0.0))
            wait_until(lambda: commands(4.0))
        wait_until(lambda: position(0.0))
    events = [words for (words,) in _asked(running, "SELECT words FROM events")]
    assert any("heard again" in words for words in events)
    assert any("127.0.0.1" in words and "PLC answers" not in words for words in events)


def _asked(running, sql):
    import sqlite3
    from contextlib import closing

    with closing(sqlite3.connect(running.history.path)) as connection:
        return connection.execute(sql).fetchall()
