"""A controller reads and writes tags by OPC UA."""

import asyncio
import math
from dataclasses import replace

import pytest
from refusals import refused
from rig.opc_ua.held_rig import TAGS, held_rig

from clepsydra.rig.bus import BusFault
from clepsydra.rig.doors.opc_ua.client import OpcUaBus, access_to_rig
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.node_map import NodeMap, nodes_of_rig, read_node_map


def access_of(rig, **changes):
    identity = Identity(rig.folder / "controller", "controller")
    return replace(access_to_rig(rig.address, rig.certificates, identity), **changes)


def on(bus, scenario):
    async def run():
        try:
            return await scenario(bus)
        finally:
            await bus.close()

    return asyncio.run(run())


async def until(bus, name, value):
    while (await bus.read([name]))[name] != value:
        await asyncio.sleep(0.01)


@pytest.mark.thorough
@pytest.mark.parametrize("policy", ["Basic256Sha256", "Aes256Sha256RsaPss"])
def test_a_controller_reads_and_writes(rig, policy):
    rig.show(level__pv=41.5, level__good=1.0)

    async def scenario(bus):
        await bus.open()
        await until(bus, "level.pv", 41.5)
        await bus.write({"pump.out": 33.25, "pump.status": 5.0, "operator.remote": 1.0})
        await bus.write({"pump.bits": 300000.0})
        return await bus.read(
            ["level.good", "pump.out", "pump.status", "operator.remote", "pump.bits"]
        )

    bus = OpcUaBus(access_of(rig, policy=policy), nodes_of_rig(TAGS))
    assert [*on(bus, scenario).values()] == [1.0, 33.25, 5.0, 1.0, 300000.0]
    assert rig.image.read("pump.out") == 33.25


@pytest.mark.thorough
def test_a_value_of_a_failed_sensor_stays_what_it_was(rig):
    rig.show(level__pv=20.0, level__good=0.0)

    async def scenario(bus):
        await until(bus, "level.good", 0.0)
        before = await bus.read(["level.pv"])
        rig.show(level__pv=21.0, level__good=1.0)
        await until(bus, "level.pv", 21.0)
        rig.show(level__pv=90.0, level__good=0.0)
        await until(bus, "level.good", 0.0)
        return before["level.pv"], (await bus.read(["level.pv"]))["level.pv"]

    bus = OpcUaBus(access_of(rig), nodes_of_rig(TAGS))
    before, after = on(bus, scenario)
    assert math.isnan(before)
    assert after == 21.0


@pytest.mark.thorough
def test_what_the_server_refuses_is_a_fault_and_the_bus_goes_on(rig):
    async def scenario(bus):
        faults = []
        for values in ({"pump.out": 500.0}, {"level.pv": 1.0}, {"pump.status": 70000.0}):
            with pytest.raises(BusFault) as fault:
                await bus.write(values)
            faults.append((fault.value.tag, fault.value.words, fault.value.answered))
        await bus.write({"pump.out": 11.0})
        return faults, await bus.read(["pump.out"])

    faults, read = on(OpcUaBus(access_of(rig), nodes_of_rig(TAGS)), scenario)
    assert faults == [
        ("pump.out", "BadOutOfRange", True),
        ("level.pv", "BadNotWritable", True),
        ("pump.status", "70000 does not go into UInt16", True),
    ]
    assert read == {"pump.out": 11.0}


@pytest.mark.thorough
def test_a_node_that_is_not_there_is_named(rig):
    nodes = NodeMap({"pump.out": "nsu=urn:clepsydra:rig;s=no.such"}, {})
    with pytest.raises(BusFault, match=r"pump.out: nsu=urn:clepsydra:rig;s=no.such: BadNodeId"):
        on(OpcUaBus(access_of(rig), nodes), lambda bus: bus.open())


@pytest.mark.thorough
def test_a_bus_connects_anew_where_the_server_was_away(tmp_path):
    with held_rig(tmp_path) as rig:
        rig.show(level__pv=1.0)
        access = access_of(rig)
        port = int(rig.address.rpartition(":")[2].partition("/")[0])
        bus = OpcUaBus(access, nodes_of_rig(TAGS))
        loop = asyncio.new_event_loop()
        loop.run_until_complete(bus.write({"pump.out": 3.0}))
    with pytest.raises(BusFault) as fault:
        loop.run_until_complete(bus.read(["pump.out"]))
    assert not fault.value.answered
    with held_rig(tmp_path, port=port) as rig:
        rig.show(level__pv=1.0)
        loop.run_until_complete(bus.write({"pump.out": 4.0}))
        loop.run_until_complete(bus.close())
        assert rig.image.read("pump.out") == 4.0
    loop.close()


@pytest.mark.parametrize(
    ("text", "line", "value"),
    [
        ("tag,address\npump.out,ns=2;s=a\n", 1, "tag, address"),
        ("tag,node\npump.aut,ns=2;s=a\n", 2, "pump.aut"),
        ("tag,node\npump.out,ns=2;s=a\npump.out,ns=2;s=b\n", 3, "pump.out"),
        ("tag,node\npump.out,ns=x;s=a\n", 2, "ns=x;s=a"),
        ("tag,node\npump.out,ns=2;i=-4\n", 2, "ns=2;i=-4"),
        ("tag,node\npump.out,level\n", 2, "level"),
    ],
)
def test_a_map_that_is_none_is_refused(tmp_path, text, line, value):
    path = tmp_path / "nodes.csv"
    path.write_text(text)
    with refused(place=f"{path}, line {line}", value=value):
        read_node_map(path, TAGS)
