"""docs/papers/runs.md: its commands run as they stand, and give the numbers beside the printed."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from pages import ROOT, blocks, command, lines

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

import run_page_pictures as drawn

import clepsydra as cl
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.set_ups import MINIMUM, NON_MINIMUM
from clepsydra.papers.four_tank_laboratory.simulator import runs
from clepsydra.papers.four_tank_variable_structure.rig import fill, in_nu

TEXT = (ROOT / drawn.PAGE).read_text(encoding="utf-8")
#: Columns of the tables after the first two: the scores of a level or a pump, 1 and 2.
LABORATORY = ("rise_time[level_{}]", "overshoot[level_{}]", "return_time[level_{}]")
FILLING = (
    "rise_time[level_{}]",
    "overshoot[level_{}]",
    "settling_time_2[level_{}]",
    "time_in_saturation[pump_{}]",
)
#: Table and set-up of each figure.
FIGURES = {
    "7": ("Table 5", "decentralised", MINIMUM),
    "8": ("Table 5", "decentralised", NON_MINIMUM),
    "9": ("Table 6", "robust", MINIMUM),
    "10": ("Table 6", "robust", NON_MINIMUM),
}


def numbers_of(*rows):
    """Return the numbers as they stand behind the beginning of each row: [row][column][1 or 2]."""
    (found,) = re.findall("".join(rf"^{re.escape(row)}(.*)\n" for row in rows), TEXT, re.MULTILINE)
    rest = [found] if isinstance(found, str) else found
    return [[cell.strip().split(", ") for cell in row.strip(" |").split("|")] for row in rest]


def of_figure(figure):
    """Return what is printed, and what the page says of our run."""
    return numbers_of(f"| {figure} | printed |", "| | this run |")


def agree(told, scores, columns):
    """Each number is the score, rounded to the digits that the page has."""
    for numbers, column in zip(told, columns, strict=True):
        for place, number in enumerate(numbers, start=1):
            half = 0.5 * 10.0 ** -len(number.partition(".")[2])
            # 1.001: a time that is a whole number of samples may lie half-way.
            value = scores[column.format(place)]
            assert float(number) == pytest.approx(value, abs=1.001 * half), column


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder in which the first Python of the page has written its regulators."""
    place = tmp_path_factory.mktemp("runs")
    first = blocks(drawn.PAGE, "python")[0]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        first.run(place, {})
    return place


@pytest.mark.parametrize("figure", FIGURES)
def test_the_command_of_a_figure_gives_what_the_page_says(folder, figure, capsys):
    (words,) = (
        words
        for block in blocks(drawn.PAGE, "sh")
        for words in lines(block.text)
        if words[-1] == f"figure-{figure}"
    )
    command([*words[1:], "--json"], folder, drawn.PAGE)
    found = json.loads(capsys.readouterr().out)
    assert found["noise"] == {"pump_1.noise": 0.1, "pump_2.noise": 0.1} and found["seed"] == 1
    assert found["start"] == "empty" and Path(folder, found["trajectories"]).exists()
    _, told = of_figure(figure)
    agree(told, found["scores"], LABORATORY)


@pytest.mark.parametrize("figure", FIGURES)
def test_what_stands_there_as_printed_is_that_of_the_tables(figure):
    table, _, set_up = FIGURES[figure]
    printed, _ = of_figure(figure)
    for numbers, score in zip(printed, ("rise", "overshoot", "recovery"), strict=True):
        tanks = ["1/2"] if len(numbers) == 1 else ["1", "2"]
        values = [PRINTED[table, f"{score} {tank}, {set_up.phase}"].value for tank in tanks]
        assert [float(number) for number in numbers] == values


@pytest.mark.thorough
@pytest.mark.parametrize("figure", FIGURES)
def test_rise_and_overshoot_lie_within_nearly_all_runs_of_the_audit(figure):
    """Whose controllers are designed by other code, from sampled models."""
    _, kind, set_up = FIGURES[figure]
    _, told = of_figure(figure)
    many = runs(set_up, kind, "percent")
    for numbers, score in zip(told, ("rise", "overshoot"), strict=False):
        for tank, number in enumerate(numbers, start=1):
            low, high = np.quantile(many.scored(score, tank), (0.025, 0.975), method="nearest")
            assert low - 0.05 <= float(number) <= high + 0.05, (score, tank)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return drawn.made_runs(tmp_path_factory.mktemp("made"))


@pytest.mark.thorough
@pytest.mark.parametrize("way", ["conventional", "variable"])
def test_the_python_of_the_page_fills_the_tanks_as_the_audit_does(made, way):
    found = made[way]
    words = {"variable": "variable structure"}.get(way, way)
    (told,) = numbers_of(f"| this run, {words} |")
    agree(told, found.scores, FILLING)
    audit = fill(in_nu("none" if way == "conventional" else "variable_structure"))
    for tank in (1, 2):
        scores = (audit.rise(tank), audit.overshoot(tank), audit.settling(tank))
        for column, (value,) in zip(FILLING, scores, strict=False):
            # The audit keeps every second sample.
            assert found.scores[column.format(tank)] == pytest.approx(value, abs=0.05)


@pytest.mark.thorough
def test_the_study_file_gives_what_the_page_says(tmp_path, monkeypatch):
    (block,) = blocks(drawn.PAGE, "toml")
    (tmp_path / block.file).write_text(block.text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    ranking = cl.study(block.file).ranking
    assert ranking[0].controller.name == "conditional"
    for candidate in ranking:
        (told,) = numbers_of(f"| study, {candidate.controller.name} |")
        agree(told, candidate.scores, FILLING)


@pytest.mark.thorough
def test_the_python_of_the_page_makes_the_runs_of_its_commands(made):
    for figure in FIGURES:
        agree(of_figure(figure)[1], made[figure].scores, LABORATORY)


@pytest.mark.thorough
def test_the_pictures_are_those_of_the_runs(made):
    """Where they are not, python tools/run_page_pictures.py makes them again: look at them."""
    for name, svg in drawn.pictures(made).items():
        assert (drawn.FOLDER / name).read_text(encoding="utf-8") == svg, name
