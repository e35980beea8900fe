"""``clepsydra simulate``: what it prints and writes, and what it refuses."""

import json
import re
from pathlib import Path

import numpy as np
import pandas
import pytest
from scipy.io import savemat

import clepsydra as cl


@pytest.fixture
def simulated(command):
    """Return a function: arguments of the verb → (exit status, standard output, errors)."""
    return lambda *arguments: command("simulate", *arguments)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_step_is_told_and_written(simulated, tmp_path):
    status, output, _ = simulated("quadruple-tank", "--input", "pump_1=3.5V@60s")
    assert status == 0
    assert all(len(line) <= 100 for line in output.splitlines())
    words = " ".join(output.split())
    assert "Starts at rest and runs for 12 min with pump_1 to 3.5 V at 60 s; no events." in words
    assert "Step halving estimates the largest error" in words and "balance of liquid" in words
    assert names(tmp_path) == [
        "quadruple-tank-simulation.html",
        "quadruple-tank-simulation.parquet",
    ]
    page = (tmp_path / "quadruple-tank-simulation.html").read_text("utf-8")
    assert page.rstrip().endswith("</html>") and "pump_1 to 3.5 V at 60 s" in page
    table = pandas.read_parquet(tmp_path / "quadruple-tank-simulation.parquet")
    assert (table["pump_1"][59], table["pump_1"][60], len(table)) == (3.0, 3.5, 721)


@pytest.mark.parametrize("name", ["quadruple-tank", "wet-well", "eight-tanks"])
def test_it_answers_in_a_screen(at_widths, name):
    told = at_widths("simulate", name, "--start", "empty", "--duration", "30 min")
    for columns in (80, 100):
        lines = told[columns].splitlines()
        assert len(lines) <= 25 and max(map(len, lines[:-2])) <= columns
        rows = [line.split()[0] for line in lines if ".level " in line]
        assert rows[0] in cl.load(name).process.levels and len(rows) <= 7


def test_json_is_what_the_function_returns(simulated, tmp_path):
    status, output, _ = simulated(
        "quadruple-tank", "--json", "--input", "pump_1=3.5V@60s",
        "--input", "pump_1=4V@1.5min..2min",
        "--duration", "5 min", "--state", "tank_1.level=5cm", "--format", "csv", "-o", "here",
    )  # fmt: skip
    assert status == 0
    found = json.loads(output)
    steps = [
        cl.step("pump_1", to="3.5 V", at="60 s"),
        cl.ramp("pump_1", to="4 V", at="90 s", over="30 s"),
    ]
    run = cl.simulate(
        cl.load("quadruple-tank"), None, steps, duration="300 s", state={"tank_1.level": "5 cm"}
    )
    assert found["signals"]["tank_1.level"]["start"] == 0.05
    for signal in run.signals:
        entry = found["signals"][signal.name]
        assert entry["end"] == run.values[signal.name][-1] and entry["unit"] == signal.unit
        assert entry["largest"]["value"] == run.values[signal.name].max()
    assert found["error_estimate"] == run.error_estimate
    assert found["changes"][1] == {
        "signal": "pump_1", "value": 4.0, "unit": "V", "start": 90.0, "stop": 120.0,
    }  # fmt: skip
    written = names(tmp_path / "here")
    assert written == ["quadruple-tank-simulation.csv", "quadruple-tank-simulation.html"]
    assert found["trajectories"] == "here/quadruple-tank-simulation.csv"


@pytest.mark.thorough
def test_without_input_it_gives_one_that_can_be_pasted(simulated):
    status, output, _ = simulated("quadruple-tank")
    assert status == 0
    words = " ".join(output.split())
    assert "runs for 10 min without any change" in words and "look at the trends" not in words
    (option,) = re.findall("--input '(.*?)'", words)
    assert option == "pump_1=4 V@10 s"  # it rests at 3 V of 0 to 10 V
    status, output, _ = simulated("quadruple-tank", "--input", option)
    assert status == 0 and "with pump_1 to 4 V at 10 s" in " ".join(output.split())


