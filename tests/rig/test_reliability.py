"""A rig with real processes: doors killed, flooded and kept waiting, disks that are full."""

import os
import resource
import signal
import socket
import sqlite3
import subprocess
import sys
import threading
from contextlib import ExitStack, closing, contextmanager

import numpy as np
import pytest
from tools import need
from waiting import wait_until

import clepsydra as cl

pytestmark = pytest.mark.thorough
SPEED = 50.0
#: Read input register 12, the watchdog of the plant, as a Modbus request.
READ = bytes.fromhex("0001 0000 0006 01 04 000c 0001")
ANSWER = 11


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as other:
        return other.getsockname()[1]


@contextmanager
def at_work(folder, *doors, **options):
    """A rig with doors at free ports; gives it, what it has said, and the ports."""
    ports = {door: free_port() for door in doors}
    asked = cl.Doors(doors, ports=ports, anonymous=True)
    with cl.run_rig(
        "quadruple-tank", folder=folder, doors=asked, speed=SPEED, **options
    ) as running:
        yield running, _Watch(running), ports


class _Watch:
    """What a rig says while a test waits for something."""

    def __init__(self, running) -> None:
        self._running, self.said = running, []

    def until(self, reached) -> None:
        def found():
            self.said += [str(report) for report in self._running.watch(0.05)]
            return reached()

        wait_until(found)

    def until_said(self, words) -> None:
        self.until(lambda: any(words in each for each in self.said))

    def samples(self, more) -> None:
        wanted = self._running.image.published().sample + more
        self.until(lambda: self._running.image.published().sample >= wanted)


def no_sample_is_lost(folder) -> np.ndarray:
    """Check that the history has every sample, and that the plant counted each; returns them."""
    with closing(sqlite3.connect(folder / "history.sqlite")) as connection:
        rows = connection.execute("SELECT sample FROM samples ORDER BY sample").fetchall()
    found = np.array(rows)[:, 0]
    assert np.array_equal(found, np.arange(len(found)))
    return found


def watchdog_of(client) -> int:
    """Return what a client is told by Modbus; −1 where nobody answers."""
    try:
        client.sendall(READ)
        answer = b""
        while len(answer) < ANSWER:
            more = client.recv(ANSWER - len(answer))
            if not more:
                return -1
            answer += more
    except OSError:
        return -1
    return int.from_bytes(answer[-2:], "big")


def connected(port):
    client = socket.create_connection(("127.0.0.1", port))
    client.settimeout(60.0)
    return client


def test_a_door_that_is_killed_comes_back_and_its_clients_too(tmp_path):
    with at_work(tmp_path, "modbus") as (running, watch, ports):
        for _ in range(3):
            with connected(ports["modbus"]) as client:
                before = watchdog_of(client)
                assert before >= 0
                os.kill(running.process_of("Modbus TCP"), signal.SIGKILL)
                assert watchdog_of(client) == -1
            count = len(watch.said)
            watch.until(lambda have=count: any("started again" in w for w in watch.said[have:]))

            def answers(before=before):
                try:
                    with connected(ports["modbus"]) as again:
                        return watchdog_of(again) > before
                except OSError:
                    return False

            watch.until(answers)
    no_sample_is_lost(tmp_path)


def test_a_door_of_opc_ua_that_is_killed_comes_back(tmp_path):
    need("asyncua")
    from asyncua.sync import Client

    def level(port):
        try:
            with Client(f"opc.tcp://127.0.0.1:{port}/clepsydra") as client:
                index = client.get_namespace_index("urn:clepsydra:rig")
                return client.get_node(f"ns={index};s=level_1.pv").read_value()
        except Exception:
            return None

    with at_work(tmp_path, "opc-ua") as (running, watch, ports):
        watch.until(lambda: level(ports["opc-ua"]) is not None)
        os.kill(running.process_of("OPC UA"), signal.SIGKILL)
        watch.until_said("started again")
        watch.until(lambda: level(ports["opc-ua"]) is not None)
    no_sample_is_lost(tmp_path)


