"""What an interrupted tuning keeps in a file: believed only as it was written."""

import json
import math
import os
import struct

import pytest

from clepsydra import InputError
from clepsydra.studies.tuning import memory as module
from clepsydra.studies.tuning.memory import Memory

POINT = struct.pack("2d", 0.5, -1.0)
ROWS = {POINT: [3.25, math.inf, 0.0], struct.pack("2d", 0.0, 1.0): [math.nan, 1.0, 2.0]}


def fresh() -> Memory:
    return Memory(2, 3, "one problem")


@pytest.fixture
def kept(tmp_path):
    memory = fresh()
    memory.rows |= ROWS
    memory.sensitivities[POINT] = math.inf
    memory.drawn[POINT] = [math.inf, 3.0]
    path = tmp_path / "mine.tuning.json"
    memory.save(path)
    return path


def sealed(path, **changed):
    """Write a file with other content and the seal of that content, as an attacker would."""
    said = json.loads(path.read_text()) | changed
    said.pop("seal")
    path.write_text(json.dumps(said | {"seal": module._seal(said)}))


def refusal(path) -> InputError:
    memory = fresh()
    with pytest.raises(InputError) as caught:
        memory.load(path)
    assert (memory.rows, memory.sensitivities, memory.drawn) == ({}, {}, {})
    return caught.value


def test_what_was_written_is_read_again(kept):
    memory = fresh()
    memory.load(kept)
    assert repr(memory.rows) == repr(ROWS)
    assert memory.sensitivities == {POINT: math.inf}
    assert memory.drawn == {POINT: [math.inf, 3.0]}


def test_a_number_that_was_changed_is_refused(kept):
    text = kept.read_text()
    assert text.count("3.25") == 1
    kept.write_text(text.replace("3.25", "0.25"))
    assert refusal(kept).value == "something else, or changed since"


def test_the_state_of_another_problem_is_refused(kept):
    other = Memory(2, 3, "another problem")
    with pytest.raises(InputError) as caught:
        other.load(kept)
    assert caught.value.value == "the state of another problem"
    assert str(kept) in caught.value.place


def test_another_problem_may_begin_afresh_but_not_over_what_no_tuning_wrote(kept):
    other, same = Memory(2, 3, "another problem"), fresh()
    assert other.load(kept, afresh=True) is True and other.rows == {}
    assert same.load(kept, afresh=True) is False and repr(same.rows) == repr(ROWS)
    kept.write_text("the user's own notes")
    with pytest.raises(InputError) as caught:
        other.load(kept, afresh=True)
    assert str(kept) in caught.value.place
    assert kept.read_text() == "the user's own notes"


@pytest.mark.parametrize(
    "changed",
    [
        {"candidates": [[POINT.hex(), ["3.25", 0.0, 0.0]]]},
        {"candidates": [[POINT.hex(), [3.25, True, 0.0]]]},
        {"candidates": [[POINT.hex(), [3.25, 0.0]]]},
        {"candidates": [[POINT.hex(), [3.25, 0.0, 0.5]]]},
        {"candidates": [[POINT.hex(), [3.25, 0.0, -1.0]]]},
        {"candidates": [[POINT.hex(), [3.25, 0.0, math.nan]]]},
        {"candidates": [[POINT.hex()[:-2], [3.25, 0.0, 0.0]]]},
        {"candidates": [[struct.pack("2d", math.nan, 0.0).hex(), [3.25, 0.0, 0.0]]]},
        {"candidates": [["not hexadecimal", [3.25, 0.0, 0.0]]]},
        {"candidates": 3},
        {"candidates": [3]},
        {"sensitivities": [[POINT.hex(), None]]},
        {"sensitivities": {"a": 1.0}},
        {"drawn": [[POINT.hex(), [1.0]]]},
        {"drawn": [[POINT.hex(), [1.0, 0.5]]]},
        {"drawn": [[POINT.hex(), [1.0, -1.0]]]},
        {"drawn": [[POINT.hex(), [1.0, math.inf]]]},
        {"drawn": [[POINT.hex(), ["1.0", 1.0]]]},
        {"drawn": [[POINT.hex(), None]]},
    ],
    ids=repr,
)
def test_content_of_another_kind_is_refused_even_under_its_own_seal(kept, changed):
    sealed(kept, **changed)
    assert refusal(kept).value == "something else, or changed since"


@pytest.mark.parametrize(
    "text", ["", "null", "[]", "3", '{"seal": 3}', "[" * 100_000, '{"a":' * 100_000, "\0", "nan"]
)
def test_what_no_tuning_wrote_is_refused(kept, text):
    kept.write_text(text)
    assert refusal(kept).value == "something else, or changed since"


def test_a_file_that_was_cut_off_is_refused(kept):
    content = kept.read_bytes()
    kept.write_bytes(content[: len(content) // 2])
    assert refusal(kept).value == "something else, or changed since"


@pytest.mark.skipif(os.name != "posix", reason="FIFOs of POSIX")
def test_a_fifo_does_not_wait(kept):
    kept.unlink()
    os.mkfifo(kept)
    assert refusal(kept).value == "no regular file"


def test_a_larger_file_than_any_tuning_writes_is_refused(kept, monkeypatch):
    monkeypatch.setattr(module, "_LARGEST", 100)
    assert refusal(kept).value == "more than 0.0001 MB"
