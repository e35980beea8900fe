"""What an earlier proof wrote: read like any other file."""

import json
import os

import pytest

from clepsydra import InputError
from clepsydra.deploy.proof.row import ProofRow, read_memory


def refused(path):
    with pytest.raises(InputError) as refusal:
        read_memory(path)
    return refusal.value


def test_a_pipe_in_its_place_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "proof.json")
    assert refused(tmp_path / "proof.json").value == "no regular file"


@pytest.mark.parametrize("content", [b"", b"[1]", b"[" * 100_000, b"\xff"])
def test_what_is_no_proof_is_a_message(content, tmp_path):
    (tmp_path / "proof.json").write_bytes(content)
    assert refused(tmp_path / "proof.json").value == "something else"


SCORES = {"ranking": 1.01, "score": "iae[level]", "change": None, "is_change": True}


def written(row, path):
    path.write_text(json.dumps({"rows": [row]}))
    return path


@pytest.mark.parametrize("scores", [{}, SCORES])
@pytest.mark.parametrize("largest", [0.5, float("inf")])
def test_what_a_proof_wrote_is_read_as_it_was(largest, scores, tmp_path):
    row = ProofRow("PI", "C", "single", "engine", "d", 9, 1, largest=largest, text="t",
                   verdict="diverges", scores=scores)  # fmt: skip
    assert read_memory(written(row.as_dict(), tmp_path / "proof.json")) == {row.key: row}


@pytest.mark.parametrize(
    "changed",
    [
        {"text": ["t"]}, {"version": {}}, {"seconds": "fast"}, {"seconds": float("nan")},
        {"scan": 0.5}, {"bound": "none"}, {"largest": float("inf")}, {"scores": 5},
        {"scores": {**SCORES, "ranking": "first"}}, {"scores": {"is_change": True}},
    ],
)  # fmt: skip
def test_a_row_changed_by_hand_is_a_message(changed, tmp_path):
    row = ProofRow("PI", "C", "single", "engine", "d", 9, 1, text="t", verdict="reported")
    path = written(row.as_dict() | changed, tmp_path / "proof.json")
    assert refused(path).value == "something else"
