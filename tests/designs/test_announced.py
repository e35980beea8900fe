"""What the files of designs announce in their text is what they register."""

from importlib import import_module
from pathlib import Path

import pytest

from clepsydra import designs
from clepsydra.designs.announced import announced_in
from clepsydra.designs.design import DESIGNS

FILES = sorted(Path(designs.__file__).parent.glob("[a-z]*.py"))


def told(each):
    return each.name, each.words, each.studied, each.place


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_file_announces_what_it_registers(file) -> None:
    module = import_module(f"{designs.__name__}.{file.stem}").__name__
    registered = [each for each in DESIGNS.values() if each.function.__module__ == module]
    announced = sorted(announced_in(file.read_text(encoding="utf-8")), key=lambda each: each.place)
    assert list(map(told, announced)) == list(map(told, registered))


def test_a_constant_of_the_file_is_read_and_nothing_else_is_run() -> None:
    text = 'NAME = "PI, lag"\n@design(\n    "lag",\n    "PI",\n    Studied(25, NAME, {"a": "b"}),\n'
    (each,) = announced_in(f"{text}    keys=(exit(),),\n)\ndef design_lag(model): ...\n")
    assert told(each) == ("lag", "PI", each.studied, (25, "lag"))
    assert (each.studied[0].name, each.studied[0].arguments) == ("PI, lag", {"a": "b"})
