"""The verb that puts a controller on many plants."""

import json

import pytest

ASKED = ("robustness", "three-tanks", "--controller", "PI, SIMC", "--no-sensitivity")


def test_it_writes_a_page_and_the_numbers(command, tmp_path):
    status, text, _ = command(*ASKED, "--draws", "60", "--output", str(tmp_path))
    assert status == 0
    assert "On 95 % of the plants the error is at most" in text
    said = json.loads((tmp_path / "three-tanks-pi-simc-robustness.json").read_text())
    assert said["draws"] == 60
    assert said["scores"]["error"]["nominal"] == 1.0
    assert (tmp_path / "three-tanks-pi-simc-robustness.html").stat().st_size > 10_000
    assert not (tmp_path / "three-tanks-pi-simc-draws.json").exists()


def test_draws_of_an_interrupted_command_are_not_lost(command, tmp_path):
    left = tmp_path / "three-tanks-pi-simc-draws.json"
    left.write_text("{}")
    status, output, errors = command(*ASKED, "--draws", "60", "--output", str(tmp_path))
    assert (status, output) == (2, "")
    assert "add --resume to go on with them" in errors
    assert left.read_text() == "{}"
    status, _, errors = command(*ASKED, "--draws", "60", "--output", str(tmp_path), "--resume")
    assert status == 2 and "delete this one to begin again" in errors


@pytest.mark.thorough
def test_workers_draw_the_same(command):
    pytest.importorskip("distributed", reason="the extra cluster is not installed")
    alone, there = (
        command(*ASKED, "--draws", "60", "--json", *more) for more in ((), ("--workers", "1"))
    )
    assert there[0] == 0
    assert json.loads(there[1]) == json.loads(alone[1])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--draws", "0"), "--draws"),
        (("--workers", "1", "--cluster", "tcp://127.0.0.1:1"), "--workers: got 1"),
        (("--cluster", "elsewhere"), "--cluster"),
    ],
)
def test_a_mistake_is_told_by_its_option(command, arguments, said):
    status, output, errors = command(*ASKED, "--json", *arguments)
    assert (status, output) == (2, "")
    assert said in errors and "Traceback" not in errors


def test_a_study_whose_drawn_plants_are_interrupted_is_whole_but_for_them(
    command, tmp_path, monkeypatch
):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("clepsydra.studies.robustness.of_study._met", interrupted)
    process, study = tmp_path / "it.toml", 'process = "three-tanks"\n[controllers.it]\n'
    process.write_text(f'{study}design = "simc"\n', "utf-8")
    status, text, errors = command("study", str(process), "--output", str(tmp_path))
    assert status == 0 and "worst of" not in text
    assert "whole but for the drawn plants" in errors
    assert (tmp_path / "it.html").stat().st_size > 10_000
