"""What the verbs print on terminals of 80 and 100 columns: nothing wider, and no word broken."""

import os

import pytest

import clepsydra as cl
from clepsydra.cli.output import show

PI = ("--controller", "PI, SIMC")
SCREENS = {
    "simulate": ("simulate", "laboratory-four-tanks", "--input", "pump_1=90%@5s"),
    "simulate --all": ("simulate", "wet-well", "--start", "empty", "--duration", "20 min", "--all"),
    "identify": ("identify", "run.csv", "--manipulated", "pump_1", "--measured", "level_1"),
    "identify --process": (
        "identify", "run.csv", "--process", "quadruple-tank", "--parameters", "outlet_1.area",
    ),
    "analyse": ("analyse", "laboratory-four-tanks"),
    "analyse --all": ("analyse", "eight-tanks", "--all"),
    "robustness": ("robustness", "three-tanks", *PI, "--draws", "80"),
    "verify": ("verify", "three-tanks", *PI, "--to", "c"),
    "export a process": ("export", "quadruple-tank", "--to", "fmu"),
    **{
        f"export --to {target}": ("export", "quadruple-tank", *PI, "--to", *target.split())
        for target in ("c", "st", "st --dialect matiec", "st --dialect scl", "tuning", "signals",
                       "fmu")
    },
}  # fmt: skip
#: Rows that a screen has at most, but where all is asked for.
_ROWS = 27


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """Return the path of the record that the screens identify from."""
    moves = [cl.step("pump_1", "+0.5 V", at="20 s"), cl.step("pump_1", "-0.6 V", at="3 min")]
    path = tmp_path_factory.mktemp("record") / "run.csv"
    cl.simulate(cl.load("quadruple-tank"), None, moves, duration="6 min").save(path)
    return path


@pytest.mark.parametrize("case", SCREENS)
def test_nothing_is_wider_and_no_word_is_broken(at_widths, tmp_path, record, case):
    (tmp_path / record.name).write_bytes(record.read_bytes())
    told = at_widths(*SCREENS[case])
    for columns in (80, 100):
        lines = told[columns].splitlines()
        assert max(map(len, lines)) <= columns
        assert set(told[columns].split()) <= set(told[1000].split())
        assert "--all" in case or len(lines) <= _ROWS


@pytest.mark.parametrize("target", ["c", "st", "st --dialect scl", "tuning", "signals", "fmu"])
def test_an_export_says_what_it_is_what_was_written_and_what_to_do(command, tmp_path, target):
    status, out, _ = command("export", "quadruple-tank", *PI, "--to", *target.split())
    lines, files = out.splitlines(), sorted(path.name for path in tmp_path.iterdir())
    assert status == 0 and lines[0].startswith("PI, SIMC on ")
    assert sorted(line[9:].rstrip() for line in lines if line.startswith("Written: ")) == files
    (following,) = (place for place, line in enumerate(lines) if line.startswith("Next: "))
    assert following <= 8 and "docs/" not in out  # an installation has no docs


def test_a_path_stays_whole_though_the_terminal_is_narrower(command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "30")
    status, out, _ = command("export", "quadruple-tank", *PI, "--to", "c")
    assert status == 0
    assert "Written: quadruple_tank_pi_simc.c" in [line.rstrip() for line in out.splitlines()]


@pytest.mark.parametrize(("terminal", "columns"), [(True, 60), (False, 100)])
def test_on_a_terminal_it_is_as_wide_as_that_and_in_a_file_100_columns(
    capsys, monkeypatch, terminal, columns
):
    monkeypatch.delenv("COLUMNS", raising=False)
    monkeypatch.setattr("rich.console.Console.is_terminal", terminal)
    monkeypatch.setattr(os, "get_terminal_size", lambda *_: os.terminal_size((60, 24)))
    show("word " * 100)
    assert max(len(line.rstrip()) for line in capsys.readouterr().out.splitlines()) == columns - 1
