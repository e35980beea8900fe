"""Long work shows what it has found so far: in place on a terminal, elsewhere line by line."""

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


def run(folder, errors, *arguments, command=COMMAND, terminal="xterm"):
    """Run the command with this for its standard error, and return what it printed."""
    shutil.copy(Path(__file__).parents[1] / "one-tank.toml", folder / "plant.toml")
    (folder / "two.toml").write_text(STUDY)
    done = subprocess.run(
        [sys.executable, "-c", command, *arguments],
        cwd=folder, stdout=subprocess.PIPE, stderr=errors, text=True, timeout=600,
        env={**os.environ, "PYTHONPATH": PATHS, "TERM": terminal, "COLUMNS": "100"},
    )  # fmt: skip
    assert done.returncode == 0
    return done


def on_terminal(folder, *arguments, **how):
    """Return what goes to a terminal for errors, and to a file for output."""
    ours, theirs = os.openpty()
    output = run(folder, theirs, *arguments, **how).stdout
    os.close(theirs)
    shown = os.read(ours, 1_000_000).decode()
    os.close(ours)
    return shown, output


@pytest.mark.skipif(os.name != "posix", reason="terminals of POSIX")
def test_the_first_row_stands_above_the_bar_while_the_second_is_made(tmp_path):
    shown, output = on_terminal(tmp_path, "study", "two.toml")
    row, bar = shown.index("1  PI, SIMC"), shown.rindex("PI, AMIGO ")
    assert "1/2" in shown[row:] and row < bar
    assert len(output.splitlines()) <= 25 and "1/2" not in output


@pytest.mark.skipif(os.name != "posix", reason="terminals of POSIX")
def test_a_terminal_that_cannot_go_back_gets_lines(tmp_path):
    shown, _ = on_terminal(tmp_path, "study", "two.toml", terminal="dumb")
    assert shown.startswith("PI, SIMC: robust; settles ") and "1/2" not in shown


def test_elsewhere_each_row_is_a_line_beside_the_answer(tmp_path):
    done = run(tmp_path, subprocess.PIPE, "study", "two.toml")
    (row,) = done.stderr.splitlines()
    assert row.startswith("PI, SIMC: robust; settles ") and "max|S| " in row
    assert row not in done.stdout


def test_beside_one_document_nothing_is_said(tmp_path):
    assert run(tmp_path, subprocess.PIPE, "study", "two.toml", "--json").stderr == ""


#: A design that says when it begins, in the place where rows are printed.
LATE = """
import sys
from clepsydra import NotApplicable
from clepsydra.designs.design import design
@design("late", "what comes last")
def design_late(model):
    print("the last design begins", file=sys.stderr, flush=True)
    raise NotApplicable("it only tells when it begins")
"""


def test_the_first_row_is_printed_before_the_last_design_begins(tmp_path):
    (tmp_path / "late.toml").write_text(f'{STUDY}[controllers."Late"]\ndesign = "late"\n')
    done = run(tmp_path, subprocess.PIPE, "study", "late.toml", command=LATE + COMMAND)
    first, second, begins = done.stderr.splitlines()
    assert first.startswith("PI, SIMC: ") and second.startswith("PI, AMIGO: ")
    assert begins == "the last design begins"
