"""docs/python.md names all that there is."""

from pathlib import Path

import pytest

import clepsydra as cl

PAGE = (Path(__file__).parent.parent / "docs" / "python.md").read_text()


@pytest.mark.parametrize("name", dir(cl.design))
def test_every_design_is_in_the_table(name):
    assert f"`{name}`" in PAGE
