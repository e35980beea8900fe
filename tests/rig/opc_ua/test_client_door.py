"""A rig is the client of a PLC whose server has types of its own."""

import asyncio
import threading
from contextlib import contextmanager
from dataclasses import replace

import pytest
from refusals import refused
from rig.opc_ua.held_rig import TAGS, HeldRig
from tools import missing
from waiting import wait_until

from clepsydra.rig.doors.opc_ua.client import Access
from clepsydra.rig.doors.opc_ua.client_door import OpcUaClientDoor
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.node_map import NodeMap
from clepsydra.rig.report import Reporter

if not missing("asyncua", "cryptography"):
    from asyncua import Server, ua

NODES = {
    name: f"nsu=urn:plc;s=GVL.{name.replace('.', '_')}"
    for name in ("level.pv", "level.good", "plant.watchdog", "pump.out", "pump.status")
}
TYPES = {
    "level.pv": "Float",
    "level.good": "Boolean",
    "plant.watchdog": "UInt16",
    "pump.out": "Int16",
    "pump.status": "UInt32",
}
KNOWN = {tag.name: tag for tag in TAGS}


class Plc:
    """A PLC: its variables, as an OPC UA server in a thread."""

    def __init__(self, port=0):
        self.port, self.loop, self.nodes = port, asyncio.new_event_loop(), {}
        self._begun, self._end = threading.Event(), asyncio.Event()
        self._thread = threading.Thread(target=lambda: self.loop.run_until_complete(self._work()))

    async def _work(self):
        server = Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{self.port}/plc")
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        index = await server.register_namespace("urn:plc")
        for name, kind in TYPES.items():
            identifier = ua.NodeId(f"GVL.{name.replace('.', '_')}", index)
            value = ua.Variant(False if kind == "Boolean" else 0, ua.VariantType[kind])
            node = await server.nodes.objects.add_variable(identifier, name, value)
            await node.set_writable()
            self.nodes[name] = node
        await server.start()
        self.port = server.bserver.port
        self._begun.set()
        await self._end.wait()
        await server.stop()

    def __enter__(self):
        self._thread.start()
        self._begun.wait()
        return self

    def __exit__(self, *error):
        self.loop.call_soon_threadsafe(self._end.set)
        self._thread.join()
        self.loop.close()

    def _done(self, work):
        return asyncio.run_coroutine_threadsafe(work, self.loop).result()

    def read(self, name):
        return self._done(self.nodes[name].read_value())

    def write(self, name, value):
        self._done(self.nodes[name].write_value(ua.Variant(value, ua.VariantType[TYPES[name]])))


def door_to(port, folder, **changes):
    access = Access(f"opc.tcp://127.0.0.1:{port}/plc", Identity(folder, "rig"), policy="None")
    return replace(OpcUaClientDoor(access, NodeMap(NODES, KNOWN), period=0.02), **changes)


@contextmanager
def serving(rig, door):
    loop = asyncio.new_event_loop()
    task = loop.create_task(door.serve(rig.table, Reporter(door.title, rig.reports.append)))

    def work():
        with pytest.raises(asyncio.CancelledError):
            loop.run_until_complete(task)
        loop.close()

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        loop.call_soon_threadsafe(task.cancel)
        thread.join()


@pytest.mark.thorough
def test_the_plc_gets_what_the_plant_shows_and_moves_it_by_its_own_types(tmp_path):
    rig = HeldRig(tmp_path)
    with Plc() as plc:
        door = door_to(plc.port, tmp_path)
        door.check()
        with serving(rig, door):
            rig.show(level__pv=12.3, plant__watchdog=65535.0)
            wait_until(lambda: plc.read("plant.watchdog") == 65535)
            assert plc.read("level.pv") == pytest.approx(12.3, rel=2**-23)
            assert plc.read("level.good") is True
            plc.write("pump.out", 47)
            plc.write("pump.status", 513)
            wait_until(lambda: rig.image.read("pump.status") == 513.0)
            assert rig.image.read("pump.out") == 47.0
            plc.write("pump.out", 900)
            wait_until(lambda: any("900" in words for words in rig.words()))
            assert rig.image.read("pump.out") == 47.0


@pytest.mark.thorough
def test_a_plc_that_was_away_is_found_again(tmp_path):
    rig = HeldRig(tmp_path)
    rig.show(level__pv=1.0)
    with Plc() as plc:
        port = plc.port
        plc.write("pump.out", 10)
        loop = serving(rig, door_to(port, tmp_path))
        loop.__enter__()
        wait_until(lambda: rig.image.read("pump.out") == 10.0)
    wait_until(lambda: rig.words()[-1].startswith(f"OPC UA opc.tcp://127.0.0.1:{port}/plc"))
    with Plc(port) as plc:
        plc.write("pump.out", 20)
        wait_until(lambda: rig.image.read("pump.out") == 20.0)
        assert rig.words()[-1] == "the PLC answers"
        loop.__exit__(None, None, None)


@pytest.mark.parametrize(
    ("change", "value"),
    [
        (
            {"nodes": NodeMap({"level.pv": NODES["level.pv"]}, KNOWN)},
            "a map without outputs of the PLC",
        ),
        (
            {"nodes": NodeMap({"pump.out": NODES["pump.out"]}, KNOWN)},
            "a map without inputs of the PLC",
        ),
        ({"period": 0.0}, "0 s"),
    ],
)
def test_what_cannot_work_is_refused(tmp_path, change, value):
    with refused(value=value):
        door_to(4840, tmp_path, **change).check()


@pytest.mark.parametrize(
    ("change", "value"),
    [
        ({"address": "192.168.0.10:4840"}, "192.168.0.10:4840"),
        ({"policy": "Basic256"}, "Basic256"),
    ],
)
def test_a_way_in_that_is_none_is_refused(tmp_path, change, value):
    door = door_to(4840, tmp_path)
    with refused(place="OPC UA client", value=value):
        replace(door, access=replace(door.access, **change)).check()
