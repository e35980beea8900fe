"""The page on study files: its keys, defaults and examples are those of the reader."""

import re
import tomllib
from pathlib import Path

import pytest
from pages import blocks

from clepsydra.linear.linearise import linearise
from clepsydra.studies.file import design_arguments, scheme, scheme_parts
from clepsydra.studies.file.design_names import DESIGN_NAMES
from clepsydra.studies.file.own_law_table import OWN_LAW_KEYS
from clepsydra.studies.file.pid_table import LOOP_KEYS
from clepsydra.studies.file.reader import RANKING_KEYS, STUDY_KEYS, read_study
from clepsydra.studies.file.scenario_reader import SCENARIO_KEYS, STEP_KEYS
from clepsydra.studies.file.start_stop_table import START_STOP_KEYS
from clepsydra.studies.file.tuning_reader import TUNING_KEYS

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "study-files.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL))
EXAMPLES = [block.text for block in blocks("docs/study-files.md", "toml")]


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


@pytest.mark.parametrize(
    ("section", "table", "keys"),
    [
        ("General keys", 0, STUDY_KEYS),
        ("Scenario", 0, SCENARIO_KEYS),
        ("Scenario", 1, STEP_KEYS),
        ("Ranking", 0, RANKING_KEYS),
        ("Controllers by a design", 0, DESIGN_NAMES),
        ("Tuning", 0, TUNING_KEYS),
        ("Loops", 0, LOOP_KEYS),
        ("Outputs", 0, scheme_parts.OUTPUT_KEYS),
        ("Selectors", 0, scheme_parts.SELECTOR_KEYS),
        ("Split ranges", 0, scheme_parts.SPLIT_KEYS),
        ("Split ranges", 1, scheme_parts.PART_KEYS),
        ("Ratios", 0, scheme_parts.RATIO_KEYS),
        ("Feedforward", 0, scheme_parts.FEEDFORWARD_KEYS),
        ("Start and stop levels", 0, START_STOP_KEYS),
        ("Laws of your own", 0, OWN_LAW_KEYS),
    ],
)
def test_a_table_describes_every_key_that_is_read(section, table, keys):
    assert set(rows(section)[table]) == set(keys)


@pytest.mark.parametrize("name", DESIGN_NAMES)
def test_the_keys_of_a_design_are_its_arguments(name):
    said = re.findall(r"`(\w+)`", rows("Controllers by a design")[0][name][-1])
    assert tuple(said) == design_arguments.design_keys(DESIGN_NAMES[name].load())


def test_every_argument_of_a_design_is_explained():
    explained = set(rows("Controllers by a design")[1])
    every = {k for d in DESIGN_NAMES.values() for k in design_arguments.design_keys(d.load())}
    assert explained == every


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
    assert used >= {*scheme.SCHEME_KEYS, "design", "law", "start_stop", "tune"}


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
