"""docs/python.md names all that there is."""

import re
from pathlib import Path

import pytest
import typer

import clepsydra as cl
from clepsydra.cli.application import application

PAGE = (Path(__file__).parent.parent / "docs" / "python.md").read_text()
VERBS = sorted(typer.main.get_command(application()).commands)
#: What the page says of verbs whose calls have another name: `new` is `cl.new_process` and …
OTHERWISE = {
    verb: re.findall(r"`cl\.(\w+)`", names)
    for verb, names in re.findall(
        r"`(\w[\w-]*)` is\s+(?:the\s+module\s+)?((?:(?:,?\s*(?:and\s+)?)?`cl\.\w+`)+)", PAGE
    )
}


@pytest.mark.parametrize("name", dir(cl.design))
def test_every_design_is_in_the_table(name):
    assert f"`{name}`" in PAGE, f"docs/python.md: write `{name}` into the table of the designs"


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_is_a_call_or_the_page_says_what_to_use(verb):
    remedy = f"publish cl.{verb}, or write into docs/python.md that `{verb}` is `cl.…`"
    for name in OTHERWISE.get(verb, [verb]):
        assert name in cl.__all__, remedy


def test_only_verbs_that_are_no_calls_have_another_name():
    assert OTHERWISE.keys() <= set(VERBS) - set(cl.__all__)
    assert OTHERWISE["new"] == ["new_process", "new_study", "new_lesson"] and len(OTHERWISE) > 3
