"""Where results go: a folder that is made where it is missing, and never a file in its place."""

import json
from pathlib import Path

import pytest

import clepsydra as cl

ONE_TANK = str(Path(__file__).parents[1] / "one-tank.toml")
PI = ("quadruple-tank", "--controller", "PI, SIMC")
WRITTEN = {
    "simulate": (("simulate", ONE_TANK, "-o", "a/b"), "simulation.html"),
    "draw": (("draw", "quadruple-tank", "-o", "a/b/c.svg"), "c.svg"),
    "export": (("export", *PI, "--to", "tuning", "-o", "a/b"), "_tuning.md"),
}


@pytest.mark.thorough
@pytest.mark.parametrize("case", WRITTEN)
def test_a_missing_folder_is_made(command, tmp_path, case):
    arguments, ending = WRITTEN[case]
    status, _, errors = command(*arguments)
    assert (status, errors) == (0, "")
    assert any(path.name.endswith(ending) for path in (tmp_path / "a" / "b").iterdir())


@pytest.mark.parametrize(
    "arguments",
    [("study", "quadruple-tank"), ("export", *PI, "--to", "c"), ("verify", "quadruple-tank")],
    ids=lambda arguments: arguments[0],
)
def test_a_folder_that_takes_no_file_is_named_before_any_work(command, arguments):
    status, output, errors = command(*arguments, "-o", "/proc")
    assert (status, output) == (2, "")
    assert errors.startswith("clepsydra: --output: got '/proc', expected a folder in which files")
    assert "tuning.json" not in errors


@pytest.mark.parametrize(
    "arguments",
    [
        ("simulate", ONE_TANK, "--duration", "1 min"),
        ("identify", "record.csv"),
        pytest.param(("study", "s.toml"), marks=pytest.mark.thorough),
        pytest.param(("verify", "s.toml", "--to", "c"), marks=pytest.mark.thorough),
    ],
    ids=lambda arguments: arguments[0],
)
def test_with_json_a_file_is_written_only_where_one_is_asked_for(command, tmp_path, arguments):
    plant = cl.load(ONE_TANK)
    steps = [cl.step("pump_1", "0.2 V", at="1 min"), cl.step("pump_1", "-0.3 V", at="5 min")]
    cl.simulate(plant, None, steps, duration="10 min").save(tmp_path / "record.csv")
    (tmp_path / "s.toml").write_text(
        f'process = "{ONE_TANK}"\n[controllers.pi]\ndesign = "simc"\n', "utf-8"
    )
    before = sorted(tmp_path.iterdir())
    status, output, errors = command(*arguments, "--json")
    assert (status, errors) == (0, "") and sorted(tmp_path.iterdir()) == before
    status, told, _ = command(*arguments, "--json", "-o", "there")
    written = {f"there/{path.name}" for path in (tmp_path / "there").iterdir()}
    paths = [value for value in json.loads(told).values() if str(value).startswith("there/")]
    assert status == 0 and written >= set(paths) and bool(paths) == (arguments[0] != "verify")
    assert output.count("\n") == told.count("\n") - len(paths)


@pytest.mark.parametrize(
    "arguments",
    [
        ("study", "quadruple-tank"),
        ("simulate", "quadruple-tank"),
        ("export", *PI, "--to", "c"),
        ("verify", "quadruple-tank"),
        ("papers",),
        ("identify", "record.csv"),
    ],
    ids=lambda arguments: arguments[0],
)
@pytest.mark.parametrize("folder", ["file", "file/folder"])
def test_a_file_in_its_place_is_refused_before_any_work(command, tmp_path, arguments, folder):
    (tmp_path / "file").write_text("in the way")
    status, output, errors = command(*arguments, "-o", folder)
    assert (status, output) == (2, "")
    assert errors.startswith(f"clepsydra: --output: got '{folder}', expected a folder")
    assert (tmp_path / "file").read_text() == "in the way"
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
