"""`clepsydra rig`: its map, its mistakes, and a run of it."""

import sqlite3

import pytest
from tools import need


def test_its_register_map_is_printed_and_written(command, tmp_path):
    need("pymodbus")
    status, told, _ = command("rig", "quadruple-tank", "--map", "--encoding", "counts-27648")
    assert status == 0 and "30001      level_1.pv  " in told and "counts-27648" in told
    rows = (tmp_path / "quadruple-tank-registers.csv").read_text().splitlines()
    assert rows[0].startswith("tag,table,address,encoding") and len(rows) > 30


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--speed", "5000"], "--speed: got 5000.0"),
        (["--fail-safe", "pump_9=1 V"], "pump_9"),
        (["--fail-safe", "pump_1=1 cm"], "--fail-safe pump_1: got '1 cm'"),
        (["--port", "modbus=abc"], "--port, modbus: got 'abc'"),
        (["--port", "fax=1"], "--doors: got 'fax'"),
        (["--doors", "modbus,fax"], "--doors: got 'fax'"),
        (["--host", "0.0.0.0"], "--peer"),
        (["--encoding", "bcd"], "--encoding: got 'bcd'"),
        (["--script", "none.toml"], "none.toml"),
        (["--keep", "3 V"], "--keep"),
        (["--controller", "PI, NOBODY"], "PI, NOBODY"),
        (["--silence", "-1 s"], "--silence"),
    ],
)
def test_a_mistake_is_one_message_with_a_remedy(command, tmp_path, options, words):
    need("pymodbus")
    status, _, told = command("rig", "quadruple-tank", "-o", str(tmp_path), *options)
    assert status == 2 and words in told and "Traceback" not in told
    assert not list(tmp_path.iterdir())


@pytest.mark.thorough
def test_it_runs_for_as_long_as_it_is_asked_to(command, tmp_path):
    need("pymodbus")
    script = tmp_path / "script.toml"
    script.write_text('[[do]]\nat = "20 s"\nfail = { level_1 = "dead" }\n')
    asked = ["--speed", "50", "--duration", "1 min", "--local", "--script", str(script)]
    ports = ["--port", "modbus=0"]
    folder = tmp_path / "rig"
    status, told, _ = command("rig", "quadruple-tank", "-o", str(folder), *asked, *ports)
    assert status == 0 and "at 50 times real time" in told and "script: level_1: dead" in told
    with sqlite3.connect(folder / "history.sqlite") as connection:
        count, sound = connection.execute(
            'SELECT count(*), sum("level_1.sensor") FROM samples'
        ).fetchone()
    assert count >= 60 and 19 <= sound < count
