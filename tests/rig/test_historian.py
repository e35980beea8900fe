"""The history of a rig: every sample once, whatever is killed or full."""

import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from rig_bench import Bench

import clepsydra as cl
from clepsydra.base.history_file import HistoryFile
from clepsydra.rig.assembly import kept_signals
from clepsydra.rig.historian import Historian, HistorySettings
from clepsydra.rig.report import Reporter
from clepsydra.rig.retention import Retention


class Kept(Bench):
    """A rig with its historian, both without a process of their own."""

    def __init__(self, folder: Path, retention=None) -> None:
        super().__init__(folder)
        self.told = []
        signals = kept_signals(self.process, self.settings)
        self.file = folder / "history.sqlite"
        with HistoryFile(self.file) as history:
            self.run = history.begin("tanks", 0.0, 1.0, signals)
        names = tuple(signal.name for signal in signals)
        self.keeps = HistorySettings(self.file, self.run, names, retention or Retention())
        self.historian = self.new_historian()

    def new_historian(self):
        reporter = Reporter("history", lambda report: self.told.append(report.words))
        return Historian(reporter, self.keeps, self.image)

    def asked(self, sql):
        with closing(sqlite3.connect(self.file)) as connection:
            return connection.execute(sql).fetchall()

    @property
    def samples(self):
        return [row[0] for row in self.asked("SELECT sample FROM samples ORDER BY sample")]


def test_a_killed_historian_loses_and_doubles_nothing(tmp_path):
    rig = Kept(tmp_path)
    for _ in range(7):
        rig.step(13)
        assert rig.historian.keep()
        rig.historian = rig.new_historian()
        rig.step(5)
    rig.historian.keep()
    assert rig.samples == list(range(7 * 18))
    assert rig.image.acknowledged == 7 * 18 - 1
    assert rig.asked('SELECT count(*) FROM samples WHERE "level_1" IS NULL') == [(0,)]


def test_what_the_history_has_is_what_was_applied(tmp_path):
    rig = Kept(tmp_path)
    asked = []
    for sample in range(40):
        rig.write("pump_1.out", 3.0 + sample % 5 / 10)
        asked.append(3.0 + sample % 5 / 10)
        rig.step()
    rig.historian.keep()
    found = rig.asked('SELECT "pump_1.applied" FROM samples ORDER BY sample')
    assert [row[0] for row in found] == asked


def test_a_full_disk_is_told_once_and_made_up_for(tmp_path, monkeypatch):
    rig = Kept(tmp_path)

    def full(*_):
        raise sqlite3.OperationalError("database or disk is full")

    rig.step(10)
    with monkeypatch.context() as patched:
        patched.setattr(HistoryFile, "add", full)
        assert not rig.historian.keep() and not rig.historian.keep()
        assert len(rig.told) == 1 and "disk is full" in rig.told[0]
        assert rig.image.acknowledged == -1
    rig.step(10)
    assert rig.historian.keep()
    assert rig.told[1:] == ["the history is written again"]
    assert rig.samples == list(range(20))


def test_what_waited_too_long_is_said_to_be_lost(tmp_path):
    rig = Kept(tmp_path)
    rows = rig.image.layout.rows
    rig.step(rows + 20)
    rig.historian.keep()
    first = rig.samples[0]
    assert rig.told == [
        f"samples 0 to {first - 1} are lost for the history: it could not be written for too long"
    ]
    assert first == 21


@pytest.mark.parametrize("retention", [Retention(age=100.0), Retention(size=120_000)])
def test_the_oldest_samples_are_forgotten(tmp_path, retention):
    rig = Kept(tmp_path, retention)
    rig.step(3000)
    rig.historian.keep()
    rig.historian.forget()
    samples = rig.samples
    assert samples[-1] == 2999 and np.all(np.diff(samples) == 1)
    if retention.age is not None:
        assert samples[0] == 2900
    else:
        assert 0 < samples[0] < 2999
        with HistoryFile(rig.file) as history:
            assert history.size <= 120_000
        assert rig.file.stat().st_size < 250_000


def test_a_history_is_identified_while_it_grows(tmp_path):
    rig = Kept(tmp_path)
    for volts in (3.5, 2.5, 3.2, 2.8, 3.4, 2.6):
        rig.write("pump_1.out", volts)
        rig.step(60)
        rig.historian.keep()
    found = cl.identify(rig.file, plant="quadruple-tank", parameters=["outlet_1.area"])
    assert found.values["outlet_1.area"] == pytest.approx(0.071e-4, rel=1e-6)
    model = cl.identify(rig.file, "pump_1.applied", "level_1", last="5 min")
    assert model.models[0].estimates[0].value == pytest.approx(2.6, abs=0.15)
    with pytest.raises(cl.InputError, match="the history of a rig"):
        (tmp_path / "a.csv").write_text("time [s],u [V]\n0,1\n")
        cl.identify(tmp_path / "a.csv", last="5 min")


def test_a_history_is_read_by_sql_in_the_units_that_readers_see(tmp_path):
    rig = Kept(tmp_path)
    rig.step(3)
    rig.historian.keep()
    ((level, volts),) = rig.asked(
        'SELECT "tank_1.level [cm]", "level_1 [V]" FROM shown WHERE sample = 0'
    )
    assert (level, volts) == pytest.approx((12.263, 6.1315), abs=1e-4)
    assert rig.asked("SELECT title FROM runs") == [("tanks",)]


def test_another_file_is_no_history(tmp_path):
    with sqlite3.connect(tmp_path / "other.sqlite") as connection:
        connection.execute("CREATE TABLE runs (a)")
    with pytest.raises(cl.InputError, match="a history that clepsydra rig wrote"):
        cl.identify(tmp_path / "other.sqlite", "a", "b")
