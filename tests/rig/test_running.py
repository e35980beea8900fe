"""A rig at work, in processes of its own: killed, resumed, refused."""

import asyncio
import os
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from waiting import wait_until

import clepsydra as cl

pytestmark = pytest.mark.thorough
SPEED = 100.0
#: Nobody comes in: tests may run side by side.
SHUT = cl.Doors(())


def asked(folder, sql):
    """Return what a reader of the history finds with SQL, while it may still grow."""
    path = folder / "history.sqlite"
    with closing(sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True)) as connection:
        return connection.execute(sql).fetchall()


def samples_of(folder):
    rows = asked(folder, 'SELECT sample, "level_1", "pump_1.applied" FROM samples ORDER BY sample')
    found = np.array(rows)
    return found[:, 0].astype(int), found[:, 1:]


def wait_for_samples(running, more):
    wanted = running.image.published().sample + more

    def reached():
        list(running.watch(0.05))
        return running.image.published().sample >= wanted

    wait_until(reached)


def test_whatever_is_killed_no_acknowledged_sample_is_lost_and_it_goes_on(tmp_path):
    with cl.run_rig("quadruple-tank", folder=tmp_path, doors=SHUT, speed=SPEED) as running:
        for _ in range(2):
            for title in ("plant", "history"):
                wait_for_samples(running, 30)
                acknowledged = running.image.acknowledged
                before, values = samples_of(tmp_path)
                os.kill(running.process_of(title), signal.SIGKILL)
                wait_until(lambda: any(running.watch(0.05)))
                _, later = samples_of(tmp_path)
                assert before[-1] >= acknowledged
                assert np.array_equal(later[: len(values)], values)
        wait_for_samples(running, 10)
    samples, _ = samples_of(tmp_path)
    assert samples.tolist() == list(range(len(samples)))
    told = asked(tmp_path, "SELECT words FROM events")
    assert sum("was started again" in words for (words,) in told) == 4


def test_a_rig_that_is_killed_as_a_whole_goes_on_with_resume(tmp_path):
    command = ["-m", "clepsydra", "rig", "quadruple-tank", "--speed", "100", "--doors", ""]
    command += ["-o", str(tmp_path)]
    started = subprocess.Popen([sys.executable, *command], stdout=subprocess.PIPE, text=True)

    def has_samples():
        try:
            return asked(tmp_path, "SELECT count(*) FROM samples")[0][0] > 50
        except sqlite3.Error:
            return False

    wait_until(has_samples)
    started.kill()
    started.communicate()
    before, values = samples_of(tmp_path)
    wait_until(lambda: not _is_held(tmp_path))
    done = subprocess.run(
        [sys.executable, *command, "--resume", "--duration", "30 s"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    after, later = samples_of(tmp_path)
    assert asked(tmp_path, "SELECT count(*) FROM runs") == [(1,)]
    assert after.tolist() == list(range(len(after)))
    assert len(after) >= len(before) + 30
    assert np.array_equal(later[: len(values)], values)


def _is_held(folder):
    with sqlite3.connect(folder / "running", timeout=0.0, isolation_level=None) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.Error:
            return True
        lock.execute("ROLLBACK")
        return False


def test_silence_sends_outputs_to_their_fail_safe_values_and_is_told(tmp_path):
    with cl.run_rig(
        "quadruple-tank",
        folder=tmp_path,
        doors=SHUT,
        speed=SPEED,
        silence="0.3 s",
        fail_safe={"pump_1": "1 V"},
    ) as running:
        table = running.table
        table.write(table.tags["pump_1.out"], 4.0)
        wait_until(lambda: any("fail-safe" in each.words for each in running.watch(0.05)))
        wait_for_samples(running, 3)
        assert table.read(table.tags["pump_1.position"]).value == 1.0
        table.write(table.tags["pump_1.out"], 3.0)
        wait_until(lambda: any("heard again" in each.words for each in running.watch(0.05)))
    position = samples_of(tmp_path)[1][:, 1]
    assert {1.0, 3.0, 4.0} == set(position)


def test_a_folder_has_one_rig_at_a_time(tmp_path):
    with (
        cl.run_rig("quadruple-tank", folder=tmp_path, doors=SHUT, speed=SPEED),
        pytest.raises(cl.InputError, match="end the other one"),
        cl.run_rig("quadruple-tank", folder=tmp_path, doors=SHUT),
    ):
        pass


def test_what_another_rig_left_is_not_gone_on_from(tmp_path):
    with cl.run_rig("quadruple-tank", folder=tmp_path, doors=SHUT, speed=SPEED) as running:
        wait_for_samples(running, 5)
    with (
        pytest.raises(cl.InputError, match="what another rig left there"),
        cl.run_rig("three-tanks", folder=tmp_path, doors=SHUT, resume=True),
    ):
        pass
    with (
        pytest.raises(cl.InputError, match="nothing to go on from"),
        cl.run_rig("three-tanks", folder=tmp_path / "none", doors=SHUT, resume=True),
    ):
        pass


class StubbornDoor:
    """A door whose process ends as soon as it is at work, but for the first time."""

    title, address, note = "stubborn", "nowhere", ""

    def __init__(self, mark):
        self.mark = mark

    def check(self):
        pass

    async def serve(self, table, reporter):
        reporter.ready()
        if self.mark.exists():
            os._exit(7)
        self.mark.touch()
        await asyncio.sleep(3600.0)


def test_a_door_that_dies_again_and_again_stays_closed_and_the_plant_goes_on(tmp_path):
    running = cl.run_rig("quadruple-tank", folder=tmp_path / "rig", doors=SHUT, speed=SPEED)
    running.settings = replace(running.settings, doors=(StubbornDoor(tmp_path / "mark"),))
    with running:
        os.kill(running.process_of("stubborn"), signal.SIGKILL)
        told = []

        def is_closed():
            told.extend(each.words for each in running.watch(0.05))
            return any("stays closed" in words for words in told)

        wait_until(is_closed)
        assert sum("was started again" in words for words in told) == 5
        wait_for_samples(running, 30)
