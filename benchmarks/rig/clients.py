"""The clients of a rig that is measured, each a process of its own, made of others' libraries."""

from __future__ import annotations

import asyncio
import logging
import struct
import time
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection

from clepsydra.rig.deadlines import Deadlines
from clepsydra.rig.plant_process import raise_priority

#: Registers that one request reads at most (Modbus Application Protocol V1.1b3, section 6.3).
_MOST_READ, _MOST_WRITTEN = 120, 120


@dataclass(frozen=True)
class Reads:
    """What a master asks for in a scan, in input registers from 0 on, and writes, as float32.

    Parameters
    ----------
    registers : int
        That it reads.
    commands : tuple of float
        That it writes into holding registers from 0 on; empty for a reader.
    heartbeat : int
        Where it counts its scans.
    period : float
        Of its scans [s].
    """

    registers: int
    commands: tuple[float, ...]
    heartbeat: int
    period: float


def scan(pipe: Connection, port: int, asked: Reads) -> None:
    """Scan as a PLC does, by pymodbus, until the pipe says so; tell how many scans were done."""
    from pymodbus.client import ModbusTcpClient

    words = [
        word
        for value in asked.commands
        for word in struct.unpack(">HH", struct.pack(">f", value))
    ]  # fmt: skip
    deadlines, scans, failed = Deadlines(asked.period, makes_up=False), 0, 0
    with ModbusTcpClient("127.0.0.1", port=port, timeout=5) as client:
        while not pipe.poll():
            deadlines.wait()
            answers = [
                client.read_input_registers(at, count=min(_MOST_READ, asked.registers - at))
                for at in range(0, asked.registers, _MOST_READ)
            ]
            answers += [
                client.write_registers(at, words[at : at + _MOST_WRITTEN])
                for at in range(0, len(words), _MOST_WRITTEN)
            ]
            if words:
                answers.append(client.write_register(asked.heartbeat, scans % 65536))
            scans += 1
            failed += any(answer.isError() for answer in answers)
    pipe.send(f"{scans - failed:,} scans" + (f", {failed} failed" if failed else ""))


def subscribe(pipe: Connection, address: str, tags: Sequence[str], interval: float) -> None:
    """Subscribe to tags, by asyncua, until the pipe says so; tell how many values came."""
    logging.getLogger("asyncua").setLevel(logging.ERROR)
    asyncio.run(_subscribed(pipe, address, tags, interval))


async def _subscribed(pipe: Connection, address: str, tags: Sequence[str], interval: float) -> None:
    from asyncua import Client

    heard = _Heard()
    async with Client(address) as client:
        index = await client.get_namespace_index("urn:clepsydra:rig")
        subscription = await client.create_subscription(1000.0 * interval, heard)
        await subscription.subscribe_data_change(
            [client.get_node(f"ns={index};s={name}") for name in tags]
        )
        while not pipe.poll():
            await asyncio.sleep(0.1)
    pipe.send(f"{heard.values:,} values")


class _Heard:
    """What counts values."""

    def __init__(self) -> None:
        self.values = 0

    def datachange_notification(self, *_: object) -> None:
        """Count one."""
        self.values += 1


def sleep_bare(pipe: Connection, period: float) -> None:
    """Sleep from deadline to deadline and do nothing else; send the lateness of each [s]."""
    # As the plant does, so that both are as the machine lets them.
    raise_priority()
    deadlines, found = Deadlines(period), []
    while not pipe.poll():
        deadlines.wait()
        found.append((time.time(), deadlines.lateness))
    pipe.send(found)
