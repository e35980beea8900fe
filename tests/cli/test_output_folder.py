"""Where results go: a folder that is made where it is missing, and never a file in its place."""

from pathlib import Path

import pytest

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
