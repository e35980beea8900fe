"""The page on fuzzy files: its keys and its example are those of the reader."""

import re
from pathlib import Path

import numpy as np
from pages import blocks

import clepsydra as cl
from clepsydra.controllers.fuzzy import file as fuzzy_file

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
    plant = cl.load("quadruple-tank")
    controller = cl.design.fuzzy(plant, tmp_path / "level-rules.toml")
    steps = [cl.step("level_1", by, at=at) for by, at in (("+1 V", 0), ("-1 V", 600))]
    run = cl.simulate(plant, controller, steps, duration=1200)
    level = run.true_measurement("level_1")
    error = run.scenario.setpoints[:, 0] - level
    for start in (0, 600):
        assert abs(error[start]) > 0.9
        assert np.abs(error[start + 540 : start + 600]).max() < 0.05
