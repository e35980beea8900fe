"""docs/python.md names all that there is."""

from pathlib import Path

import pytest
import typer

import clepsydra as cl
from clepsydra.cli.application import application

PAGE = (Path(__file__).parent.parent / "docs" / "python.md").read_text()
VERBS = sorted(typer.main.get_command(application()).commands)
#: Verbs whose calls have another name, with these.
OTHERWISE = {
    "new": ("new_process", "new_study"),
    "processes": ("catalogue",),
    "papers": ("audit",),
    "designs": ("design",),
}


@pytest.mark.parametrize("name", dir(cl.design))
def test_every_design_is_in_the_table(name):
    assert f"`{name}`" in PAGE


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_is_a_call_or_the_page_says_what_to_use(verb):
    for name in OTHERWISE.get(verb, (verb,)):
        assert name in cl.__all__
        assert callable(getattr(cl, name)) or verb == "designs"
        assert verb == name or (f"`{verb}` is" in PAGE and f"`cl.{name}`" in PAGE)


def test_only_these_have_another_name():
    assert set(OTHERWISE) == set(VERBS) - set(cl.__all__)
