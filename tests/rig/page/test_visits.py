"""Pages that are open on a rig: what they get, what they may do, and when they are let go."""

import json
import socket
from contextlib import contextmanager

import numpy as np
import pytest
from waiting import wait_until
from websockets.exceptions import ConnectionClosed, InvalidStatus


def rows_of(page, layout, samples):
    """Return so many samples that a page gets."""
    found = np.zeros((0, 2 + len(layout.columns)))
    while len(found) < samples:
        told = page.recv(timeout=600)
        if isinstance(told, bytes):
            rows = np.frombuffer(told).reshape(-1, found.shape[1])
            found = np.concatenate([found, rows])
    return found


def answer_of(page):
    while True:
        told = page.recv(timeout=600)
        if isinstance(told, str) and {"taken", "refused"} & set(found := json.loads(told)):
            return found


def hello_of(page):
    return json.loads(page.recv(timeout=600))["rig"]


def test_a_page_gets_every_sample_in_order_those_before_it_came_too(serving):
    with serving() as served:
        plant, layout = served.bench, served.bench.image.layout
        plant.step(30)
        with served.connect() as page:
            hello = hello_of(page)
            assert hello["columns"] == list(layout.columns)
            assert hello["isViewer"] is False
            before = rows_of(page, layout, 30)
            plant.write("level_1.sp", 7.0)
            plant.step(5)
            after = rows_of(page, layout, 5)
        rows = np.concatenate([before, after])
        assert rows[:, 0].tolist() == list(range(35))
        setpoint = rows[:, 2 + layout.columns.index("level_1.setpoint")]
        assert setpoint[29:31].tolist() == [plant.settings.at_rest["level_1.setpoint"], 7.0]
        assert np.array_equal(rows, plant.image.kept_since(-1))


def test_a_page_that_comes_back_gets_what_it_has_not_seen(serving):
    with serving() as served:
        served.bench.step(30)
        with served.connect("/rig?since=19") as page:
            hello_of(page)
            assert rows_of(page, served.bench.image.layout, 10)[:, 0].tolist() == [*range(20, 30)]


def test_what_a_page_sets_is_what_the_plant_goes_on_with(serving):
    touches = [
        ({"input": "level_1.setpoint", "value": 7.25}, "level_1.setpoint", 7.25),
        ({"input": "operator.remote", "value": 0}, "operator.remote", 0.0),
        ({"input": "level_2.forced", "value": 1}, "level_2.forced", 1.0),
        ({"input": "instructor.wire_loss", "value": 0.25}, "instructor.wire_loss", 0.25),
        ({"noise": True}, "instructor.noise", 1.0),
        ({"drift": "level_3", "rate": -1e-4}, "level_3.drift", -1e-4),
    ]
    with serving() as served, served.connect() as page:
        served.bench.step(3)
        for touch, cell, value in touches:
            page.send(json.dumps(touch))
            assert answer_of(page) == {"taken": 3}
            assert served.bench.image.read(cell) == value


@pytest.mark.parametrize(
    "touch, words",
    [
        ({"input": "pump_1.command", "value": 1}, "does not set pump_1.command"),
        ({"input": "controller.heartbeat", "value": 1}, "does not set"),
        ({"input": "level_1", "value": 1}, "does not set"),
        ({"input": "pump_1.mode", "value": 0.5}, "no whole number"),
        ({"input": "pump_1.mode", "value": 3}, "outside of 0 to 2"),
        ({"input": "pump_1.manual", "value": 12}, "outside of"),
        ({"input": "level_1.reading", "value": 1e6}, "outside of"),
        ({"input": "instructor.wire_loss", "value": 1.5}, "outside of 0 to 1"),
        ({"drift": "level_9", "rate": 0}, "does not set level_9.drift"),
    ],
)
def test_what_may_not_be_is_refused_with_its_reason_and_the_page_stays_open(serving, touch, words):
    with serving() as served, served.connect() as page:
        before = served.bench.image.written()
        page.send(json.dumps(touch))
        assert words in answer_of(page)["refused"]
        page.send('{"noise": false}')
        assert "taken" in answer_of(page)
        assert np.array_equal(served.bench.image.written(), before)