@pytest.mark.thorough
def test_a_file_gives_the_same_as_words(simulated, tmp_path):
    (tmp_path / "steps.csv").write_text("time [min];pump_1 [V]\n0;3\n1;3.5\n2;3.2\n")
    of_file = simulated("quadruple-tank", "--json", "--profile", "steps.csv", "--duration", "5 min")
    of_words = simulated(
        "quadruple-tank", "--json", "--duration", "300 s",
        "--input", "pump_1=3V", "--input", "pump_1=3.5V@60s", "--input", "pump_1=3.2V@120s",
    )  # fmt: skip
    assert of_file[0] == of_words[0] == 0
    assert json.loads(of_file[1])["signals"] == json.loads(of_words[1])["signals"]


@pytest.mark.thorough
def test_events_are_listed_with_their_times(simulated):
    status, output, _ = simulated(
        "laboratory-four-tanks", "--input", "pump_1=90%@5s", "--duration", "1 min", "--json"
    )
    assert status == 0
    events = json.loads(output)["events"]
    assert events and all(5.0 < event["time"] <= 60.0 for event in events)
    assert events == sorted(events, key=lambda event: event["time"])
    output = simulated("laboratory-four-tanks", "--input", "pump_1=90%@5s", "--duration", "1 min")[
        1
    ]
    assert events[0]["words"] in " ".join(output.split())


def test_a_drum_that_never_settles_is_told_how_long_to_run(simulated):
    drum = str(Path(__file__).parents[2] / "docs" / "examples" / "surge-drum.toml")
    status, _, errors = simulated(drum)
    said = " ".join(errors.split())
    assert status == 2 and "drum.level goes on rising or falling" in said
    (proposed,) = re.findall("as in --duration '(.*?)'", said)
    status, output, _ = simulated(drum, "--duration", proposed, "--json")
    assert status == 0 and json.loads(output)["duration"] == 6000.0  # 600 samples of 10 s