def test_with_the_one_that_watches_all_are_gone_and_their_ports_are_free(tmp_path):
    port = free_port()
    command = [sys.executable, "-m", "clepsydra", "rig", "quadruple-tank", "--speed", "50"]
    command += ["--doors", "modbus", "--port", f"modbus={port}", "-o", str(tmp_path)]
    started = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)

    def is_served():
        try:
            with connected(port) as client:
                return watchdog_of(client) > 20
        except OSError:
            return False

    wait_until(is_served)
    started.kill()
    started.communicate()

    def is_free():
        try:
            connected(port).close()
        except ConnectionRefusedError:
            return True
        return False

    wait_until(is_free)
    before = len(no_sample_is_lost(tmp_path))
    command += ["--resume", "--duration", "20 s"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert len(no_sample_is_lost(tmp_path)) >= before + 20


def test_floods_and_fifty_clients_and_one_that_does_not_read_leave_the_plant_alone(tmp_path):
    with at_work(tmp_path, "modbus") as (running, watch, ports), ExitStack() as stack:
        ended = threading.Event()

        def flood():
            client = connected(ports["modbus"])
            with closing(client):
                client.settimeout(0.1)
                while not ended.is_set():
                    try:
                        client.sendall(READ * 100)
                        client.recv(ANSWER * 100)
                    except TimeoutError:
                        continue

        deaf = stack.enter_context(connected(ports["modbus"]))
        deaf.settimeout(0.1)
        try:
            while True:
                deaf.sendall(READ * 1000)
        except OSError:
            pass
        clients = [stack.enter_context(connected(ports["modbus"])) for _ in range(50)]
        threads = [threading.Thread(target=flood) for _ in range(4)]
        for thread in threads:
            thread.start()
        try:
            for _ in range(5):
                told = [watchdog_of(client) for client in clients]
                # Who is asked later is told a later sample, or the same.
                assert min(told) >= 0 and told == sorted(told)
                watch.samples(40)
        finally:
            ended.set()
            for thread in threads:
                thread.join()
        sample = running.image.published().sample
        assert running.image.read("plant.watchdog") >= sample % (1 << 16)
    samples = no_sample_is_lost(tmp_path)
    assert len(samples) >= 200


def test_a_history_that_may_not_grow_waits_and_is_made_up_for(tmp_path):
    with at_work(tmp_path) as (running, watch, _):
        watch.samples(20)
        historian = running.process_of("history")
        before = resource.prlimit(historian, resource.RLIMIT_FSIZE)
        resource.prlimit(historian, resource.RLIMIT_FSIZE, (1, before[1]))
        watch.until_said("the history cannot be written")
        acknowledged = running.image.acknowledged
        watch.samples(200)
        assert running.image.acknowledged == acknowledged
        resource.prlimit(historian, resource.RLIMIT_FSIZE, before)
        watch.until_said("the history is written again")
        watch.samples(20)
    assert len(no_sample_is_lost(tmp_path)) >= 240


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 48 MB of its own."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=48m", "tmpfs", str(place)]
    try:
        mounted = subprocess.run(mount, capture_output=True).returncode == 0
    except OSError:
        mounted = False
    if not mounted:
        pytest.skip("who is not root cannot mount a small disk")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def fill(ballast):
    with ballast.open("wb", buffering=0) as stream, pytest.raises(OSError, match="No space"):
        while True:
            stream.write(bytes(1 << 12))


def test_what_a_full_disk_did_not_take_waits_for_resume(small_disk):
    folder = small_disk / "rig"
    with at_work(folder) as (running, watch, _):
        watch.samples(20)
        fill(small_disk / "ballast")
        watch.until_said("the history cannot be written")
        watch.samples(50)
    last = running.image.published().sample
    assert "--resume keeps them" in running.ending
    (small_disk / "ballast").unlink()
    with at_work(folder, resume=True) as (_, watch, _):
        watch.samples(20)
    assert len(no_sample_is_lost(folder)) >= last + 20


def test_a_disk_that_is_full_does_not_stop_the_plant(small_disk):
    ballast = small_disk / "ballast"
    folder = small_disk / "rig"
    with at_work(folder) as (_, watch, _):
        watch.samples(20)
        fill(ballast)
        watch.until_said("the history cannot be written")
        watch.samples(200)
        assert not any("started again" in each for each in watch.said)
        ballast.unlink()
        watch.until_said("the history is written again")
        watch.samples(20)
    assert len(no_sample_is_lost(folder)) >= 240


def test_a_disk_too_small_for_its_image_is_refused(small_disk):
    with (small_disk / "ballast").open("wb") as stream:
        stream.write(bytes(46 << 20))
    with (
        pytest.raises(cl.InputError, match="room") as error,
        at_work(small_disk / "rig"),
    ):
        pass
    assert "--output" in error.value.remedy or "folder" in error.value.remedy
