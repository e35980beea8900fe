"""``clepsydra verify``: its table, its files, its exit status."""

import contextlib
import io
import json
import os
import sys
from pathlib import Path

import pytest
from tools import need_compiler

from clepsydra.cli import main

STUDY = 'process = "{}"\n[controllers.slow]\ndesign = "simc"\n'.format(
    Path(__file__).parents[1] / "one-tank.toml"
)


#: A compiler that takes differences for the sums of a law.
ERRING = """#!{python}
import pathlib, subprocess, sys, tempfile
arguments = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:
    for place, name in enumerate(arguments):
        path = pathlib.Path(name)
        if path.suffix == ".c":
            spoilt = pathlib.Path(folder, path.name)
            spoilt.write_text(path.read_text().replace(" + ", " - "))
            arguments[place] = str(spoilt)
            arguments.append(f"-I{{path.parent}}")
    sys.exit(subprocess.run(["{compiler}", *arguments]).returncode)
"""


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    """The folder of a proof, what was printed, and the exit status."""
    folder = tmp_path_factory.mktemp("proof")
    (folder / "one.toml").write_text(STUDY, "utf-8")
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.chdir(folder):
        try:
            main(["verify", "one.toml"])
            status = 0
        except SystemExit as ending:
            status = ending.code
    return folder, printed.getvalue(), status


@pytest.mark.thorough
def test_a_controller_and_its_process_are_proved(proved):
    folder, out, status = proved
    assert status in (0, None) and out.startswith("The proof holds")
    assert all(len(line) <= 80 for line in out.splitlines())
    (row,) = (line for line in out.splitlines() if line.startswith("slow "))
    assert " ".join(row.split()).startswith("slow equal in every bit ")
    document = json.loads((folder / "one-proof.json").read_text("utf-8"))
    targets = {row["target"] for row in document["rows"] if row["subject"] == "slow"}
    assert {"C", "FMU 3.0", "FMU 2.0"} <= targets
    assert any(target.startswith("Structured Text") for target in targets)
    assert {row["verdict"] for row in document["rows"]} <= {"equal", "reported"}
    assert "slow" in (folder / "one-proof.md").read_text("utf-8")


@pytest.mark.thorough
def test_all_adds_the_table_its_notes_and_the_versions(command, proved):
    Path("one.toml").write_text(STUDY, "utf-8")
    for ending in ("json", "md"):
        name = f"one-proof.{ending}"
        Path(name).write_text((proved[0] / name).read_text("utf-8"), "utf-8")
    status, out, _ = command("verify", "one.toml", "--all")
    assert status in (0, None) and all(len(line) <= 100 for line in out.splitlines())
    brief, following = proved[1].split("\nEvery target: --all\n\nNext: ")
    assert out.startswith(brief) and out.endswith(following)
    rows = [line.split()[:4] for line in out.splitlines()]
    assert all(["Structured", "Text,", name, "double"] in rows for name in ("matiec", "scl"))
    assert "; Clepsydra 0." in out and " with CasADi 3." in out and "slow: single precision" in out


@pytest.mark.thorough
def test_c_that_differs_ends_in_status_1(command, proved, tmp_path, monkeypatch):
    """What was proved stays so; the C is proved again, with a compiler that errs."""
    document = json.loads((proved[0] / "one-proof.json").read_text("utf-8"))
    kept = [row for row in document["rows"] if row["target"] != "C"]
    Path("one-proof.json").write_text(json.dumps({**document, "rows": kept}), "utf-8")
    Path("one.toml").write_text(STUDY, "utf-8")
    for name in ("gcc", "clang", "cc"):
        (tmp_path / name).write_text(ERRING.format(python=sys.executable, compiler=need_compiler()))
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    status, out, _ = command("verify", "one.toml", "--json", "-o", ".")
    document = json.loads(out)
    assert status == 1 and not document["holds"]
    differing = {row["target"] for row in document["rows"] if row["verdict"] == "differs"}
    assert "C" in differing and not any(target.startswith("FMU") for target in differing)


def test_too_few_scans_are_refused_before_any_work(command):
    status, out, error = command("verify", "quadruple-tank", "--scans", "100")
    assert status == 2 and out == "" and "10000" in error


def test_a_controller_that_does_not_apply_is_refused_and_nothing_is_proved(command, tmp_path):
    status, out, error = command("verify", "quadruple-tank", "--controller", "Start/stop levels")
    assert status == 2 and out == "" and "does not" in error
    assert not list(tmp_path.iterdir())