BAD = {
    "signal": (["--input", "pmup_1=3V"], "perhaps 'pump_1' was meant"),
    "no value": (["--input", "pump_1"], "a signal, '=' and its value"),
    "range": (["--input", "pump_1=30V"], "--input pump_1=30V: got '30 V'"),
    "late": (["--input", "pump_1=4V@10min", "--duration", "5 min"], "within the duration of 5 min"),
    "order": (["--input", "pump_1=4V@9s", "--input", "pump_1=3V@5s"], "a time from 9 s on"),
    "duration": (["--duration", "long"], "duration: got 'long'"),
    "state": (["--state", "tank_1=5cm"], "--state: got 'tank_1', expected a state of"),
    "state without value": (["--state", "tank_1.level"], "a state, '=' and its value"),
    "twice": (["--state", "tank_1.level=5cm", "--state", "tank_1.level=6cm"], "each state once"),
    "state out of range": (["--state", "tank_1.level=25cm"], "from 0 to 20 cm, the range of"),
    "no file": (["--profile", "none.csv"], "none.csv: got no such file"),
    "a device": (["--profile", "/dev/zero"], "/dev/zero: got no regular file"),
    "bad file": (["--profile", "bad.csv"], "bad.csv, line 2, column 'pump_1': got 'x'"),
    "both": (["--profile", "good.csv", "--input", "pump_1=3V"], "that good.csv does not give"),
    "long file": (["--profile", "good.csv", "--duration", "5 s"], "good.csv, line 3, column"),
    "folder": (["-o", "bad.csv"], "--output: got 'bad.csv', expected a folder"),
    "start": (["--start", "full"], "'full'"),
    "solver": (["--solver", "euler"], "'euler'"),
    "format": (["--format", "xls"], "'xls'"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_mistakes_are_messages_and_leave_nothing(simulated, tmp_path, case):
    (tmp_path / "bad.csv").write_text("time [s],pump_1 [V]\n0,x\n")
    (tmp_path / "good.csv").write_text("time [s],pump_1 [V]\n0,3\n10,3.5\n")
    arguments, words = BAD[case]
    status, output, errors = simulated("quadruple-tank", *arguments)
    assert (status, output) == (2, "")
    assert words in " ".join(errors.split()) and "Traceback" not in errors
    assert names(tmp_path) == ["bad.csv", "good.csv"]


def test_a_controller_fills_empty_tanks(simulated, tmp_path):
    status, output, _ = simulated(
        "quadruple-tank", "--controller", "PI, SIMC", "--start", "empty",
        "--controller-start", "cold", "--input", "level_1=60%",
        "--input", "level_2=6.5V@0s..2min", "--state", "pump_1=0V",
    )  # fmt: skip
    words = " ".join(output.split())
    assert status == 0 and "Begins empty, but for pump_1; the controller starts cold" in words
    assert "pump_1 goes from 0 V to 10 V at once" in words
    assert "level_1 to 6 V at 0 s; level_2 to 6.5 V at 0 s over 120 s." in words
    assert names(tmp_path) == ["quadruple-tank-simulation.parquet"]
    table = pandas.read_parquet(tmp_path / "quadruple-tank-simulation.parquet")
    assert table["tank_1.level"][0] == 0.0 and table["level_1.setpoint"][0] == 6.0
    assert table["level_1"].iloc[-1] == pytest.approx(6.0, abs=1e-3)


def test_json_of_a_closed_loop_is_what_the_function_returns(simulated):
    options = ("--controller", "PI, SIMC", "--start", "empty", "--duration", "1 min", "--json")
    status, output, _ = simulated("quadruple-tank", *options)
    plant = cl.load("quadruple-tank")
    run = cl.simulate(plant, cl.design.simc(plant), start="empty", duration="1 min")
    found = json.loads(output)
    assert status == 0 and found["start"] == "empty"
    assert found["signals"]["tank_1.level"]["end"] == run.values["tank_1.level"][-1]
    assert found["final_state"] == dict(run.final_state)


BAD_STARTS = {
    "start": (["--start", "emtpy"], "--start: got 'emtpy', expected one of rest, empty; perhaps"),
    "state": (["--state", "tank_1.levle=5cm"], "--state: got 'tank_1.levle'"),
    "nearest": (["--state", "tank_1.levle=5cm"], "perhaps 'tank_1.level' was meant"),
    "way": (["--controller-start", "clod"], "--controller-start: got 'clod'"),
}


@pytest.mark.parametrize("controlled", [True, False])
@pytest.mark.parametrize("case", BAD_STARTS)
def test_a_wrong_start_is_refused_with_and_without_a_controller(simulated, case, controlled):
    arguments, words = BAD_STARTS[case]
    chosen = ["--controller", "PI, SIMC"] if controlled else []
    status, output, errors = simulated("quadruple-tank", *chosen, *arguments)
    assert (status, output) == (2, "") and words in " ".join(errors.split())


def test_a_controller_moves_the_inputs_itself(simulated, tmp_path):
    (tmp_path / "good.csv").write_text("time [s],pump_1 [V]\n0,3\n10,3.5\n")
    for arguments in (("--input", "pump_1=3V"), ("--profile", "good.csv")):
        status, _, errors = simulated("quadruple-tank", "--controller", "PI, SIMC", *arguments)
        assert status == 2 and "the controller moves" in " ".join(errors.split())


@pytest.fixture
def regulator(tmp_path):
    """PI control of both levels in %/%, K = 0.4 and 0.3, Ti = 30 s."""
    gains = np.diag([0.4, 0.3])
    matrices = {"A": np.zeros((2, 2)), "B": gains / 30.0, "C": np.eye(2), "D": gains}
    savemat(tmp_path / "my.mat", matrices)
    return tmp_path / "my.mat"


TO_60 = ("--start", "empty", "--input", "level_1=60%", "--input", "level_2=60%")


def test_a_file_of_matrices_fills_the_tanks_as_a_simulation_program_runs_it(
    simulated, regulator, tmp_path
):
    """By hand: u = 0.4 e + 0.4/30 s · Σ of the errors by the trapezoidal rule, and no more."""
    status, output, _ = simulated(
        "laboratory-four-tanks", "--controller", "my.mat", *TO_60, "--controller-start", "cold",
        "--input", "pour_1=97cm^3/s@10min+1s", "--duration", "15 min", "--format", "csv",
    )  # fmt: skip
    words = " ".join(output.split())
    assert status == 0 and "my on laboratory-four-tanks, 15 min" in words
    assert "pump_1 goes from 44 % to 24.02 % at once, pump_2 goes from 24 % to 18.02 %" in words
    rows = {line.split()[0]: line for line in output.splitlines() if line.split()}
    for score in ("rise_time", "overshoot", "settling_time", "return_time"):
        assert len(re.findall(r"\d (?:s|min|%)(?= |$)", rows[score])) == 2
    table = pandas.read_csv(next(tmp_path.glob("*.csv")))
    level = table[next(name for name in table if name.startswith("level_1 "))]
    pump = table[next(name for name in table if name.startswith("pump_1 "))]
    error = 60.0 - level.to_numpy()[:4000]
    summed = 0.05 * (np.cumsum(error) - 0.5 * error)
    asked = 0.4 * error + 0.4 / 30.0 * summed
    assert np.all((asked > 0.0) & (asked < 100.0))
    assert pump.to_numpy()[:4000] == pytest.approx(asked, abs=1e-5)


def test_a_file_of_matrices_takes_over_without_a_bump(simulated, regulator):
    status, output, _ = simulated("laboratory-four-tanks", "--controller", "my.mat", *TO_60)
    assert status == 0 and "pump_1 begins at 44 %, pump_2 begins at 24 %" in " ".join(
        output.split()
    )


def test_a_command_is_what_python_makes_of_it(simulated, regulator):
    status, output, _ = simulated(
        "laboratory-four-tanks", "--controller", str(regulator), *TO_60, "--json",
        "--controller-start", "cold", "--noise", "--seed", "9", "--duration", "2 min",
    )  # fmt: skip
    plant = cl.load("laboratory-four-tanks")
    given = cl.design.regulator(plant, regulator, anti_windup="none")
    run = cl.simulate(
        plant,
        given.with_values({"pump_1.bias": 0.0, "pump_2.bias": 0.0}),
        [cl.step(name, to="60 %", at=0) for name in ("level_1", "level_2")],
        duration="2 min",
        start="empty",
        controller_start="cold",
        noise=True,
        seed=9,
    )
    found = json.loads(output)
    finite = {name: value for name, value in found["scores"].items() if value is not None}
    assert status == 0 and finite
    assert finite == {name: value for name, value in run.scores.items() if np.isfinite(value)}
    assert (found["controller"], found["seed"]) == ("my", 9)


def test_a_controller_of_a_study_file_may_be_called_like_a_file(simulated, regulator, tmp_path):
    (tmp_path / "own.toml").write_text(
        'process = "laboratory-four-tanks"\n[controllers."my.mat"]\nregulator = "my.mat"\n'
    )
    status, output, _ = simulated("own.toml", "--controller", "my.mat", *TO_60)
    assert status == 0 and "my.mat on laboratory-four-tanks" in output


def test_a_verb_that_takes_no_file_says_where_it_stands(command, regulator):
    for verb in ("verify", "draw"):
        status, output, errors = command(verb, "laboratory-four-tanks", "--controller", "my.mat")
        words = " ".join(errors.split())
        assert (status, output) == (2, "") and "got 'my.mat'" in words
        assert 'write a study file with [controllers.mine] and regulator = "my.mat"' in words


BAD_REGULATORS = {
    "none": (["--controller", "none.mat"], "none.mat: got no such file"),
    "damaged": (["--controller", "bad.mat"], "bad.mat: got"),
    "shape": (["--controller", "three.mat"], "expected 3 names, one for each of its inputs"),
    "noise": (["--controller", "my.mat", "--noise"], "--noise: got True, expected no noise beside"),
    "alone": (["--noise"], "--noise: got True, expected a controller that meets it"),
    "pulse": (
        ["--controller", "my.mat", "--input", "pour_1=97cm^3/s@5s+0s"],
        "lasts: got '0s', expected a time above 0 s",
    ),
    "too much": (
        ["--controller", "my.mat", "--input", "pour_1=25%@5s+1min..2min"],
        "expected one time, or two with '..' or '+' between them",
    ),
}


@pytest.mark.parametrize("case", BAD_REGULATORS)
def test_a_regulator_that_cannot_be_run_is_refused(simulated, regulator, tmp_path, case):
    (tmp_path / "bad.mat").write_bytes(regulator.read_bytes()[:150])
    three = {"A": -np.eye(1), "B": np.ones((1, 3)), "C": np.ones((2, 1)), "D": np.zeros((2, 3))}
    savemat(tmp_path / "three.mat", three)
    arguments, words = BAD_REGULATORS[case]
    before = names(tmp_path)
    status, output, errors = simulated("laboratory-four-tanks", *arguments)
    assert (status, output) == (2, "") and words in " ".join(errors.split())
    assert "Traceback" not in errors and names(tmp_path) == before
