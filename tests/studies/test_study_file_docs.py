"""The page on study files: its keys, defaults and examples are those of the reader."""

import re
import tomllib
from pathlib import Path

import pytest
from pages import blocks

from clepsydra.designs.design import DESIGNS
from clepsydra.linear.linearise import linearise
from clepsydra.studies.file.from_files import OwnLawTable
from clepsydra.studies.file.reader import read_study, study_schema
from clepsydra.studies.file.scheme_parts import SchemeParts

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "study-files.md").read_text(encoding="utf-8")
CASES = (DOCS / "cases.md").read_text(encoding="utf-8")
SECTIONS = {
    title: text
    for page in (PAGE, CASES)
    for title, text in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL)
}
EXAMPLES = [
    block.text for page in ("study-files", "cases") for block in blocks(f"docs/{page}.md", "toml")
]


def rows(section):
    """Return the keys that each table of a section describes, and the other cells of its rows."""
    found = []
    for table in re.findall(r"(?:^\|.*\|\n)+", SECTIONS[section], re.MULTILINE):
        _, _, *lines = table.splitlines()
        cells = [re.split(r"(?<!\\)\|", line)[1:-1] for line in lines]
        found.append(
            {
                key: [cell.strip() for cell in others]
                for first, *others in cells
                for key in re.findall(r"`(\w+)`", first)
            }
        )
    return found


STUDY = study_schema()
SCENARIO = STUDY["properties"]["scenario"]
#: The schema of a controller's keys, and of each part of a scheme by the key of its table.
KEYS = STUDY["properties"]["controllers"]["additionalProperties"]["properties"]
PARTS = {key: KEYS[key]["additionalProperties"] for key in SchemeParts.properties()}


@pytest.mark.parametrize(
    ("section", "table", "schema"),
    [
        ("General keys", 0, STUDY),
        ("Scenario", 0, SCENARIO),
        ("Scenario", 1, SCENARIO["properties"]["load"]["items"]),
        ("Ranking", 0, STUDY["properties"]["ranking"]),
        ("Keys of a case", 0, STUDY["properties"]["cases"]["additionalProperties"]),
        ("Tuning", 0, KEYS["tune"]),
        ("Loops", 0, PARTS["loops"]),
        ("Outputs", 0, PARTS["outputs"]),
        ("Selectors", 0, PARTS["selectors"]),
        ("Split ranges", 0, PARTS["split_ranges"]),
        ("Split ranges", 1, PARTS["split_ranges"]["properties"]["parts"]["items"]),
        ("Ratios", 0, PARTS["ratios"]),
        ("Feedforward", 0, PARTS["feedforward"]),
        ("Start and stop levels", 0, KEYS["start_stop"]),
        ("Laws of your own", 0, {"properties": OwnLawTable.properties()}),
    ],
)
def test_a_table_describes_every_key_in_the_words_of_its_declaration(section, table, schema):
    said = {key: cells[0].replace("\\|", "|") for key, cells in rows(section)[table].items()}
    assert said == {key: in_words(each) for key, each in schema["properties"].items()}


def in_words(schema):
    """Return what a key is and, where that does not say so, what it may be."""
    words, choices = schema["description"], [f'`"{each}"`' for each in schema.get("enum", [])]
    return words if all(each in words for each in choices) else f"{words}: {', '.join(choices)}"


def test_every_row_is_of_a_design():
    assert set(rows("Controllers by a design")[0]) <= set(DESIGNS)


@pytest.mark.parametrize("name", DESIGNS)
def test_the_keys_of_a_design_are_its_arguments(name):
    """Each design has a row."""
    keys = DESIGNS[name].file_keys
    remedy = f"docs/study-files.md, Controllers by a design: write a row for `{name}` with {keys}"
    *_, said = rows("Controllers by a design")[0].get(name, [""])
    assert tuple(re.findall(r"`(\w+)`", said)) == keys and said, remedy


def test_every_argument_of_a_design_is_explained_in_its_own_words():
    declared = {}
    for argument in (each for design in DESIGNS.values() for each in design.declared.values()):
        for key, schema in argument.properties.items():
            known = declared.setdefault(key, {**schema})
            assert known["description"] == schema["description"]
            if "enum" in schema:
                known["enum"] = list(dict.fromkeys([*known["enum"], *schema["enum"]]))
    expected = {key: in_words(schema) for key, schema in declared.items()}
    found = {key: cell for key, (cell,) in rows("Controllers by a design")[1].items()}
    said = {key: cell.replace("\\|", "|") for key, cell in found.items()}
    lacking = {key: words for key, words in expected.items() if said.get(key) != words}
    assert not lacking, "docs/study-files.md, Controllers by a design: write rows for these"
    assert said.keys() == expected.keys()


@pytest.mark.sampled
@pytest.mark.parametrize("number", range(len(EXAMPLES)))
def test_an_example_is_read_and_its_controllers_made(number, tmp_path):
    text = EXAMPLES[number]
    if "process" not in tomllib.loads(text):
        text = f'process = "equalisation-tank"\n{text}'
    own = blocks("docs/own-law.md", "python")[0]
    (tmp_path / own.file).write_text(own.text)
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    study = read_study(tmp_path / "study.toml")
    model = linearise(study.analysis.operating_point)
    controllers = [request.make(study.analysis, model) for request in study.controllers]
    assert [c.name for c in controllers] == list(tomllib.loads(text).get("controllers", {}))
    # At its operating point the relief valve is open beside the pump, which no split range does.
    moves = "split_ranges" in text
    for controller in controllers:
        assert any("does not begin at rest" in note for note in controller.notes) == moves, (
            controller.name
        )


def test_there_is_an_example_of_every_structure():
    used = {
        key
        for text in EXAMPLES
        for controller in tomllib.loads(text).get("controllers", {}).values()
        for key in controller
    }
    assert used >= {*SchemeParts.properties(), "design", "law", "start_stop", "tune"}


def test_what_the_page_links_to_exists():
    links = re.findall(r"\]\((?!https?:)([^)]+)\)", PAGE)
    assert links
    for link in links:
        file, _, section = link.partition("#")
        known = {name.lower() for name in SECTIONS}
        assert (DOCS / file).is_file() if file else section.replace("-", " ") in known, link


LEVEL = """process = "equalisation-tank"
[controllers.a.loops.level]
measurement = "level"
output = "outflow"
actions = "PID"
action = "direct"
gain = "2 %/%"
integral_time = "4 h"
derivative_time = "15 min"
"""


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("derivative_filter", "10"),
        ("algorithm", '"isa"'),
        ("derivative_on", '"measurement"'),
        ("setpoint_weight", "1"),
        ("anti_windup", '"back_calculation"'),
        ("tracking_time", '"1 h"'),  # √(4 h · 15 min)
        ("error", '"linear"'),
        ("remote_setpoint", "false"),
        ("setpoint", '"operator"'),
    ],
)
def test_a_default_is_what_a_missing_key_means(key, value, tmp_path):
    said = rows("Loops")[0][key][-1].strip("`")
    bare = value.strip('"')
    assert said == bare or key in ("tracking_time", "setpoint")
    made = []
    for text in (LEVEL, f"{LEVEL}{key} = {value}\n"):
        (tmp_path / "study.toml").write_text(text, encoding="utf-8")
        study = read_study(tmp_path / "study.toml")
        made.append(study.controllers[0].make(study.analysis, study.analysis.model))
    first, second = made
    assert first.values == second.values and first.initial_state == second.initial_state
    assert [s.name for s in first.law.inputs] == [s.name for s in second.law.inputs]
