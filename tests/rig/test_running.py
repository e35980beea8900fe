"""A rig at work, in processes of its own: killed, resumed, refused."""

import os
import signal
import sqlite3

import numpy as np
import pytest
from waiting import wait_until

import clepsydra as cl
from clepsydra.base.history_reading import read_events, read_rows, read_runs
from clepsydra.interface.rig import rig as rig_of

pytestmark = pytest.mark.thorough
SPEED = 100.0


def samples_of(path, run):
    return read_rows(path / "history.sqlite", run, ["level_1", "pump_1.applied"], most=10**6)


def wait_for_samples(running, more):
    wanted = running.image.published().sample + more

    def reached():
        list(running.watch(0.05))
        return running.image.published().sample >= wanted

    wait_until(reached)


def test_whatever_is_killed_no_acknowledged_sample_is_lost_and_it_goes_on(tmp_path):
    with rig_of("quadruple-tank", folder=tmp_path, speed=SPEED) as running:
        for _ in range(2):
            for title in ("plant", "history"):
                wait_for_samples(running, 30)
                acknowledged = running.image.acknowledged
                before = samples_of(tmp_path, running.run)
                os.kill(running.process_of(title), signal.SIGKILL)
                wait_until(lambda: any(running.watch(0.05)))
                after = samples_of(tmp_path, running.run)
                assert before.samples[-1] >= acknowledged
                assert np.array_equal(after.values[: len(before.values)], before.values)
        wait_for_samples(running, 10)
    samples = samples_of(tmp_path, running.run).samples
    assert samples.tolist() == list(range(len(samples)))
    told = [words for _, _, words in read_events(tmp_path / "history.sqlite", running.run)]
    assert sum("was started again" in words for words in told) == 4


def test_a_rig_that_is_killed_as_a_whole_goes_on_with_resume(tmp_path):
    command = ["-m", "clepsydra", "rig", "quadruple-tank", "--speed", "100", "-o", str(tmp_path)]
    import subprocess
    import sys

    history = tmp_path / "history.sqlite"
    started = subprocess.Popen([sys.executable, *command], stdout=subprocess.PIPE, text=True)

    def has_samples():
        try:
            with sqlite3.connect(f"{history.as_uri()}?mode=ro", uri=True) as connection:
                return connection.execute("SELECT count(*) FROM samples").fetchone()[0] > 50
        except sqlite3.Error:
            return False

    wait_until(has_samples)
    started.kill()
    started.communicate()
    before = samples_of(tmp_path, read_runs(history)[-1].number)
    wait_until(lambda: not _is_held(tmp_path))
    done = subprocess.run(
        [sys.executable, *command, "--resume", "--duration", "30 s"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    after = samples_of(tmp_path, read_runs(history)[-1].number)
    assert len(read_runs(history)) == 1
    assert after.samples.tolist() == list(range(len(after.samples)))
    assert len(after.samples) >= len(before.samples) + 30
    assert np.array_equal(after.values[: len(before.values)], before.values)


def _is_held(folder):
    with sqlite3.connect(folder / "running", timeout=0.0, isolation_level=None) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.Error:
            return True
        lock.execute("ROLLBACK")
        return False


def test_silence_sends_outputs_to_their_fail_safe_values_and_is_told(tmp_path):
    with rig_of(
        "quadruple-tank", folder=tmp_path, speed=SPEED, silence="0.3 s", fail_safe={"pump_1": "1 V"}
    ) as running:
        table = running.table
        table.write(table.tags["pump_1.out"], 4.0)
        wait_until(lambda: any("fail-safe" in each.words for each in running.watch(0.05)))
        wait_for_samples(running, 3)
        assert table.read(table.tags["pump_1.position"]).value == 1.0
        table.write(table.tags["pump_1.out"], 3.0)
        wait_until(lambda: any("heard again" in each.words for each in running.watch(0.05)))
    position = samples_of(tmp_path, running.run).values[:, 1]
    assert {1.0, 3.0, 4.0} == set(position)


def test_a_folder_has_one_rig_at_a_time(tmp_path):
    with (
        rig_of("quadruple-tank", folder=tmp_path, speed=SPEED),
        pytest.raises(cl.InputError, match="end the other one"),
        rig_of("quadruple-tank", folder=tmp_path),
    ):
        pass


def test_what_another_rig_left_is_not_gone_on_from(tmp_path):
    with rig_of("quadruple-tank", folder=tmp_path, speed=SPEED) as running:
        wait_for_samples(running, 5)
    with (
        pytest.raises(cl.InputError, match="what another rig left there"),
        rig_of("three-tanks", folder=tmp_path, resume=True),
    ):
        pass
    with (
        pytest.raises(cl.InputError, match="nothing to go on from"),
        rig_of("three-tanks", folder=tmp_path / "none", resume=True),
    ):
        pass
