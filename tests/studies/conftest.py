"""Helpers of the tests of study files are imported by name."""

import sys
from pathlib import Path

import pytest

import clepsydra as cl
from clepsydra import InputError

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def message(tmp_path, monkeypatch):
    """Return a function: text of a study file → the message that comes of it."""
    monkeypatch.chdir(tmp_path)

    def read(text):
        (tmp_path / "s.toml").write_text(text, encoding="utf-8")
        with pytest.raises(InputError) as caught:
            cl.study("s.toml")
        return str(caught.value)

    return read
