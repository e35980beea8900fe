"""``clepsydra analyse --output``: the page is written, or nothing is."""

import json
from pathlib import Path

import pytest

from clepsydra.cli import main

ONE_TANK = str(Path(__file__).parents[1] / "one-tank.toml")


def run(*arguments):
    try:
        main(list(arguments))
    except SystemExit as ending:
        return ending.code or 0
    return 0


def test_it_writes_a_page_beside_the_table(tmp_path, capsys):
    target = tmp_path / "tank.html"
    assert run("analyse", ONE_TANK, "--output", str(target)) == 0
    assert f"Page: {target}" in capsys.readouterr().out.replace("\n", "")
    assert target.read_text("utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.thorough
def test_json_names_the_page_in_a_folder_that_is_made(tmp_path, capsys):
    target = tmp_path / "a" / "b" / "tank.html"
    assert run("analyse", ONE_TANK, "--json", "-o", str(target)) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["page"] == str(target)
    assert target.exists()


@pytest.mark.parametrize("name", ["tank.svg", "tank", "folder.html"])
def test_another_name_is_refused(tmp_path, capsys, name):
    (tmp_path / "folder.html").mkdir()
    assert run("analyse", "quadruple-tank", "--output", str(tmp_path / name)) == 2
    assert "ends in .html" in capsys.readouterr().err.replace("\n", " ")
    assert [entry.name for entry in tmp_path.iterdir()] == ["folder.html"]
