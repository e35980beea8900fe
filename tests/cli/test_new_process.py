"""A copy of a process of the catalogue, and an edit of it that takes effect."""

import json

import pytest

from clepsydra.process.reader import load_process


def test_an_edit_of_the_flat_file_takes_effect(command, tmp_path):
    status, _, errors = command("new", "mine", "--from", "laboratory-four-tanks:fitted,percent")
    assert (status, errors) == (0, "")
    path = tmp_path / "mine.toml"
    before = load_process(path)
    text = path.read_text(encoding="utf-8")
    assert text.count('"0.1333 cm^2"') == 1
    path.write_text(text.replace('"0.1333 cm^2"', '"0.15 cm^2"'), encoding="utf-8")
    areas = [
        parameter.initial
        for process in (before, load_process(path))
        for parameter in process.parameters
        if parameter.name == "outlet_1.area"
    ]
    assert areas == [0.1333e-4, 0.15e-4]


def test_a_variant_that_is_not_there_leaves_nothing(command, tmp_path):
    status, _, errors = command("new", "mine", "--from", "three-tanks:corected")
    assert status == 2 and "corrected" in errors
    assert list(tmp_path.iterdir()) == []


def test_a_file_needs_a_name(command, tmp_path):
    status, _, errors = command("new")
    assert status == 2 and errors.startswith("clepsydra: NAME: got no name")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.thorough
def test_an_edit_that_a_default_variant_overrides_is_reported(command, tmp_path):
    command("new", "mine", "--from", "laboratory-four-tanks")
    status, output, _ = command("analyse", "mine.toml", "--json")
    assert status == 0
    report, percent = json.loads(output)["warnings"][:2]
    assert "orifices.outlet_1.area (line 53)" in report and "[variants.report]" in report
    assert "pumps.pump_1.gain" in percent
    status, output, _ = command("analyse", "mine.toml:report,percent", "--json")
    assert json.loads(output)["warnings"] == []  # who asks for variants knows of them
    status, output, _ = command("analyse", "laboratory-four-tanks", "--json")
    assert json.loads(output)["warnings"] == []


@pytest.mark.thorough
def test_an_outlet_may_be_plugged(command, tmp_path):
    """Then its tank fills at the rate of the pump: 0.7 of 3.33 cm³/(s V), 3 V, 28 cm²."""
    command("new", "mine", "--from", "quadruple-tank")
    path = tmp_path / "mine.toml"
    text = path.read_text(encoding="utf-8")
    for area in ("0.071 cm^2", "0.057 cm^2"):
        text = text.replace(f'area = "{area}"', 'area = "0 cm^2"')
    path.write_text(text, encoding="utf-8")
    status, output, errors = command(
        "simulate", "mine.toml", "--start", "empty", "--duration", "20 s", "--json"
    )
    assert (status, errors) == (0, "")
    level = json.loads(output)["signals"]["tank_1.level"]["end"]
    assert level == pytest.approx(0.7 * 3.33 * 3.0 / 28.0 * 20.0 / 100.0, rel=1e-12)


def test_a_link_that_leads_nowhere_is_not_written_over(command, tmp_path):
    (tmp_path / "mine.toml").symlink_to("nowhere")
    status, output, errors = command("new", "mine")
    assert (status, output) == (2, "")
    assert errors.startswith("clepsydra: NAME: got 'mine', expected a name for which there is no")