@pytest.mark.parametrize(
    "message, code, words",
    [
        (b"\x00\x01", 1003, "text"),
        ("{", 1008, "no JSON"),
        ("[" * 900, 1008, "no JSON"),
        ("[1]", 1008, "no touch"),
        ('{"input": "level_1.setpoint"}', 1008, "no touch"),
        ('{"input": "level_1.setpoint", "value": NaN}', 1008, "finite"),
        ('{"input": "level_1.setpoint", "value": true}', 1008, "finite"),
        ('{"input": 3, "value": 1}', 1008, "what was set"),
        ('{"noise": 1}', 1008, "true or false"),
        ('{"controller": "PI", "start": "zero"}', 1008, "no touch"),
        ('{"noise": true, "sample": 1}', 1008, "no touch"),
        ("x" * 5000, 1009, ""),
    ],
)
def test_what_no_page_sends_closes_it_with_a_reason(serving, message, code, words):
    with serving() as served, served.connect() as page:
        page.send(message)
        with pytest.raises(ConnectionClosed) as closed:
            answer_of(page)
        assert closed.value.rcvd.code == code
        assert words in closed.value.rcvd.reason


def test_who_only_looks_on_moves_nothing(serving):
    with serving(view_only=True) as served, served.connect() as page:
        assert hello_of(page)["isViewer"] is True
        page.send('{"input": "operator.remote", "value": 0}')
        assert answer_of(page) == {"refused": "this page only looks on"}
        assert served.bench.image.read("operator.remote") == 1.0


def test_too_many_touches_at_once_close_the_page(serving):
    with serving() as served, served.connect() as page:
        with pytest.raises(ConnectionClosed) as closed:
            for _ in range(5000):
                page.send('{"noise": false}')
                answer_of(page)
        assert closed.value.rcvd.reason == "too much at once"


def test_pages_beyond_the_most_are_turned_away_and_told_once(serving):
    with serving(most=2) as served:
        with served.connect() as one, served.connect() as other:
            for page in (one, other):
                hello_of(page)
            for _ in range(2):
                with pytest.raises(InvalidStatus) as refused, served.connect():
                    pass
                assert refused.value.response.status_code == 503
            assert served.told == ["2 pages are open: no other one is let in"]

        def is_let_in():
            try:
                with served.connect():
                    return True
            except InvalidStatus:
                return False

        wait_until(is_let_in)


@pytest.mark.thorough
def test_a_page_that_takes_nothing_gets_the_newest_and_holds_up_nobody(serving, monkeypatch):
    # A page that answers nothing for long is let go; on a slow machine this one would be.
    monkeypatch.setattr("clepsydra.rig.doors.page.server.PINGS", 600.0)
    with serving() as served:
        plant, layout = served.bench, served.bench.image.layout
        width = 2 + len(layout.columns)
        with slow_page(served.port) as slow, served.connect() as other:
            hello_of(other)
            sample = 0
            # More than what sockets, and then the stream of one page, hold of it.
            for _ in range(30):
                plant.step(500)
                rows = rows_of(other, layout, 500)
                assert rows[:, 0].tolist() == [*range(sample, sample + 500)]
                sample += 500
            seen = []
            for payload in binary_frames(slow):
                seen += np.frombuffer(payload).reshape(-1, width)[:, 0].tolist()
                if seen[-1] == sample - 1:
                    break
        assert seen == sorted(set(seen))
        assert len(seen) < sample


@contextmanager
def slow_page(port):
    """Open the link of a page with as little room for what it does not read as there can be."""
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.connect(("127.0.0.1", port))
        connection.sendall(
            f"GET /rig HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
            "Sec-WebSocket-Version: 13\r\n\r\n".encode("ascii")
        )
        stream = connection.makefile("rb")
        while stream.readline() != b"\r\n":
            pass
        yield stream


def binary_frames(stream):
    """Yield what a server sends as binary, frame by frame (RFC 6455, section 5.2)."""
    while head := stream.read(2):
        kind, length = head[0] & 15, head[1]
        if length > 125:
            length = int.from_bytes(stream.read(2 if length == 126 else 8), "big")
        payload = stream.read(length)
        if kind == 2:
            yield payload
