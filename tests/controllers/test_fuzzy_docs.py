"""The page on fuzzy files: its keys and its example are those of the reader."""

import re
from pathlib import Path

import numpy as np
from pages import blocks

from clepsydra.controllers.fuzzy import file as fuzzy_file
from clepsydra.controllers.fuzzy.file import load_fuzzy
from clepsydra.controllers.fuzzy.wired import WiredFuzzy
from clepsydra.linear.analysis import analyse
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.process.reader import load_process

PAGE = (Path(__file__).parents[2] / "docs" / "fuzzy-files.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL))


def keys(section):
    return re.findall(r"^\| `(\w+)`", SECTIONS[section], re.MULTILINE)


def test_every_key_is_told_and_no_other():
    assert keys("General keys") == list(fuzzy_file._KEYS)
    assert sorted(keys("Inputs")) == sorted(fuzzy_file.INPUT_KEYS)
    assert sorted(keys("Outputs")) == sorted(fuzzy_file.OUTPUT_KEYS)
    assert sorted(keys("Sets")) == sorted(fuzzy_file._SHAPES)
    assert len(PAGE.splitlines()) <= 200


def test_the_example_holds_the_level(tmp_path):
    (block,) = (b for b in blocks("docs/fuzzy-files.md") if b.file == "level-rules.toml")
    (tmp_path / block.file).write_text(block.text, encoding="utf-8")
    analysis = analyse(load_process("quadruple-tank"))
    point = analysis.operating_point
    file = load_fuzzy(tmp_path / "level-rules.toml")
    controller = WiredFuzzy(file, point.process).controller(point, "by rules")
    scenario = default_scenario(analysis.model)
    run = Loop(controller, analysis.model).run(scenario)
    step = next(s for s in scenario.segments if s.signal == "level_1")
    error = scenario.setpoints[:, 0] - run.true_measurement("level_1")
    assert abs(error[int(step.start)]) > 0.9
    assert np.abs(error[int(step.stop) - 60 : int(step.stop)]).max() < 0.05
