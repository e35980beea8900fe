"""Ten thousand wrong requests and frames, while a page is served that does everything right."""

import json
import random
import socket
import struct

import pytest
from waiting import wait_until

pytestmark = pytest.mark.thorough
#: A frame that is wrong ends its connection.
HTTP, FRAMES, A_CONNECTION = 5000, 5000, 4
#: A frame as a client sends it: masked, of no more than 125 bytes.
MASK = b"\x01\x02\x03\x04"


def frame(payload, opcode=1, final=True):
    masked = bytes(byte ^ MASK[place % 4] for place, byte in enumerate(payload))
    return struct.pack("!BB", opcode | (128 if final else 0), 128 | len(payload)) + MASK + masked


def mutated(draw, data):
    """Return data with some bytes replaced, left out, doubled, or moved."""
    found = bytearray(data)
    for _ in range(draw.randint(1, 6)):
        place = draw.randrange(len(found) + 1)
        match draw.randrange(4):
            case 0:
                found[place : place + 1] = bytes([draw.randrange(256)])
            case 1:
                del found[place : place + draw.randint(1, 8)]
            case 2:
                found[place:place] = draw.randbytes(draw.randint(1, 8))
            case _:
                found[place:place] = found[: draw.randint(1, 32)]
    return bytes(found) or b"\0"


def sent(port, *parts):
    """Send parts over one connection, as far as they are taken; never wait for an answer."""
    with socket.create_connection(("127.0.0.1", port)) as connection:
        try:
            for part in parts:
                connection.sendall(part)
            connection.setblocking(False)
            connection.recv(4096)
        except OSError:
            pass


def opened(port):
    """Return a socket whose opening handshake is over."""
    connection = socket.create_connection(("127.0.0.1", port))
    connection.sendall(handshake(port))
    seen = b""
    while b"\r\n\r\n" not in seen:
        seen += connection.recv(4096)
    assert seen.startswith(b"HTTP/1.1 101")
    return connection


def handshake(port):
    return (
        f"GET /rig HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Version: 13\r\n\r\n"
    ).encode()


def still_serves(served, page):
    served.bench.step()
    page.send('{"input": "level_1.setpoint", "value": 6.5}')
    taken = {"taken": served.bench.plant.sample}
    while (told := page.recv(timeout=600)) is None or isinstance(told, bytes) or (
        json.loads(told) != taken
    ):  # fmt: skip
        pass
    wait_until(lambda: is_answered(served))


def is_answered(served):
    """Whether another page is let in: while hundreds of connections close, one is turned away."""
    try:
        return served.ask()[0] == 200
    except ConnectionError:
        return False


def test_wrong_requests_do_not_stop_it(serving):
    draw = random.Random(36)
    with serving() as served, served.connect() as page:
        for number in range(HTTP):
            sent(served.port, mutated(draw, handshake(served.port)))
            if number % 500 == 0:
                still_serves(served, page)
        still_serves(served, page)


def test_wrong_frames_do_not_stop_it(serving):
    draw = random.Random(37)
    touches = [
        b'{"input": "pump_1.mode", "value": 1}',
        b'{"noise": false}',
        b'{"drift": "level_1", "rate": 0}',
    ]
    with serving() as served, served.connect() as page:
        for number in range(FRAMES // A_CONNECTION):
            with opened(served.port) as connection:
                try:
                    for _ in range(A_CONNECTION):
                        whole = frame(draw.choice(touches), draw.choice((0, 1, 1, 2, 8, 9, 10)),
                                      draw.random() < 0.9)  # fmt: skip
                        connection.sendall(mutated(draw, whole) if draw.random() < 0.7 else whole)
                except OSError:
                    pass
            if number % 250 == 0:
                still_serves(served, page)
        still_serves(served, page)
        written = served.bench.image.read
        assert written("pump_1.mode") in (0.0, 1.0, 2.0)
