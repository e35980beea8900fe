"""``clepsydra identify``: what it prints and writes, and what it refuses."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl

STEPS = [
    cl.step("pump_1", to=value, at=at)
    for value, at in (("3.5 V", "1 min"), ("2.6 V", "6 min"), ("3.2 V", "11 min"))
]
RUN = "run.csv"


@pytest.fixture
def identified(command):
    """Return a function: arguments of the verb → (exit status, standard output, errors)."""
    return lambda *arguments: command("identify", *arguments)


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    """Write once what clepsydra simulate --format csv writes."""
    path = tmp_path_factory.mktemp("simulated") / RUN
    cl.simulate(cl.load("quadruple-tank"), None, STEPS, duration="16 min").save(path)
    return path


@pytest.fixture
def run_csv(simulated, tmp_path):
    """Put a copy of it into the folder where the command runs."""
    return shutil.copy(simulated, tmp_path / RUN)


@pytest.fixture
def tank(tmp_path):
    """Write a record with two columns and noise; it begins within the fixture's folder."""
    u = 3.0 + np.repeat([0.0, 0.5, -0.5, 0.3, -0.3, 0.4], 40)
    y, level = np.empty(len(u)), 12.0
    for k in range(len(u)):
        y[k] = level
        level += 0.04 * (4.0 * u[max(k - 3, 0)] - level)
    y += np.random.default_rng(1).normal(0.0, 0.05, len(u))
    lines = [f"{2 * k},{a:.3f},{b:.4f}" for k, (a, b) in enumerate(zip(u, y, strict=True))]
    path = tmp_path / "tank.csv"
    path.write_text("time [s],pump [V],level [cm]\n" + "\n".join(lines) + "\n")
    return path


def test_two_columns_need_no_option(identified, tank):
    """A lag of 50 s: 1 − 0.04 a sample of 2 s; a gain of 4 cm/V; three samples late."""
    status, output, _ = identified("tank.csv")
    assert status == 0
    assert all(len(line) <= 100 for line in output.splitlines())
    words = " ".join(output.split())
    assert (
        "Use FOPDT: static gain 4" in words
        and "SIMC on FOPDT: reverse-acting PI with a gain of" in words
    )
    page = (tank.parent / "tank-identification.html").read_text("utf-8")
    assert page.rstrip().endswith("</html>") and "Use FOPDT" in page
    best = cl.identify(tank).best
    truth = [0.04, -2.0 / np.log(0.96), 6.0]
    for estimate, value in zip(best.estimates, truth, strict=True):
        assert abs(estimate.value - value) < estimate.high - estimate.low


def test_json_is_what_the_function_returns(identified, tank):
    status, output, _ = identified("tank.csv", "--json", "-o", "here")
    assert status == 0
    found = json.loads(output)
    expected = json.loads(json.dumps(cl.identify("tank.csv").as_dict()))
    assert found.pop("page") == "here/tank-identification.html"
    assert {k: v for k, v in found.items() if k != "models"} == {
        k: v for k, v in expected.items() if k != "models"
    }
    assert [m["estimates"][0] for m in found["models"]] == [
        m["estimates"][0] for m in expected["models"]
    ]


@pytest.mark.thorough
def test_a_simulation_is_read_back_and_the_fitted_file_used(command, identified, run_csv, tmp_path):
    """From simulate by identify to a process file that has what was simulated."""
    wrong = tmp_path / "wrong.toml"
    assert command("new", "wrong", "--from", "quadruple-tank")[0] == 0
    wrong.write_text(wrong.read_text().replace('"0.071 cm^2"', '"0.080 cm^2"', 1))
    status, output, _ = identified(
        RUN, "--process", "wrong.toml", "--parameters", "outlet_1.area, pump_1.gain",
        "--write", "fitted.toml",
    )  # fmt: skip
    assert status == 0
    assert "explains 100.0 %" in " ".join(output.split())
    found = cl.load(tmp_path / "fitted.toml").process
    assert found.signal("outlet_1.area").initial == pytest.approx(7.1e-6, rel=1e-5)
    assert found.signal("pump_1.gain").initial == pytest.approx(3.33e-6, rel=1e-5)
    assert cl.load(wrong).process.signal("outlet_1.area").initial == pytest.approx(8e-6)
    assert command("analyse", "fitted.toml", "--json")[0] == 0


def test_the_input_of_a_simulation_needs_no_name(identified, run_csv):
    status, output, _ = identified(RUN, "--measured", "level_2", "--json")
    found = json.loads(output)
    assert (status, found["manipulated"], found["measured"]) == (0, "pump_1", "level_2")


@pytest.mark.thorough
def test_what_simulate_writes_of_one_tank_needs_no_name_at_all(command, tmp_path):
    """From a process file by the command line alone: state, sensor, pump and a still inflow."""
    shutil.copy(Path(__file__).parents[1] / "one-tank.toml", tmp_path)
    steps = ["1.7 V @ 1 min", "1.4 V @ 5 min", "1.6 V @ 9 min", "1.5 V @ 12 min"]
    moves = [word for step in steps for word in ("--input", f"pump_1={step}")]
    assert command("simulate", "one-tank.toml", *moves, "--duration", "15 min",
                   "--format", "csv")[0] == 0  # fmt: skip
    status, output, errors = command("identify", "one-tank-simulation.csv", "--json")
    assert (status, errors) == (0, "")
    found = json.loads(output)
    assert (found["manipulated"], found["measured"]) == ("pump_1", "level_1")


