"""Long work shows what it has found so far, on a terminal and nowhere else."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

STUDY = """
process = "plant.toml"
[controllers."PI, SIMC"]
design = "simc"
[controllers."PI, AMIGO"]
design = "amigo"
"""
COMMAND = "from clepsydra.cli import main; main()"
PATHS = os.pathsep.join(str(Path(path).resolve()) for path in sys.path if path)


def run(folder, errors, *arguments):
    """Run the command with this for its standard error, and return what it printed."""
    shutil.copy(Path(__file__).parents[1] / "one-tank.toml", folder / "plant.toml")
    (folder / "two.toml").write_text(STUDY)
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, *arguments],
        cwd=folder, stdout=subprocess.PIPE, stderr=errors, text=True, timeout=600,
        env={**os.environ, "PYTHONPATH": PATHS, "TERM": "xterm", "COLUMNS": "100"},
    )  # fmt: skip
    assert done.returncode == 0
    return done


@pytest.mark.skipif(os.name != "posix", reason="terminals of POSIX")
def test_the_first_row_stands_above_the_bar_while_the_second_is_made(tmp_path):
    ours, theirs = os.openpty()
    output = run(tmp_path, theirs, "study", "two.toml").stdout
    os.close(theirs)
    shown = os.read(ours, 1_000_000).decode()
    os.close(ours)
    row, bar = shown.index("1  PI, SIMC"), shown.rindex("PI, AMIGO ")
    assert "1/2" in shown[row:] and row < bar
    assert len(output.splitlines()) <= 25 and "1/2" not in output


@pytest.mark.parametrize("option", [[], ["--json"]])
def test_nothing_of_it_is_said_elsewhere(tmp_path, option):
    assert run(tmp_path, subprocess.PIPE, "study", "two.toml", *option).stderr == ""
