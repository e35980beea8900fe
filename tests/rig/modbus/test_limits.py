"""What one client may take of a door, so that others are served: by raw sockets of loopback."""

import socket
from contextlib import ExitStack

import pytest
from waiting import wait_until

from clepsydra.rig.doors.modbus.limits import Limits
from clepsydra.rig.tag import WIRE_CUT, WIRE_DELAY, WIRE_LOSS

#: Read input register 12, which is the counter of the plant; 5 in these tests.
READ = bytes.fromhex("0001 0000 0006 01 04 000c 0001")
ANSWER = bytes.fromhex("0001 0000 0005 01 04 02 0005")


@pytest.fixture
def counted(told) -> None:
    told(**{"plant.watchdog": 5.0})


def connected(served) -> socket.socket:
    found = socket.create_connection((served.host, served.port))
    found.settimeout(60.0)
    return found


def ask(client: socket.socket, request: bytes = READ) -> bytes:
    client.sendall(request)
    return receive(client, len(ANSWER))


def receive(client: socket.socket, count: int) -> bytes:
    """Return so many bytes, or fewer where the other end has ended."""
    found = b""
    try:
        while len(found) < count:
            more = client.recv(count - len(found))
            if not more:
                break
            found += more
    except ConnectionError:
        pass
    return found


def test_fifty_clients_are_served(serving, counted) -> None:
    with serving() as served, ExitStack() as stack:
        clients = [stack.enter_context(connected(served)) for _ in range(50)]
        for _ in range(3):
            for client in clients:
                client.sendall(READ)
            assert [receive(client, len(ANSWER)) for client in clients] == [ANSWER] * 50


def test_one_client_too_many_is_turned_away(serving, counted) -> None:
    with serving(limits=Limits(clients=2)) as served:
        with connected(served) as first, connected(served) as second:
            assert ask(first) == ask(second) == ANSWER
            with connected(served) as third:
                assert receive(third, 1) == b""
            assert ask(first) == ANSWER
        # Their places are free again.
        wait_until(lambda: _served_once(served))
    assert served.events == ["2 clients are connected, 127.0.0.1 was turned away"]


def _served_once(served) -> bool:
    with connected(served) as client:
        return ask(client) == ANSWER


def test_peers(serving, counted) -> None:
    with serving(peers=("192.0.2.0/24", "127.0.0.1")) as served, connected(served) as client:
        assert ask(client) == ANSWER
    with serving(peers=("192.0.2.0/24",)) as served, connected(served) as client:
        assert receive(client, 1) == b""
    assert served.events == ["127.0.0.1 is no allowed peer, and was turned away"]


def test_requests_that_come_together_are_all_answered_in_turn(serving, counted) -> None:
    requests = [number.to_bytes(2, "big") + READ[2:] for number in range(300)]
    with serving() as served, connected(served) as client:
        client.sendall(b"".join(requests))
        found = receive(client, 300 * len(ANSWER))
    assert found == b"".join(number.to_bytes(2, "big") + ANSWER[2:] for number in range(300))


def test_a_request_in_pieces_is_answered_once(serving, counted) -> None:
    with serving() as served, connected(served) as client, connected(served) as other:
        for place in range(len(READ)):
            client.sendall(READ[place : place + 1])
            # Once another client is answered, the byte has been taken.
            assert ask(other) == ANSWER
        assert receive(client, len(ANSWER)) == ANSWER


@pytest.mark.parametrize(
    "frame",
    ["0001 0007 0006 01 04 000c 0001", "0001 0000 0001 01", "0001 0000 00ff 01 04", "ffff" * 40],
)
def test_what_is_no_modbus_is_let_go(serving, counted, frame) -> None:
    with serving() as served, connected(served) as client, connected(served) as other:
        client.sendall(bytes.fromhex(frame))
        assert receive(client, 1) == b""
        assert ask(other) == ANSWER
    assert served.events == ["127.0.0.1 sends what is not Modbus TCP, and is let go"]


def test_who_asks_too_fast_is_told_and_still_answered(serving, counted) -> None:
    limits = Limits(requests_per_second=200.0)
    with serving(limits=limits) as served, connected(served) as client, connected(served) as other:
        client.sendall(READ * 60)
        assert ask(other) == ANSWER
        assert receive(client, 60 * len(ANSWER)) == ANSWER * 60
    assert served.events == [
        "127.0.0.1 asks more than 200 times a second, and is answered no faster"
    ]


def test_who_takes_no_answer_does_not_hold_up_others(serving, counted) -> None:
    limits = Limits(requests_per_second=1e9, unread=1000, idle=0.3)
    with serving(limits=limits) as served, connected(served) as slow, connected(served) as other:
        slow.settimeout(0.1)
        # Much more than what fits into the buffers of both ends: at last nothing is taken any more.
        with pytest.raises((TimeoutError, ConnectionError)):
            while True:
                slow.sendall(READ * 1000)
                assert ask(other) == ANSWER
        assert ask(other) == ANSWER
        # In the end it is let go.
        wait_until(lambda: [event for event in served.events if "is let go" in event] != [])


def test_who_is_idle_is_let_go(serving, counted) -> None:
    with serving(limits=Limits(idle=0.1)) as served, connected(served) as client:
        # Half of a request is none.
        client.sendall(READ[:6])
        assert receive(client, 1) == b""
    assert served.events == ["127.0.0.1 has asked for nothing for 0.1 s, and is let go"]


def test_late_answers_keep_their_order(serving, counted, table) -> None:
    requests = [number.to_bytes(2, "big") + READ[2:] for number in range(40)]
    table.image.write(WIRE_DELAY, 0.05)
    with serving() as served, connected(served) as client:
        client.sendall(b"".join(requests[:20]))
        assert receive(client, 8)[:2] == requests[0][:2]
        table.image.write(WIRE_DELAY, 0.0)
        client.sendall(b"".join(requests[20:]))
        found = receive(client, 40 * len(ANSWER) - 8)
    assert len(found) == 40 * len(ANSWER) - 8
    numbers = [found[3 + 11 * n : 5 + 11 * n] for n in range(39)]
    assert numbers == [request[:2] for request in requests[1:]]


def test_lost_requests_are_those_of_the_seed(serving, counted, table) -> None:
    def answered(seed: int) -> list[bytes]:
        """Return which of the requests the first 200 answers are to."""
        found = []
        table.image.write(WIRE_LOSS, 0.25)
        with serving(seed=seed) as served, connected(served) as client:
            client.sendall(b"".join(number.to_bytes(2, "big") + READ[2:] for number in range(2000)))
            while len(found) < 200:
                found.append(receive(client, len(ANSWER))[:2])
        return found

    first = answered(1)
    assert first == answered(1)
    assert first != answered(2)
    # 200 answers of a share of 3/4: 267 requests, within four standard deviations of 9.4.
    assert 229 < int.from_bytes(first[-1], "big") < 304


def test_a_pulled_cable_drops_all_and_takes_none(serving, counted, table) -> None:
    with serving() as served:
        with connected(served) as client:
            assert ask(client) == ANSWER
            table.image.write(WIRE_CUT, 1.0)
            assert receive(client, 1) == b""
        with connected(served) as client:
            assert receive(client, 1) == b""
        table.image.write(WIRE_CUT, 0.0)
        assert _served_once(served)