LABORATORY = {
    "filling from empty": (["--start", "empty"], {}, "outlet_1.area", 0.071),
    "draining": (["--input", "pump_1=0V"], {}, "outlet_1.area", 0.071),
    "at rest": ([], {}, "outlet_1.area", 0.071),
    "plugged": (["--start", "empty"], {'"0.071 cm^2"': '"0 cm^2"'}, "pump_1.gain", 3.33),
}


@pytest.mark.thorough
@pytest.mark.parametrize("case", LABORATORY)
def test_records_of_a_laboratory_at_constant_input(case, command, tmp_path):
    """By the command line alone: simulate, spoil the number in the file, and find it again."""
    arguments, edits, name, truth = LABORATORY[case]
    text = (Path(__file__).parents[1] / "one-tank.toml").read_text("utf-8")
    for old, new in edits.items():
        text = text.replace(old, new)
    plant = tmp_path / "tank.toml"
    plant.write_text(text, "utf-8")
    status, _, errors = command(
        "simulate", "tank.toml", *arguments, "--duration", "100 s", "--format", "csv"
    )
    assert (status, errors) == (0, "")
    plant.write_text(text.replace(f'"{truth} cm', f'"{0.8 * truth} cm'), "utf-8")
    fit = ["--process", "tank.toml", "--parameters", name, "--json"]
    status, output, errors = command("identify", "one-tank-simulation.csv", *fit)
    assert (status, errors) == (0, "")
    (found,) = json.loads(output)["parameters"]
    per_shown = 1e-4 if name == "outlet_1.area" else 1e-6
    assert found["value"] == pytest.approx(truth * per_shown, rel=1e-4)
    assert found["low"] <= found["value"] <= found["high"] < 1.01 * found["low"]


@pytest.mark.thorough
def test_one_column_of_a_simulation(identified, run_csv):
    status, output, _ = identified(
        RUN, "--manipulated", "pump_1", "--measured", "level_1", "--json"
    )
    found = json.loads(output)
    assert status == 0 and found["use"] in ("FOPDT", "SOPDT")
    assert (found["manipulated"], found["measured"]) == ("pump_1", "level_1")


BAD = {
    "many columns": (
        [RUN],
        "run.csv: got '12 columns', expected to be told which of them is measured; name it, as in "
        "--manipulated pump_1 --measured level_1 (measured may be level_1, level_2, level_4).",
    ),
    "an unknown output": (
        [RUN, "--measured", "level_9"], "measured: got 'level_9', expected a column of run.csv",
    ),
    "no such column": (
        [RUN, "--manipulated", "pmup_1", "--measured", "level_1"], "perhaps 'pump_1' was meant",
    ),
    "parameters alone": (
        [RUN, "--parameters", "outlet_1.area"], "--parameters: got 'outlet_1.area', expected a proc"
    ),
    "write alone": ([RUN, "--write", "a.toml"], "--write: got 'a.toml'"),
    "no parameters": ([RUN, "--process", "quadruple-tank"], "parameters: got none"),
    "no such parameter": (
        [RUN, "--process", "quadruple-tank", "--parameters", "outlet_1.hole"], "perhaps 'outlet_1",
    ),
    "a column of a process": (
        [RUN, "--process", "quadruple-tank", "--parameters", "pump_1.gain", "--measured", "x"],
        "no such option with --process",
    ),
    "no toml": (
        [RUN, "--process", "quadruple-tank", "--parameters", "pump_1.gain", "--write", "a.csv"],
        "a file that ends in .toml",
    ),
    "no file": (["nothing.csv"], "nothing.csv: got no such file"),
    "a device": (["/dev/zero"], "/dev/zero: got no regular file"),
    "a folder": (["."], ".: got a folder"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_message(case, identified, run_csv, tmp_path):
    before = sorted(path.name for path in tmp_path.iterdir())
    arguments, expected = BAD[case]
    status, output, errors = identified(*arguments)
    assert (status, output) == (2, "")
    assert errors.startswith("clepsydra: ") and errors.count("\n") == 1
    assert expected in errors
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_a_pipe_is_refused_at_once(identified, tmp_path):
    """Where it is opened to be read, the program waits for somebody to write."""
    os.mkfifo(tmp_path / "pipe.csv")
    status, _, errors = identified("pipe.csv")
    assert status == 2 and errors.startswith("clepsydra: pipe.csv: got no regular file")


def test_a_million_rows_are_refused_with_the_reason(identified, tmp_path):
    """They would be fitted for many minutes; that they are too many shows before they are read."""
    (tmp_path / "long.csv").write_bytes(b"time [s],u [V],y [m]\n" + 1_000_000 * b"0,3,1\n")
    status, _, errors = identified("long.csv")
    assert status == 2
    assert (
        "long.csv: got '1,000,000 rows', expected at most 100,000 rows; keep one row of 10"
        in errors
    )


def test_a_bad_cell_is_named(identified, tank):
    lines = tank.read_text().splitlines()
    lines[9] = "16,-,12.1"
    tank.write_text("\n".join(lines))
    status, _, errors = identified("tank.csv")
    assert status == 2
    assert "tank.csv, line 10, column 'pump': got '-', expected a number" in errors
