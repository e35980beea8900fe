"""Whatever strangers send, a door of OPC UA goes on, and serves those who are served already.

CLEPSYDRA_FUZZED_FRAMES=1000000 sends a million frames in place of 10,000.
"""

import asyncio
import os
from contextlib import suppress

import pytest
from tools import missing

pytestmark = pytest.mark.thorough

FRAMES = int(os.environ.get("CLEPSYDRA_FUZZED_FRAMES", "10000"))
if not missing("asyncua", "cryptography"):
    from asyncua import Client
    from rig.opc_ua.clients import connected, node
    from rig.opc_ua.held_rig import held_rig
    from rig.opc_ua.strange_frames import HELLO, Frames, Talk


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    with held_rig(tmp_path_factory.mktemp("rig"), anonymous=True) as found:
        found.show(level__pv=33.0)
        yield found


async def answer(reader):
    """Return a whole message of the server; nothing where it has closed the connection."""
    head = await reader.readexactly(8)
    return head + await reader.readexactly(int.from_bytes(head[4:8], "little") - 8)


class Stranger:
    """One connection, which sends frames until the server ends it."""

    def __init__(self, port, frames):
        self.port, self.frames = port, frames

    async def send(self, way):
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        sent = 0
        try:
            async with asyncio.timeout(20.0):
                sent = await getattr(self, way)(reader, writer)
                await writer.drain()
                await self._heard_out(reader)
        except (OSError, asyncio.IncompleteReadError, TimeoutError):
            sent = max(sent, 1)
        finally:
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()
        return sent

    async def _heard_out(self, reader):
        """Stay until the server has nothing more to say: it forgets what is left of who leaves."""
        with suppress(TimeoutError):
            while True:
                async with asyncio.timeout(0.05):
                    if not await reader.read(1 << 16):
                        return

    async def first(self, reader, writer):
        writer.write(self.frames.random_bytes())
        return 1

    async def headed(self, reader, writer):
        for _ in range(5):
            writer.write(self.frames.with_a_head())
        return 5

    async def after_a_hello(self, reader, writer):
        writer.write(HELLO)
        await answer(reader)
        for _ in range(5):
            writer.write(self.frames.with_a_head())
        return 5

    async def changed_opening(self, reader, writer):
        writer.write(self.frames.changed(HELLO))
        writer.write(self.frames.changed(Talk().open()))
        return 2

    async def in_a_channel(self, reader, writer):
        talk = await self._opened(reader, writer)
        for request in talk.requests(2):
            writer.write(self.frames.changed(talk.message(request)))
        writer.write(self.frames.changed(talk.session()))
        return 9

    async def in_a_session(self, reader, writer):
        talk = await self._opened(reader, writer)
        writer.write(talk.session())
        created = await answer(reader)
        talk.token = _token_in(created)
        writer.write(talk.activation())
        await answer(reader)
        requests = talk.requests(2)
        self.frames.draws.shuffle(requests)
        for request in requests:
            writer.write(self.frames.changed(talk.message(request)))
        return len(requests)

    async def _opened(self, reader, writer):
        talk = Talk()
        writer.write(HELLO)
        await answer(reader)
        writer.write(talk.open())
        talk.opened(await answer(reader))
        return talk


def _token_in(created):
    from asyncua import ua
    from asyncua.common.utils import Buffer
    from asyncua.ua.ua_binary import struct_from_binary

    return struct_from_binary(
        ua.CreateSessionResponse, Buffer(created[24:])
    ).Parameters.AuthenticationToken


WAYS = ("first", "headed", "after_a_hello", "changed_opening", "in_a_channel", "in_a_session")


def test_frames_of_strangers_stop_nobody(rig):
    port = int(rig.address.rpartition(":")[2].partition("/")[0])
    stranger = Stranger(port, Frames(seed=7))

    async def scenario():
        sent = dict.fromkeys(WAYS, 0)
        async with connected(rig) as client:
            level = 0
            while sum(sent.values()) < FRAMES:
                for way in WAYS:
                    sent[way] += await stranger.send(way)
                level += 1
                await node(client, "pump.out").write_value(float(level % 100))
                assert await node(client, "pump.out").read_value() == float(level % 100)
        async with connected(rig) as client:
            return sent, await node(client, "level.pv").read_value()

    sent, read = asyncio.run(scenario())
    assert read == 33.0
    # Each way goes on as far as it is meant to: the frames behind an opening are most.
    assert all(count > FRAMES // 50 for count in sent.values())


def test_a_head_that_promises_much_is_let_go(rig):
    port = int(rig.address.rpartition(":")[2].partition("/")[0])

    async def scenario():
        _, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(b"HELF" + (1 << 31).to_bytes(4, "little"))
        taken = 0
        with suppress(OSError):
            while taken < 1 << 28:
                writer.write(bytes(1 << 16))
                await writer.drain()
                taken += 1 << 16
        writer.transport.abort()
        return taken

    # What the sockets hold is less.
    assert asyncio.run(scenario()) < 1 << 26


def test_fifty_clients_are_served_at_once(rig):
    async def one(number):
        async with connected(rig) as client:
            for _ in range(5):
                value = await node(client, "level.pv").read_value()
            return value

    async def scenario():
        return await asyncio.gather(*(one(number) for number in range(50)))

    assert asyncio.run(scenario()) == 50 * [33.0]


def test_nobody_has_more_sessions_than_there_are(rig):
    async def scenario():
        clients = []
        with pytest.raises(Exception, match=r"(?i)session|connection"):
            for _ in range(140):
                client = Client(rig.address)
                await client.connect()
                clients.append(client)
        there = len(clients)
        await clients[0].get_namespace_array()
        for client in clients:
            await client.disconnect()
        async with Client(rig.address) as client:
            return there, len(await client.get_namespace_array())

    there, namespaces = asyncio.run(scenario())
    assert there <= 100
    assert namespaces == 3


def test_a_client_that_takes_nothing_is_let_go_and_others_are_served(rig):
    port = int(rig.address.rpartition(":")[2].partition("/")[0])

    async def scenario():
        reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=4096)
        stranger = Stranger(port, Frames(seed=1))
        talk = await stranger._opened(reader, writer)
        writer.write(talk.session())
        talk.token = _token_in(await answer(reader))
        writer.write(talk.activation())
        await answer(reader)
        # From now on it asks for much, and reads no answer.
        reader._transport.pause_reading()
        browse = talk.requests(2)[2]
        browse.Parameters.NodesToBrowse = 400 * browse.Parameters.NodesToBrowse
        async with connected(rig) as client:
            for _ in range(3000):
                if any("did not take" in words for words in rig.words()):
                    break
                if not writer.transport.is_closing():
                    writer.write(talk.message(browse))
                assert await node(client, "level.pv").read_value() == 33.0
        writer.transport.abort()

    asyncio.run(scenario())
    assert any("did not take" in words for words in rig.words())
