"""A study file names a file of sets and rules."""

import shutil
from pathlib import Path

import pytest

from clepsydra import InputError
from clepsydra.linear.analysis import analyse
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.papers.averaging_tank.fuzzy import RULES
from clepsydra.process.document import parse
from clepsydra.process.reader import load_process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.fuzzy_table import FUZZY_KEYS, read_fuzzy_table


def table(text):
    return TableReader(parse(text.encode(), "study.toml", "study"), (), FUZZY_KEYS)


@pytest.mark.thorough
def test_the_documents_controller_runs_from_its_file_and_starts_without_a_bump(tmp_path):
    shutil.copy(RULES, tmp_path / "rules.toml")
    analysis = analyse(load_process("averaging-tank:all-inputs"))
    point = analysis.operating_point
    found = read_fuzzy_table(table('fuzzy = "rules.toml"'), "rules", point.process, Path(tmp_path))
    controller = found.controller(point)
    run = Loop(controller, analysis.model).run(default_scenario(analysis.model))
    assert run.values["inflow"][0] == pytest.approx(0.2, abs=1e-9)
    assert run.values["inflow"][int(5.0 / point.process.sampling_period)] > 0.3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fuzzy = 7", "study.toml, line 1, fuzzy: got 7, expected the name of a file of sets"),
        ('fuzzy = "no.toml"', "study.toml, line 1, fuzzy: got 'no.toml', expected the name of a f"),
        ('fuzzy = "."', "study.toml, line 1, fuzzy: got '.', expected the name of a file of sets"),
        ('fuzzy = "bad.toml"', "{folder}/bad.toml, line 3, inputs.e.of: got 'level', expected a s"),
    ],
)
def test_mistakes(text, message, tmp_path):
    rules = RULES.read_text(encoding="utf-8")
    rules = "\n" + rules[rules.index("[inputs.e_C]") :].replace(
        'of = "concentration"', 'of = "level"'
    )
    rules = rules.replace("e_C", "e")
    (tmp_path / "bad.toml").write_text(rules, encoding="utf-8")
    process = load_process("averaging-tank:all-inputs")
    with pytest.raises(InputError) as found:
        read_fuzzy_table(table(text), "rules", process, tmp_path)
    assert str(found.value).startswith(message.format(folder=tmp_path)), str(found.value)
