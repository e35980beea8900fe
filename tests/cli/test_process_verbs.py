"""The verbs that list, draw and begin processes."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.reader import load_process


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def refused(result, *words):
    status, output, errors = result
    assert (status, output) == (2, "")
    assert errors.startswith("clepsydra: ") and "Traceback" not in errors
    for word in words:
        assert word in errors, (word, errors)


def test_processes_names_every_process_with_source_and_variants(command):
    status, short, _ = command("processes")
    assert status == 0 and len(short.splitlines()) <= 24
    whole = words_of(command("processes", "--all"))
    for name in catalogue_names():
        tables = tomllib.loads(catalogue_file(name).read_text(encoding="utf-8"))
        (row,) = (line for line in short.splitlines() if line.startswith(f"{name} "))
        assert tables["title"].split()[0] in row  # a long title goes on in the next line
        alone = words_of(command("processes", name))
        said = [name, tables["title"], f"Source: {tables['source']}"]
        said += [f"{name}:{variant}" for variant in tables.get("variants", {})]
        assert all(" ".join(each.split()) in text for each in said for text in (whole, alone))


@pytest.mark.parametrize("columns", ["80", "100"])
@pytest.mark.parametrize(
    "arguments",
    [
        ("processes",),
        ("processes", "averaging-tank"),
        ("draw", "wet-well"),
        ("new", "mine"),
        ("new", "mine", "--from", "three-tanks"),
        ("new", "mine", "--study"),
    ],
)
def test_the_answer_is_a_screen(command, monkeypatch, tmp_path, columns, arguments):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", columns)
    status, said, _ = command(*arguments)
    lines = [line.rstrip() for line in said.splitlines()]
    assert status == 0 and 1 <= len(lines) <= 25 and max(map(len, lines)) <= int(columns)


def test_a_process_that_the_catalogue_does_not_have_is_refused(command):
    status, _, error = command("processes", "wetwell")
    assert status == 2 and "perhaps 'wet-well' was meant" in error


def words_of(done):
    """What a command printed, its lines joined."""
    status, output, _ = done
    assert status == 0
    return " ".join(output.split())


def test_processes_prints_one_json_document_with_what_load_process_says(command):
    status, output, _ = command("processes", "--json")
    assert status == 0
    entries = json.loads(output)["processes"]
    assert [entry["name"] for entry in entries] == catalogue_names()
    for entry in entries:
        process = load_process(entry["name"])
        assert (entry["title"], entry["source"]) == (process.title, process.source)
        assert entry["variants"] == dict(process.variants)
        assert tuple(entry["default_variants"]) == tuple(process.variant)


def test_python_runs_the_package(tmp_path):
    source = str(Path(cl.__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-m", "clepsydra", "--version"],
        cwd=tmp_path, env={"PYTHONPATH": source}, capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    assert (done.returncode, done.stdout.strip()) == (0, f"clepsydra {cl.__version__}")


def test_draw_writes_the_picture_of_the_report(command, tmp_path):
    status, output, _ = command("draw", "quadruple-tank")
    assert (status, output) == (0, "Drawing: quadruple-tank.svg\n")
    root = ElementTree.parse(tmp_path / "quadruple-tank.svg").getroot()
    titles = [title.text for title in root.iter("{http://www.w3.org/2000/svg}title")]
    assert "pump pump_1, 3.00 V, 30 %" in titles
    assert names(tmp_path) == ["quadruple-tank.svg"]


def test_draw_closes_the_loops_of_a_controller(command, tmp_path):
    assert command("draw", "three-tanks", "--controller", "PI, SIMC", "-o", "loops.svg")[0] == 0
    assert command("draw", "three-tanks", "-o", "open.svg")[0] == 0
    closed, without = ((tmp_path / f"{name}.svg").read_text("utf-8") for name in ("loops", "open"))
    assert "LIC-103: controls level_3, setpoint 5.10 cm" in closed and "LIC" not in without
    refused(command("draw", "three-tanks", "--controller", "PI, none"), "PI, none")


def test_draw_writes_where_it_is_told(command, tmp_path):
    assert command("draw", "eight-tanks", "-o", "a.svg")[0] == 0
    assert names(tmp_path) == ["a.svg"]
    refused(command("draw", "eight-tanks", "-o", "a.png"), "--output", "a.png", ".svg")
    refused(command("draw", "eight-tonks"), "eight-tanks")
    assert names(tmp_path) == ["a.svg"]
    assert command("draw", "eight-tanks", "-o", "new/a.svg")[0] == 0
    assert names(tmp_path / "new") == ["a.svg"]


def test_a_plant_without_rest_is_drawn_and_the_reason_given(command, tmp_path):
    text = catalogue_file("quadruple-tank").read_text(encoding="utf-8")
    bad = text.replace('nominal = "3.00 V"', 'nominal = "9.99 V"')
    (tmp_path / "full.toml").write_text(bad, encoding="utf-8")
    status, output, errors = command("draw", "full.toml")
    assert (status, output) == (0, "Drawing: quadruple-tank.svg\n")
    assert "drawn without values" in errors and "tank_" in errors
    assert "9.99" not in (tmp_path / "quadruple-tank.svg").read_text(encoding="utf-8")


def test_what_a_plant_does_not_use_is_said_and_the_rest_is_drawn(command, tmp_path):
    text = catalogue_file("quadruple-tank").read_text(encoding="utf-8")
    (tmp_path / "lake.toml").write_text(text + "\n[reservoirs.lake]\n", encoding="utf-8")
    status, output, errors = command("draw", "lake.toml", "-o", "lake.svg")
    assert (status, output) == (0, "Drawing: lake.svg\n")
    line = text.count("\n") + 2
    assert f"reservoirs.lake (line {line}) of lake.toml has no effect" in " ".join(errors.split())
    assert command("draw", "quadruple-tank", "-o", "without.svg")[0] == 0
    assert (tmp_path / "lake.svg").read_bytes() == (tmp_path / "without.svg").read_bytes()


def test_a_new_file_loads(command, tmp_path):
    """That it can be studied as well, the README shows."""
    status, output, _ = command("new", "my-plant")
    assert status == 0 and "my-plant.toml" in output
    assert load_process(tmp_path / "my-plant.toml").name == "my-plant"
    assert names(tmp_path) == ["my-plant.toml"]


@pytest.mark.parametrize("name", ["quadruple-tank", "eight-tanks"])
def test_a_copy_differs_in_its_name_only(command, tmp_path, name):
    assert command("new", "mine", "--from", name)[0] == 0
    copied = (tmp_path / "mine.toml").read_text(encoding="utf-8").splitlines()
    original = catalogue_file(name).read_text(encoding="utf-8").splitlines()
    pairs = zip(copied, original, strict=True)
    assert [pair for pair in pairs if len(set(pair)) > 1] == [('name = "mine"', f'name = "{name}"')]
    assert load_process(tmp_path / "mine.toml").name == "mine"


def test_nothing_is_written_over(command, tmp_path):
    (tmp_path / "mine.toml").write_text("precious", encoding="utf-8")
    refused(command("new", "mine"), "mine.toml", "another name")
    refused(command("new", "mine", "--from", "quadruple-tank"), "mine.toml")
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == "precious"


@pytest.mark.parametrize("name", ["my tanks", "../mine", "a/b", "", "1st", "mine.toml", "ä"])
def test_a_name_that_is_no_name_is_refused(command, tmp_path, name):
    refused(command("new", name), "NAME", "letters, digits and single hyphens")
    assert names(tmp_path) == []


def test_a_name_with_spaces_is_pointed_to_the_title(command, tmp_path):
    refused(command("new", "my two tanks"), '"my-two-tanks"', "title")
    text = catalogue_file("quadruple-tank").read_text(encoding="utf-8")
    text = text.replace('name = "quadruple-tank"', 'name = "Quadruple tank"')
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    refused(command("analyse", "a.toml"), "a.toml, line", '"Quadruple-tank"', "title")


def test_a_copy_of_what_is_not_there_is_refused(command, tmp_path):
    refused(command("new", "mine", "--from", "quadruple-tonk"), "--from", "quadruple-tank")
    assert names(tmp_path) == []
