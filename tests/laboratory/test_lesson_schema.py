"""The lesson file to begin with, and the schema that editors check lessons by."""

import tomllib
from pathlib import Path

import pytest
from json_schema import faults
from pages import blocks

import clepsydra as cl
from clepsydra.laboratory.lessons.lesson import lesson_names, read_lesson
from clepsydra.laboratory.lessons.schema import lesson_schema

SCHEMA = lesson_schema()
ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "src" / "clepsydra" / "laboratory" / "lessons" / "shipped"
TASK = 'title = "a"\nprocess = "three-tanks"\n[[tasks]]\ntitle = "b"\n'


def found(text):
    return list(faults(tomllib.loads(text), SCHEMA))


@pytest.fixture
def begun(tmp_path):
    """The text of the file to begin with, without the signs of what may be left out."""
    path = cl.new_lesson("mine", folder=tmp_path)
    lines = path.read_text(encoding="utf-8").splitlines()
    return "\n".join(line.removeprefix("# ") if " = " in line else line for line in lines)


@pytest.mark.parametrize("name", lesson_names())
def test_it_fits_the_lessons_of_clepsydra(name):
    assert found((SHIPPED / f"{name}.toml").read_text(encoding="utf-8")) == []


def test_it_fits_the_lesson_of_the_page():
    (lesson,) = (
        block for block in blocks(ROOT / "docs" / "lessons.md", "toml") if "tasks" in block.table
    )
    assert found(lesson.text) == []


def test_the_file_to_begin_with_is_read_and_has_every_key(begun, tmp_path):
    assert found(begun) == []
    path = tmp_path / "whole.toml"
    path.write_text(begun, encoding="utf-8")
    lesson = read_lesson(path)
    assert [task.title for task in lesson.tasks] == ["Fill a tank", "The other way round"]

    def missing(schema, tables):
        known = {key for table in tables for key in table}
        return set(schema["properties"]) - known

    tables = tomllib.loads(begun)
    task = SCHEMA["properties"]["tasks"]["items"]
    rows = {
        what: [row for each in tables["tasks"] for row in each.get(what, [])]
        for what in ("reach", "figures")
    }
    assert missing(SCHEMA, [tables]) == set()
    assert missing(task, tables["tasks"]) == set()
    for what, each in rows.items():
        assert missing(task["properties"][what]["items"], each) == set(), what
    # Half the width of the band of a settling time; an overshoot has none.
    measure = task["properties"]["figures"]["items"]["properties"]["measure"]
    assert missing(measure, [row.get("measure", {}) for row in rows["figures"]]) == {"band"}


@pytest.mark.parametrize(
    "text",
    [
        "",
        'title = "a"\nprocess = "three-tanks"\n',
        TASK + "hint = []",
        TASK + 'start = "full"',
        TASK + "noise = 1",
        TASK + 'reach = [{ hold = "1 s" }]',
        TASK + 'reach = [{ words = "a", hold = "-1 s" }]',
        TASK + 'reach = [{ words = "a", hold = "1 m" }]',
        TASK + 'figures = [{ words = "a", answer = { zero = "left" } }]',
        TASK + 'figures = [{ words = "a", measure = { kind = "overshot", signal = "h1" } }]',
        TASK + '[controllers.PI]\ndesign = "smic"',
        TASK + '[controllers.PI]\ndesign = "simc"\ntune = {}',
        TASK + '[setups.other]\ntitle = "a"',
    ],
)
def test_it_refuses_what_is_wrong(text):
    assert len(found(text)) >= 1
