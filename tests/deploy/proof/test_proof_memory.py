"""What an earlier proof wrote: read like any other file."""

import os

import pytest

from clepsydra import InputError
from clepsydra.deploy.proof.row import read_memory


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
