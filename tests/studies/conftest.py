"""Helpers of the tests of study files are imported by name."""

import sys
from pathlib import Path

import pytest

from clepsydra import InputError
from clepsydra.linear.linearise import linearise
from clepsydra.studies.file.reader import read_study

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def message(tmp_path, monkeypatch):
    """Return a function: text of a study file → the message that comes of it."""
    monkeypatch.chdir(tmp_path)

    def read(text):
        (tmp_path / "s.toml").write_text(text, encoding="utf-8")
        with pytest.raises(InputError) as caught:
            request = read_study("s.toml")
            model = linearise(request.analysis.operating_point)
            for controller in request.controllers:
                controller.make(request.analysis, model)
        return str(caught.value)

    return read
