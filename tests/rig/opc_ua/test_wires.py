"""What an instructor does to the wires of OPC UA."""

import asyncio

import pytest
from tools import missing

from clepsydra.rig.bus import BusFault
from clepsydra.rig.doors.opc_ua import client as opc_ua_client
from clepsydra.rig.doors.opc_ua.client import OpcUaBus, access_to_rig
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.node_map import nodes_of_rig
from clepsydra.rig.tag import WIRE_CUT, WIRE_DELAY, WIRE_LOSS

pytestmark = pytest.mark.thorough

if not missing("asyncua", "cryptography"):
    from rig.opc_ua.held_rig import TAGS


@pytest.fixture
def bus(rig, monkeypatch):
    monkeypatch.setattr(opc_ua_client, "_PATIENCE", 0.5)
    identity = Identity(rig.folder / "controller", "controller")
    yield OpcUaBus(access_to_rig(rig.address, rig.certificates, identity), nodes_of_rig(TAGS))
    for cell in (WIRE_CUT, WIRE_DELAY, WIRE_LOSS):
        rig.image.write(cell, 0.0)


def test_a_request_that_is_lost_has_no_answer_and_the_next_one_has(rig, bus):
    async def scenario():
        await bus.write({"pump.out": 1.0})
        rig.image.write(WIRE_LOSS, 1.0)
        with pytest.raises(BusFault) as fault:
            await bus.write({"pump.out": 2.0})
        lost = rig.image.read("pump.out")
        rig.image.write(WIRE_LOSS, 0.0)
        await bus.write({"pump.out": 3.0})
        await bus.close()
        return fault.value.answered, lost

    assert asyncio.run(scenario()) == (False, 1.0)
    assert rig.image.read("pump.out") == 3.0


def test_a_cable_that_is_pulled_ends_all_and_lets_nobody_in(rig, bus):
    async def scenario():
        await bus.write({"pump.out": 1.0})
        rig.image.write(WIRE_CUT, 1.0)
        answered = []
        for _ in range(2):
            with pytest.raises(BusFault) as fault:
                await bus.write({"pump.out": 2.0})
            answered.append(fault.value.answered)
        rig.image.write(WIRE_CUT, 0.0)
        await bus.write({"pump.out": 3.0})
        await bus.close()
        return answered

    assert asyncio.run(scenario()) == [False, False]
    assert rig.image.read("pump.out") == 3.0


def test_an_answer_comes_later_by_a_delay(rig, bus):
    async def scenario():
        await bus.write({"pump.out": 1.0})
        loop = asyncio.get_running_loop()
        rig.image.write(WIRE_DELAY, 0.2)
        order = []
        answered = asyncio.ensure_future(bus.write({"pump.out": 2.0}))
        answered.add_done_callback(lambda _: order.append("answer"))
        loop.call_later(0.15, order.append, "0.15 s")
        await answered
        rig.image.write(WIRE_DELAY, 0.0)
        await bus.close()
        return order

    assert asyncio.run(scenario()) == ["0.15 s", "answer"]
