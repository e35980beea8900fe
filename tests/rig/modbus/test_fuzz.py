"""Frames that nobody should send never stop a door, and a client beside is served throughout.

A million frames, which takes minutes: `CLEPSYDRA_FUZZED_FRAMES=1000000 pytest -m thorough
tests/rig/modbus/test_fuzz.py`.
"""

import os
import random
import socket
from collections.abc import Iterator
from contextlib import suppress

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clepsydra.rig.doors.modbus.functions import answer
from clepsydra.rig.doors.modbus.limits import Limits
from clepsydra.rig.doors.modbus.register_map import default_map
from clepsydra.rig.doors.modbus.registers import Registers
from clepsydra.rig.tag import Writer

FRAMES = int(os.environ.get("CLEPSYDRA_FUZZED_FRAMES", "10000"))
#: The functions that a door has.
SERVED = (1, 2, 3, 4, 5, 6, 15, 16, 22, 23)
READ = bytes.fromhex("0001 0000 0006 01 04 000c 0001")
ANSWER = bytes.fromhex("0001 0000 0005 01 04 02 0005")
#: Valid requests that are mutated: of every function that there is, and of some that there are not.
REQUESTS = [
    bytes.fromhex(text)
    for text in (
        "01 0000 0002", "02 0000 0004", "03 0000 0004", "03 03e8 0010", "04 0000 000d",
        "05 0001 ff00", "06 0008 0011", "0f 0000 0002 01 02", "10 0000 0004 08 40400000 40800000",
        "16 0008 00f2 0025", "17 0000 0004 0000 0002 04 40400000", "2b 0e 01 00", "08 0000 a537",
        "07", "11", "14 07 06 0001 0000 0002", "18 0000",
    )
]  # fmt: skip


def frames(seed: int, count: int) -> Iterator[bytes]:
    draws = random.Random(seed)
    for _ in range(count):
        pdu = bytearray(draws.choice(REQUESTS))
        kind = draws.randrange(6)
        if kind == 0:
            yield draws.randbytes(draws.randrange(1, 300))
            continue
        if kind == 1:
            pdu = bytearray(draws.randbytes(draws.randrange(1, 254)))
        elif kind == 2:
            pdu[draws.randrange(len(pdu))] = draws.randrange(256)
        elif kind == 3:
            pdu = pdu[: draws.randrange(len(pdu) + 1)]
        elif kind == 4:
            pdu += draws.randbytes(draws.randrange(1, 40))
        length = 1 + len(pdu)
        if kind == 5:
            length = draws.choice([0, 1, length - 1, length + 1, 254, 255, 65535, length])
        header = draws.randbytes(2) + b"\0\0" + length.to_bytes(2, "big") + draws.randbytes(1)
        yield header + bytes(pdu)


class Unruly:
    """A client that takes what it is answered and sends what it likes.

    Attributes
    ----------
    answered : set of tuple
        Functions that were answered, and by which exception; 0 for none.
    """

    def __init__(self, served) -> None:
        self._served = served
        self.answered: set[tuple[int, int]] = set()
        self._connect()

    def _connect(self) -> None:
        self._socket = socket.create_connection((self._served.host, self._served.port))
        self._socket.settimeout(60.0)

    def send(self, frame: bytes) -> None:
        """Send a frame; where the last one ended the connection, on a new one."""
        try:
            self._socket.sendall(frame)
        except ConnectionError:
            self.close()
            self._connect()
            self._socket.sendall(frame)

    def take(self) -> None:
        """Take what has been answered."""
        try:
            self._socket.setblocking(False)
            with suppress(BlockingIOError):
                while data := self._socket.recv(65536):
                    self._take(data)
                raise ConnectionResetError
        except ConnectionError:
            self.close()
            self._connect()
        self._socket.settimeout(60.0)

    def _take(self, data: bytes) -> None:
        while len(data) > 8:
            code, why = data[7:9]
            self.answered.add((code & 0x7F, why if code & 0x80 else 0))
            data = data[6 + int.from_bytes(data[4:6], "big") :]

    def close(self) -> None:
        self._socket.close()


def bombard(serving, told, table, count: int) -> set[tuple[int, int]]:
    """Send frames, and return what was answered."""
    told(**{"plant.watchdog": 5.0})
    limits = Limits(requests_per_second=1e9)
    with (
        serving(limits=limits) as served,
        socket.create_connection((served.host, served.port)) as beside,
    ):
        beside.settimeout(60.0)
        unruly = Unruly(served)
        for number, frame in enumerate(frames(1, count)):
            unruly.send(frame)
            # Once this is answered, the frame was taken too.
            beside.sendall(READ)
            assert beside.recv(len(ANSWER), socket.MSG_WAITALL) == ANSWER, number
            unruly.take()
        unruly.close()
    for tag in table.tags.values():
        if tag.writer is not Writer.PLANT:
            table.check(tag, table.read(tag).value)
    return unruly.answered


def test_a_few_frames(serving, told, table) -> None:
    # Some are answered, and some by each exception.
    assert {why for _, why in bombard(serving, told, table, 500)} == {0, 1, 2, 3}


@pytest.mark.thorough
def test_many_frames(serving, told, table) -> None:
    found = bombard(serving, told, table, FRAMES)
    assert found >= {(code, why) for code in SERVED for why in (0, 2)}


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(code=st.integers(0, 255), rest=st.binary(max_size=252))
def test_every_request_has_an_answer_of_its_function(tags, table, told, code, rest) -> None:
    told()
    found = answer(bytes([code]) + rest, Registers(default_map(tags), table, read_only=False))
    assert found[0] in (code, code | 0x80)
    assert 2 <= len(found) <= 253
    if found[0] & 0x80:
        assert len(found) == 2 and found[1] in (1, 2, 3)
