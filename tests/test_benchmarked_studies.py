"""What is measured of studies beside an earlier commit is what its table says."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks import __main__ as benchmarks
from benchmarks.measure import Spread
from benchmarks.studies import page, trees
from benchmarks.studies.installation import InstallationTimes
from benchmarks.studies.processes import (
    ROW_ON_TERMINAL,
    ProcessFailed,
    succeeded,
    until_first_row,
)
from benchmarks.studies.row import AFTER, BEFORE, Row, Wanted
from benchmarks.studies.times import PLANTS
from benchmarks.studies.trees import NoSuchCommit, Tree

ROOT = Path(__file__).resolve().parents[1]


def tree(folder: Path, study: str = "true", test: str = "true", commit: str = "abc") -> Tree:
    """Return a tree whose README has these commands behind the installation."""
    folder.mkdir(parents=True)
    lines = ["<!-- two lines -->", f"python3 -c '' && {study}", f"python3 -c '' && {test}"]
    (folder / "README.md").write_text("\n".join([*lines, "<!-- end -->"]), encoding="utf-8")
    return Tree(folder, commit)


def test_a_study_is_called_as_the_readme_of_its_tree_calls_it(tmp_path: Path) -> None:
    own = tree(tmp_path / "own", ".venv/bin/clepsydra study quadruple-tank --seed 3")
    assert own.study("a plant.toml")[3:] == ["study", "a plant.toml", "--seed", "3"]
    here = Tree(ROOT, "here")
    assert here.study("plant.toml")[3:5] == ["study", "plant.toml"]
    assert here.readme_lines()[1].endswith("-m pytest")
    assert all((ROOT / path).is_file() for path in PLANTS.values())


def test_a_process_sees_the_files_of_its_tree_and_its_home_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("CLEPSYDRA_CACHE", "XDG_CACHE_HOME", "PYTHONDONTWRITEBYTECODE", "MPLCONFIGDIR"):
        monkeypatch.setenv(name, "/elsewhere")
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Haswell")
    variables = Tree(tmp_path, "abc").environment(tmp_path / "home")
    assert "/elsewhere" not in variables.values()
    assert variables["PYTHONPATH"] == f"{tmp_path / 'src'}{os.pathsep}{tmp_path}"
    assert (variables["HOME"], variables["OPENBLAS_CORETYPE"]) == (
        str(tmp_path / "home"),
        "Haswell",
    )


def test_an_earlier_commit_has_its_own_files_and_the_present_tree_what_stands_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    repository = tmp_path / "repository"
    repository.mkdir()

    def git(*arguments: str) -> None:
        person = ["-c", "user.name=nobody", "-c", "user.email=nobody@localhost"]
        subprocess.run(["git", "-C", str(repository), *person, *arguments], check=True)

    git("init", "--quiet")
    (repository / ".gitignore").write_text("built\n", encoding="utf-8")
    (repository / "law.py").write_text("old", encoding="utf-8")
    git("add", "--all")
    git("commit", "--quiet", "--message", "first")
    for name, text in (("law.py", "new"), ("added.py", "added"), ("built", "")):
        (repository / name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(trees, "ROOT", repository)
    before = trees.earlier("HEAD", tmp_path / "before")
    after = trees.present(tmp_path / "after")
    assert {p.name: p.read_text() for p in before.folder.glob("*.py")} == {"law.py": "old"}
    assert {p.name: p.read_text() for p in after.folder.glob("*.py")} == {
        "law.py": "new",
        "added.py": "added",
    }
    assert not (after.folder / "built").exists()
    assert after.commit == f"{before.commit} with changes"
    with pytest.raises(NoSuchCommit, match="nowhere"):
        trees.short_name("nowhere")


def test_bar_and_heading_are_no_row() -> None:
    shown = b"\x1b[?25l 0/30\r\x1b[2KPI, SIMC 1/30\r\x1b[2K   controller    settles\r\n"
    assert not ROW_ON_TERMINAL.search(shown)
    assert ROW_ON_TERMINAL.search(shown + b"1  PI, SIMC     22.0 s")
    assert ROW_ON_TERMINAL.search(shown + b" 1  2DOF polynomial, LQ")


ROW_AND_MORE = """
import signal
print("   controller\\n1  PI, SIMC   22.0 s", flush=True)
signal.pause()
"""


@pytest.mark.parametrize("terminal", [True, False])
def test_a_study_is_ended_when_its_first_row_is_there(terminal: bool, tmp_path: Path) -> None:
    command = [sys.executable, "-c", ROW_AND_MORE]
    found = until_first_row(command, dict(os.environ), tmp_path, terminal=terminal)
    assert found > 0.0


@pytest.mark.parametrize("terminal", [True, False])
def test_a_study_without_a_row_is_told(terminal: bool, tmp_path: Path) -> None:
    command = [sys.executable, "-c", "print('nothing', end='')"]
    with pytest.raises(ProcessFailed, match="nothing"):
        until_first_row(command, dict(os.environ), tmp_path, terminal=terminal)


def test_what_a_failed_command_said_is_told(tmp_path: Path) -> None:
    with pytest.raises(ProcessFailed, match="no such plant"):
        succeeded(["bash", "-c", "echo no such plant; exit 2"], dict(os.environ), tmp_path)


def test_a_row_judges_the_ratio_or_what_is_after() -> None:
    sides = {BEFORE: [10.0, 30.0, 20.0], AFTER: [5.0, 9.0, 4.0]}
    assert Row.of("x", sides, None).ratio == Spread(0.3, 0.2, 0.5)
    verdicts = [
        Row.of("x", sides, wanted).verdict()
        for wanted in (
            Wanted(0.3, ratio=True),
            Wanted(0.29, ratio=True),
            Wanted(5.0),
            Wanted(5.1, least=True),
            None,
        )
    ]
    assert verdicts == ["yes", "**no**", "yes", "**no**", "–"]


def test_without_an_earlier_commit_its_columns_are_empty_and_the_page_says_so() -> None:
    rows = [
        Row.of("study [s]", {AFTER: [3.0, 4.0]}, Wanted(0.4, ratio=True), digits=1),
        Row.of("modules", {AFTER: [140.0]}, Wanted(150), digits=0),
    ]
    text = page.render(rows, [("Processor", "one")], Tree(ROOT, "abc"), None, "rounds: 2")
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()]
    assert ["study [s]", "", "3.5 (3.0 to 4.0)", "", "ratio at most 0.4", "–"] in cells
    assert ["modules", "", "140", "", "after at most 150", "yes"] in cells
    assert "No earlier commit was measured" in text


def test_the_page_names_both_commits_and_what_has_to_be_said() -> None:
    sides = (Tree(ROOT, "abc"), Tree(ROOT, "012"))
    text = page.render([], [], *sides, "rounds: 2", ["It could not be installed"])
    assert "After is commit abc, before is commit 012." in text
    assert text.endswith("It could not be installed")


def test_the_section_has_its_place(tmp_path: Path) -> None:
    copy = tmp_path / "benchmarks.md"
    copy.write_bytes(page.PAGE.read_bytes())
    page.write_page("new", copy)
    begin, end = page.MARKS
    assert f"{begin}\nnew\n{end}" in copy.read_text(encoding="utf-8")


INSTALL = "mkdir .venv && head -c 1000000 /dev/urandom > .venv/size"


def test_installations_are_measured_in_copies_and_a_failed_one_is_told(tmp_path: Path) -> None:
    after = tree(tmp_path / "after", f"{INSTALL} && true", "echo 1 failed, 3 passed && exit 1")
    before = tree(tmp_path / "before", "echo no package sympy && exit 5 && true", commit="012")
    told: list[str] = []
    times = InstallationTimes(after, before, tmp_path / "copies", told.append)
    installation, _, size, clock, _ = times.rows(2)
    assert installation.before is None and installation.verdict() == "–"
    assert size.after is not None and size.verdict() == "yes"
    assert 0.001 <= size.after.low <= 0.0011  # a megabyte and its folder
    assert clock.before is not None and clock.after is not None
    assert [note.rpartition(", ")[2] for note in times.notes[:1]] == ["failed: no package sympy"]
    assert times.notes[-1].endswith("1 failed, 3 passed")
    assert sum("012" in line for line in told) == 2  # not again where it has failed
    assert [p.name for p in after.folder.iterdir()] == ["README.md"]
    assert not [*(tmp_path / "copies").iterdir()]


@pytest.mark.parametrize("arguments", [["--since", "HEAD~1"], ["--installation"]])
def test_what_is_about_studies_goes_with_them(arguments: list[str]) -> None:
    for section in ([], ["--only", "studies"]):
        assert benchmarks.options([*section, *arguments]).quick is False
    for section in ("engine", "exported"):
        with pytest.raises(SystemExit):
            benchmarks.options(["--only", section, *arguments])


def test_one_section_is_measured_and_written_alone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    done: list[str] = []

    def section(name: str) -> benchmarks.Section:
        def measure(order: benchmarks.Order) -> benchmarks.Document:
            done.append(f"{order.facts[0][1]} measured")
            return benchmarks.Document(f"tables of {name}", lambda: done.append("written"))

        return benchmarks.Section(lambda: [("section", name)], measure)

    monkeypatch.setattr(benchmarks, "SECTIONS", {n: section(n) for n in ("engine", "studies")})
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--only", "studies", "--write"])
    assert benchmarks.main() == 0
    assert done == ["studies measured", "written"]
    assert capsys.readouterr().out == "tables of studies\n"
    monkeypatch.setattr(sys, "argv", ["benchmarks"])
    assert benchmarks.main() == 0
    assert done[2:] == ["engine measured", "studies measured"]
