"""Profiles of inputs: what words and files mean on the grid of the samples, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

from clepsydra import InputError
from clepsydra.loop.profile import (
    Change,
    pretty_duration,
    profiles_of,
    read_assignment,
    samples_before,
)
from clepsydra.loop.profile_csv import read_profile_csv
from clepsydra.process.reader import load_process


@pytest.fixture(scope="module")
def process():
    return load_process("quadruple-tank")


def profile(process, *texts, samples=200, period=1.0):
    changes = [read_assignment(text, process, f"--input {text}") for text in texts]
    return profiles_of(changes, {"pump_1": 3.0, "pump_2": 3.0}, period, samples)["pump_1"]


def test_a_value_holds_from_the_start(process):
    assert np.array_equal(profile(process, "pump_1=3.2V"), np.full(200, 3.2))


def test_a_step_acts_from_its_sample_on(process):
    values = profile(process, "pump_1 = 3.5 V @ 1 min")
    assert np.array_equal(values, np.where(np.arange(200) < 60, 3.0, 3.5))


def test_a_step_between_two_samples_acts_from_the_later_one(process):
    values = profile(process, "pump_1=3.5V@60.2s")
    assert np.array_equal(values, np.where(np.arange(200) < 61, 3.0, 3.5))


def test_a_ramp_begins_at_the_value_before_and_ends_exactly_on_its_own(process):
    values = profile(process, "pump_1=3.3V@10s", "pump_1=4V@60s..120s")
    time = np.arange(200.0)
    assert np.allclose(values[60:121], 3.3 + 0.7 * (time[60:121] - 60) / 60, rtol=0, atol=1e-14)
    assert values[60] == 3.3 and np.all(values[120:] == 4.0)


def test_several_changes_and_units(process):
    values = profile(process, "pump_1=3200mV", "pump_1=4V@0.5min..60s", "pump_1=2V@100s")
    assert (values[0], values[29], values[45], values[60], values[100]) == (3.2, 3.2, 3.6, 4, 2)


def test_a_pure_number_out_of_range_is_told_without_a_unit(process):
    share = replace(process.inputs[0], unit="1", display_unit="", low=0.0, high=1.0)
    plain = replace(process, inputs=(share, process.inputs[1]))
    with refused(place="--input", value="1.5", expected="from 0 to 1, the range of pump_1"):
        read_assignment("pump_1=1.5", plain, "--input")


def test_steps_fall_on_their_sample_in_spite_of_rounding(process):
    period = 0.1
    for sample in range(1, 190):
        values = profile(process, f"pump_1=4V@{sample}e-1s", period=period)
        assert np.argmax(values == 4.0) == sample


def test_a_pulse_goes_back_to_what_was_before_it(process):
    values = profile(process, "pump_1=4V@60s+3s", "pump_1=2V@100s", "pump_1=5V@120s+2.5s")
    before = values[0]
    assert list(values[58:65]) == [before, before, 4.0, 4.0, 4.0, before, before]
    # It acts from sample to sample: one that ends between two ends at the later one.
    assert list(values[119:124]) == [2.0, 5.0, 5.0, 5.0, 2.0]
    ramped = profile(process, "pump_1=4V@10s+5s", "pump_1=5V@20s..30s")
    assert ramped[25] == pytest.approx((before + 5.0) / 2.0)


def test_a_plus_in_a_number_makes_no_pulse(process):
    assert read_assignment("pump_1=4V@1e+1s", process, "--input").start == 10.0
    assert read_assignment("pump_1=4V@1e+1 s+2 s", process, "--input").back == 12.0


def test_a_disturbance_may_change_too(process):
    change = read_assignment("inflow_1=2 cm^3/s@10s", process, "--input")
    assert change == Change("inflow_1", 2e-6, 10.0, 10.0, "--input")


BAD_WORDS = {
    "pump_1": "--input pump_1: got 'pump_1', expected a signal, '=' and its value; write as in",
    "pmup_1=3V": "got 'pmup_1', expected an input or a disturbance of quadruple-tank "
    "(pump_1, pump_2, inflow_1, inflow_2); perhaps 'pump_1' was meant.",
    "level_1=3V": "got 'level_1', expected an input or a disturbance",
    "pump_1=3": "the unit is missing: write it as in '1 V'",
    "pump_1=": "expected a quantity convertible to V",
    "pump_1=3 cm": "'cm' measures something else",
    "pump_1=nan V": "expected a quantity convertible to V, finite",
    "pump_1=high": "got 'high', expected a quantity convertible to V",
    "pump_1=12V": "got '12 V', expected a value from 0 to 10 V, the range of pump_1; stay inside",
    "inflow_1=9 cm^3/s": "got '9 cm^3/s', expected a value from 0 to 5 cm^3/s",
    "pump_1=4V@": "expected a quantity convertible to s",
    "pump_1=4V@60": "the unit is missing: write it as in '1 s'",
    "pump_1=4V@60V": "'V' measures something else",
    "pump_1=4V@-5s": "got '-5s', expected a time from 0 s on",
    "pump_1=4V@60s..60s": "got '60s..60s', expected a ramp that ends after it begins",
    "pump_1=4V@2min..60s": "expected a ramp that ends after it begins; exchange the two times",
    "pump_1=4V@1s..2s..3s": "expected one time, or two with '..' or '+' between them",
    "pump_1=4V@1s..2s+3s": "expected one time, or two with '..' or '+' between them",
    "pump_1=4V@1s+2s+3s": "expected one time, or two with '..' or '+' between them",
    "pump_1=4V@60s..": "expected a quantity convertible to s",
    "pump_1=4V@60s+": "expected a quantity convertible to s",
    "pump_1=4V@60s+5": "the unit is missing: write it as in '1 s'",
    "pump_1=4V@60s+0s": "got '0s', expected a time above 0 s",
}


@pytest.mark.parametrize("text", BAD_WORDS)
def test_bad_words_are_refused(process, text):
    with pytest.raises(InputError) as refusal:
        read_assignment(text, process, f"--input {text}")
    assert str(refusal.value).startswith(f"--input {text}: got ")
    assert BAD_WORDS[text] in str(refusal.value)


BAD_ORDERS = {
    ("pump_1=4V@60s", "pump_1=3V@30s"): "got '30 s', expected a time from 60 s on",
    ("pump_1=4V@60s..90s", "pump_1=3V@80s"): "got '80 s', expected a time from 90 s on",
    ("pump_1=4V@60s..90s", "pump_1=3V"): "got '0 s', expected a time from 90 s on",
    ("pump_1=4V", "pump_1=3V"): "at most one value of pump_1 in a sampling period of 1 s",
    ("pump_1=4V@59.2s", "pump_1=3V@59.9s"): "at most one value of pump_1",
    ("pump_1=4V@60s+30s", "pump_1=3V@80s"): "got '80 s', expected a time from 90 s on",
    ("pump_1=4V@190s+11s",): "expected a change that ends within the duration of 3.333 min",
    ("pump_1=4V@60s+0.4s",): "got '0.4 s', expected a pulse of at least a sampling period of 1 s",
    ("pump_1=4V@200s",): "got '3.333 min', expected a change that ends within the duration",
    ("pump_1=4V@190s..201s",): "expected a change that ends within the duration of 3.333 min",
}


@pytest.mark.parametrize("texts", BAD_ORDERS)
def test_changes_out_of_order_or_too_late_are_refused(process, texts):
    with pytest.raises(InputError) as refusal:
        profile(process, *texts)
    assert str(refusal.value).startswith(f"--input {texts[-1]}: got ")
    assert BAD_ORDERS[texts] in str(refusal.value)


GOOD_FILES = {
    "comma": b"time [s],pump_1 [V],inflow_1 [cm^3/s]\n0,3,0\n60,3.5,2\n",
    "semicolon": b"time [s];pump_1 [V];inflow_1 [cm^3/s]\n0;3;0\n60;3.5;2\n",
    "minutes": b"time [min],pump_1 [mV],inflow_1 [l/h]\n0,3000,0\n1,3500,7.2\n",
    "another order": b"Time [s],inflow_1 [cm^3/s],pump_1 [V]\n0,0,3\n60,2,3.5\n",
    "spreadsheet": b'\xef\xbb\xbf"time [s]",pump_1 [V],inflow_1 [cm^3/s]\r\n0,3,0\r\n60,3.5,2\r\n',
    "blanks": b" time [ s ] , pump_1 [V], inflow_1 [cm^3/s]\n 0 , 3 , 0 \n6e1,+3.5,2.\n\n , , \n",
}


@pytest.mark.parametrize("case", GOOD_FILES)
def test_files_that_say_the_same_are_read_alike(process, tmp_path, case):
    path = tmp_path / "a.csv"
    path.write_bytes(GOOD_FILES[case])
    found = {(c.signal, c.value, c.start, c.stop) for c in read_profile_csv(path, process)}
    assert found == {
        ("pump_1", 3.0, 0.0, 0.0), ("pump_1", 3.5, 60.0, 60.0),
        ("inflow_1", 0.0, 0.0, 0.0), ("inflow_1", 2e-6, 60.0, 60.0),
    }  # fmt: skip


def test_values_of_a_file_are_held_until_the_next_row(process, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time [s],pump_1 [V]\n2,3.1\n4,3.2\n5,3.3\n")
    changes = read_profile_csv(path, process)
    values = profiles_of(changes, {"pump_1": 3.0}, 1.0, 7)["pump_1"]
    assert values.tolist() == [3.0, 3.0, 3.1, 3.1, 3.2, 3.3, 3.3]


BAD_FILES = {
    "empty": (b"", "a.csv: got an empty file, expected a head and rows of numbers; write a head"),
    "blank": (b"\n \n", "a.csv: got an empty file"),
    "head only": (b"time [s],pump_1 [V]\n", "a.csv: got 'a head without rows'"),
    "no head": (b"0,3\n1,4\n", "a.csv, line 1, column 1: got '0', expected the time with its unit"),
    "one column": (b"time [s]\n0\n", "a.csv, line 1: got 'time [s]', expected a time and at least"),
    "tabs": (b"time [s]\tpump_1 [V]\n0\t3\n", "expected a time and at least one signal, separated"),
    "time without unit": (b"time,pump_1 [V]\n0,3\n", "column 1: got 'time', expected the time"),
    "time in volts": (b"time [V],pump_1 [V]\n0,3\n", "line 1, column 'time': got '1 V'"),
    "no unit": (
        b"time [s],pump_1\n0,3\n",
        "a.csv, line 1, column 'pump_1': got 'pump_1', expected its unit in brackets, as in "
        "pump_1 [V]; write the unit of the numbers.",
    ),
    "unknown unit": (b"time [s],pump_1 [voltz]\n0,3\n", "the unit 'voltz' is unknown"),
    "other unit": (b"time [s],pump_1 [cm]\n0,3\n", "'cm' measures something else"),
    "unknown signal": (
        b"time [s],pmup_1 [V]\n0,3\n",
        "a.csv, line 1, column 2: got 'pmup_1', expected an input or a disturbance of "
        "quadruple-tank (pump_1, pump_2, inflow_1, inflow_2); perhaps 'pump_1' was meant.",
    ),
    "twice": (b"time [s],pump_1 [V],pump_1 [V]\n0,3,3\n", "'pump_1', expected each signal once"),
    "gap": (
        b"time [s],pump_1 [V],pump_2 [V]\n0,3,3\n1,,3\n",
        "a.csv, line 3, column 'pump_1': got '', expected a number; fill the gap",
    ),
    "text": (b"time [s],pump_1 [V]\n0,high\n", "line 2, column 'pump_1': got 'high', expected a"),
    "NaN": (b"time [s],pump_1 [V]\n0,3\n1,NaN\n", "line 3, column 'pump_1': got 'NaN', expected a"),
    "infinite": (b"time [s],pump_1 [V]\n0,inf\n", "got 'inf', expected a finite number"),
    "unit in a cell": (b"time [s],pump_1 [V]\n0,3 V\n", "the unit stands in the head only"),
    "time stands": (
        b"time [s],pump_1 [V]\n0,3\n5,3\n5,4\n",
        "a.csv, line 4, column 'time': got '5 s', expected a time after that of the last row",
    ),
    "time goes back": (b"time [min],pump_1 [V]\n2,3\n1,4\n", "line 3, column 'time': got '1 min'"),
    "time is negative": (b"time [s],pump_1 [V]\n-1,3\n", "got '-1 s', expected a time from 0 s on"),
    "time is text": (b"time [s],pump_1 [V]\n12:30,3\n", "line 2, column 'time': got '12:30'"),
    "few fields": (
        b"time [s],pump_1 [V],pump_2 [V]\n0,3\n",
        "a.csv, line 2: got '2 fields', expected 3 fields, as in the head; fill every column",
    ),
    "decimal comma": (
        b"time [s];pump_1 [V]\n0;3,5\n",
        "a.csv, line 2, column 'pump_1': got '3,5', expected a decimal point; write 3.5 instead",
    ),
    "decimal comma between commas": (
        b"time [s],pump_1 [V]\n0,3,5\n",
        "got '3 fields', expected 2 fields, as in the head; fill every column; a decimal comma",
    ),
    "blank row": (b"time [s],pump_1 [V]\n0,3\n\n1,3\n", "a.csv, line 3: got '0 fields'"),
    "out of range": (
        b"time [s],pump_1 [V]\n0,3\n1,11\n",
        "a.csv, line 3, column 'pump_1': got '11 V', expected a value from 0 to 10 V",
    ),
    "Latin letters": (
        b"time [s],pump_1 [V]\n0,3 \xb5\n", "a.csv, line 2: got byte 0xb5, expected text",
    ),
    "wide letters": (
        "time [s],pump_1 [V]\n0,3\n".encode("utf-16"), "line 1: got byte 0xff, expected text",
    ),
    "open quotes": (
        b'time [s],pump_1 [V]\n0,3\n1,"3\n2,3\n', "a.csv, line 3: got 'unexpected end of data'",
    ),
    "wide letters without a mark": (
        "time [s],pump_1 [V]\n0,3\n".encode("utf-16-le"),
        "a.csv, line 1: got 'the control character U+0000', expected text; save it as CSV in UTF-8",
    ),
    "what a terminal obeys": (
        b"time [s],pump_1 [V]\n0,3\n1,\x1b[2J\n", "line 3: got 'the control character U+001B'",
    ),
    "a name that turns the line round": (
        "time [s],pump_1\u202e [V]\n0,3\n".encode(),
        "line 1: got 'pump_1\\u202e [V]', expected names that can be printed",
    ),
    "a line without end": (
        b"time [s],pump_1 [V]\n0,3" + 100_000 * b" ", "line 2: got 100003 characters",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_FILES)
def test_a_bad_file_is_refused_with_its_place(process, tmp_path, case):
    content, words = BAD_FILES[case]
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    with pytest.raises(InputError) as refusal:
        read_profile_csv(path, process)
    assert str(refusal.value).startswith(str(path))
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [("missing.csv", "no such file"), (".", "a folder"), ("/dev/zero", "no regular file")],
)
def test_a_file_that_is_none_is_refused(process, tmp_path, name, value):
    with pytest.raises(InputError) as refusal:
        read_profile_csv(tmp_path / name, process)
    assert (refusal.value.value, refusal.value.expected) == (value, "a CSV file")


def test_more_rows_than_can_be_told_apart_are_refused(process, tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"time [s],pump_1 [V]\n" + 400_000 * b"0,3\n")
    with pytest.raises(InputError) as refusal:
        read_profile_csv(path, process)
    assert refusal.value.value == "400,000 rows"
    assert refusal.value.remedy.startswith("keep one row of 2, ")


def test_of_many_changes_each_holds_until_the_next():
    changes = [Change("pump_1", float(k % 3), float(k), float(k)) for k in range(100_000)]
    found = profiles_of(changes, {"pump_1": 3.0}, 1.0, 100_000)["pump_1"]
    assert np.array_equal(found, np.arange(100_000) % 3)


def test_rows_closer_than_the_samples_are_refused(process, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time [s],pump_1 [V]\n0.1,3.1\n0.9,3.2\n")
    changes = read_profile_csv(path, process)
    with refused(place="line 3, column 'pump_1'", expected="at most one value of pump_1"):
        profiles_of(changes, {"pump_1": 3.0}, 1.0, 7)


def test_a_pretty_duration_is_never_shorter_and_at_most_a_third_longer():
    for least in np.geomspace(0.01, 1e7, 500):
        length = pretty_duration(float(least))
        assert least * (1 - 1e-8) <= length <= least * 4 / 3 * (1 + 1e-8)


def test_samples_on_the_grid_are_not_missed_by_rounding():
    for period in (0.05, 0.1, 0.3, 7.0, 60.0):
        assert all(samples_before(k * period, period) == k for k in range(0, 20000, 7))
