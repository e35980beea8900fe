"""Records from CSV: what is read, and what is refused with line and column."""

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError
from clepsydra.identification.record import read_record

HEAD = "time [s],pump_1 [V],level_1 [cm]\n"
ROWS = [f"{2 * k},{3 + k % 2},{12.5 + k}" for k in range(40)]


def text(*, head=HEAD, rows=None, replaced=None):
    lines = list(ROWS if rows is None else rows)
    for at, line in (replaced or {}).items():
        lines[at] = line
    return head + "\n".join(lines) + "\n"


def written(folder, content):
    path = folder / "tank.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_units_are_converted(tmp_path):
    record = read_record(written(tmp_path, text()))
    assert (record.period, record.start, record.samples) == (2.0, 0.0, 40)
    pump, level = record.signals
    assert (level.unit, level.display_unit, pump.unit) == ("m", "cm", "V")
    assert record.values["level_1"][:2] == pytest.approx([0.125, 0.135], rel=1e-12)
    assert record.held_back == 27


def test_semicolons_minutes_and_a_mark_of_byte_order(tmp_path):
    content = "\ufefftime [min];pump [%];flow [l/min];share [1]\n"
    content += "".join(f"{5 + 0.5 * k};{50 + k};{k};{k / 10}\n" for k in range(30))
    record = read_record(written(tmp_path, content))
    assert (record.period, record.start) == (30.0, 300.0)
    assert record.values["pump"][1] == pytest.approx(0.51)
    assert record.values["flow"][6] == pytest.approx(1e-4)
    assert [s.unit for s in record.signals] == ["1", "m^3/s", "1"]


def test_names_of_a_process_have_its_units(tmp_path):
    content = text(head="time [s],pump_1 [mV],level_1 [V]\n")
    record = read_record(written(tmp_path, content), cl.load("quadruple-tank").process)
    assert record.values["pump_1"][0] == pytest.approx(0.003)
    assert record.signals[1].high == 10.0


def test_what_simulate_writes_is_read_number_by_number(tmp_path):
    plant = cl.load("quadruple-tank")
    run = cl.simulate(plant, None, [cl.step("pump_1", to="3.2 V", at="2 s")], duration="40 s")
    run.save(tmp_path / "run.csv")
    for process in (None, run.process):
        record = read_record(tmp_path / "run.csv", process)
        assert record.period == pytest.approx(1.0, rel=1e-12)
        assert [s.name for s in record.signals] == [s.name for s in run.signals]
        for signal in run.signals:
            found, value = record.values[signal.name], run.values[signal.name]
            assert found == pytest.approx(value, rel=1e-12, abs=0.0), signal.name


def test_the_jitter_of_a_logger_is_taken(tmp_path):
    rows = [f"{round(k / 3, 2)},{k % 2},{k}" for k in range(40)]
    assert read_record(written(tmp_path, text(rows=rows))).period == pytest.approx(1 / 3, rel=1e-3)


REFUSED = {
    "gap": (text(replaced={4: "8,,16.5"}), "line 6, column 'pump_1': got '', expected a number"),
    "text": (
        text(replaced={4: "8,off,16.5"}),
        "line 6, column 'pump_1': got 'off', expected a number; correct the cell",
    ),
    "not a number": (text(replaced={0: "0,nan,1"}), "line 2, column 'pump_1': got 'nan'"),
    "unit in a cell": (text(replaced={1: "2,4 V,13"}), "line 3, column 'pump_1': got '4 V'"),
    "decimal comma": (
        text(head=HEAD.replace(",", ";"), replaced={1: "2;4;13,5"}, rows=[
            r.replace(",", ";") for r in ROWS]),
        "line 3, column 'level_1': got '13,5', expected a decimal point",
    ),
    "short row": (text(replaced={7: "14,3"}), "line 9: got '2 fields', expected 3 fields"),
    "missing rows": (
        text(rows=[*ROWS[:10], *ROWS[13:]]),
        "line 12, column 'time': got '8 s after the row before', expected a row each 2 s; fill in",
    ),
    "irregular": (
        text(replaced={5: "10.7,4,17.5"}),
        "line 7, column 'time': got '2.7 s after the row before', expected a row each 2 s; sample",
    ),
    "time goes back": (
        text(replaced={5: "7,4,17.5"}), "line 7, column 'time': got '7 s', expected a time after",
    ),
    "few rows": (text(rows=ROWS[:20]), "tank.csv: got '20 samples', expected at least 30"),
    "one row": (text(rows=ROWS[:1]), "tank.csv: got '1 row'"),
    "no unit": (
        text(head="time [s],pump_1 [V],level_1\n"),
        "line 1, column 'level_1': got 'level_1', expected its unit in brackets",
    ),
    "unknown unit": (
        text(head="time [s],pump_1 [V],level_1 [cubits]\n"),
        "line 1, column 'level_1': got 'cubits', expected a unit that is known",
    ),
    "no time": (text(head="pump_1 [V],x [s],level_1 [cm]\n"), "expected the time with its unit"),
    "no name": (text(head="time [s],pump_1 [V],[cm]\n"), "line 1, column 3: got ''"),
    "twice": (text(head="time [s],pump_1 [V],pump_1 [V]\n"), "expected each signal once"),
    "empty": ("", "tank.csv: got an empty file"),
    "no text": (b"time [s],a [V]\n\xff\xfe", "line 2: got byte 0xff, expected text in UTF-8"),
    "cut off": (text()[:-6], "line 41: got '2 fields', expected 3 fields"),
    "long": (text() + 100_000 * "1,2,3\n", "got '100,040 rows', expected at most 100,000 rows"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_bad_files_are_refused_with_their_place(case, tmp_path):
    content, expected = REFUSED[case]
    with pytest.raises(InputError) as refusal:
        read_record(written(tmp_path, content))
    message = str(refusal.value)
    assert expected in message and "tank.csv" in message


def test_a_unit_of_another_kind_than_the_process_has(tmp_path):
    with refused(place="column 'level_1'", remedy="measures something else"):
        read_record(written(tmp_path, text()), cl.load("quadruple-tank").process)


def test_parquet_and_missing_files_are_refused(tmp_path):
    with refused(value="a Parquet file", expected="a CSV file"):
        read_record(tmp_path / "run.parquet")
    with refused(value="no such file"):
        read_record(tmp_path / "run.csv")
