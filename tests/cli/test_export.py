"""``clepsydra export`` as its user types it: files that compile and run, and refusals in words."""

import json
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from tools import need_compiler

PAGE = Path(__file__).parents[2] / "docs" / "export.md"
PI = ("quadruple-tank", "--controller", "PI, SIMC")
NAME = "quadruple_tank_pi_simc"
CONE = """name = "cone"
sampling_period = "1 s"
controlled = ["level_1"]

[reservoirs.basin]

[tanks.tank_1]
shape = "cone"
rim_diameter = "20 cm"
height = "30 cm"

[orifices.outlet_1]
source = "tank_1"
destination = "basin"
area = "0.071 cm^2"

[pumps.pump_1]
source = "basin"
destination = "tank_1"
gain = "3.33 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "3 V"

[sensors.level_1]
tank = "tank_1"
range = ["0 cm", "30 cm"]
"""


def test_the_main_program_of_the_page_runs_the_exported_c(command, tmp_path):
    status, out, _ = command("export", *PI, "--to", "c")
    assert status == 0 and f"Written: {NAME}.c" in out
    text = re.search(r"<!-- main.c -->\n```c\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[1]
    Path("main.c").write_text(text, "utf-8")
    built = [need_compiler(), "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    subprocess.run([*built, "main.c", f"{NAME}.c", "-lm", "-o", "main"], check=True)
    printed = subprocess.run(["./main"], capture_output=True, text=True, check=True).stdout
    # K = 3, Ti = 1000 s / 31.2188 and 42.454 s, b = 1: the integral is such that the first scan,
    # of a controller that was at rest elsewhere, asks for K e + I; then it grows by K/Ti e.
    first, second, third = (
        [float(number) for number in line.split()] for line in printed.splitlines()
    )
    assert first == pytest.approx([3 * 0.5 + 3.0, 3 * 0.5 + 3.0], abs=1e-6)
    growth = [3 / 32.03203203203203 * 0.5, 3 / 42.454394693200655 * 0.5]
    assert [b - a for a, b in zip(first, second, strict=True)] == pytest.approx(growth, abs=2e-6)
    assert [b - a for a, b in zip(second, third, strict=True)] == pytest.approx(growth, abs=2e-6)


def test_several_targets_in_one_call(command, tmp_path):
    """An option goes to the targets that have it, and the files are those of single calls."""
    alone = []
    for number, to in enumerate((("st", "--dialect", "matiec"), ("signals",), ("tuning",))):
        status, out, _ = command("export", *PI, "--to", *to, "--json", "-o", f"alone_{number}")
        assert status == 0
        alone += [Path(name) for name in json.loads(out)["files"]]
    together = ("--to", "st", "--to", "signals", "--to", "tuning", "--dialect", "matiec")
    status, out, _ = command("export", *PI, *together, "--json", "-o", "together")
    found = [Path(name) for name in json.loads(out)["files"]]
    assert status == 0 and len(found) == 5
    assert [path.name for path in found] == [path.name for path in alone]
    pairs = zip(found, alone, strict=True)
    assert all(one.read_bytes() == other.read_bytes() for one, other in pairs)
    status, out, _ = command("export", *PI, *together, "-o", "together")
    assert status == 0 and out.count("Written: ") == 5 and out.count("Next: ") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--to", "st", "--to", "st"), "each target once"),
        (("--to", "st", "--to", "sd"), "got 'sd', expected one of c, st, fmu"),
        (("--to", "st", "--to", "c", "--fmi", "2.0"), "such an option with --to fmu only"),
        (("--to", "st", "--to", "tuning", "--rate-limit", "pump_1=1 V/s"), "plant shell only"),
    ],
)
def test_what_several_targets_cannot_have_is_refused(command, arguments, words):
    status, _, error = command("export", *PI, *arguments)
    assert status == 2 and words in " ".join(error.split())
    assert not list(Path().glob("*.st"))


def test_a_scheme_that_no_process_has_is_answered_with_names_and_where_it_is_written(command):
    scheme = ("wet-well:flow-meters", "--controller", "Cascade with feedforward")
    status, _, error = command("export", *scheme, "--to", "st")
    said = " ".join(error.split())
    assert status == 2 and "'PI, SIMC'" in said and "more of this study" in said
    assert "a study file that writes it out: give that file instead of the process" in said


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("dialect", "files"),
    [
        ("codesys", {f"{NAME}.st", f"{NAME}_test.st", f"{NAME}_test.xml"}),
        ("matiec", {f"{NAME}.st", f"{NAME}_test.st", f"{NAME}_test.xml"}),
        ("scl", {f"{NAME}.scl", f"{NAME}_test.scl"}),
    ],
)
def test_each_dialect_has_its_files_and_json_names_them(command, tmp_path, dialect, files):
    status, out, _ = command("export", *PI, "--to", "st", "--dialect", dialect, "--json")
    found = json.loads(out)
    assert status == 0 and set(found["files"]) == files
    assert {path.name for path in tmp_path.iterdir()} == files
    text = Path(next(iter(sorted(files)))).read_text("utf-8-sig")
    assert found["digest"] in text and "quadruple-tank of the catalogue" in text


def test_options_of_the_plant_are_printed_with_their_source(command):
    command(
        "export", *PI, "--to", "c", "--fail-safe", "pump_1=2 V", "--sensor-delay", "level_2=10 s",
        "--rate-limit", "pump_2=0.5 V/s", "--setpoint-rate", "level_1=6 V/min",
    )  # fmt: skip
    text = Path(f"{NAME}.c").read_text("utf-8")
    for name, value in (
        ("pump_1_fail_safe", 2.0), ("level_2_sensor_delay", 10.0), ("pump_2_rate_limit", 0.5),
        ("level_1_setpoint_rate", 0.1), ("pump_2_fail_safe", 0.0), ("level_1_sensor_delay", 4.0),
    ):  # fmt: skip
        found = re.search(rf"parameters->{name} = (\S+); /\* (.*) \*/", text)
        assert float(found[1]) == value
        assert ("default" in found[2]) == (name in ("pump_2_fail_safe", "level_1_sensor_delay"))


@pytest.mark.thorough
@pytest.mark.parametrize("version", ["3.0", "2.0"])
def test_a_process_and_a_controller_become_fmus(command, version):
    status, out, _ = command("export", *PI, "--to", "fmu", "--fmi", version)
    assert status == 0
    status, out, _ = command("export", "quadruple-tank", "--to", "fmu", "--fmi", version)
    assert status == 0 and "model exchange" in " ".join(out.split())
    for path in Path().glob("*.fmu"):
        described = zipfile.ZipFile(path).read("modelDescription.xml").decode()
        assert f'fmiVersion="{version}"' in described, path
    assert len(list(Path().glob("*.fmu"))) == 3


@pytest.mark.thorough
@pytest.mark.parametrize("columns", ["80", "100"])
def test_the_loops_stand_on_the_screen_and_the_blocks_in_the_file(command, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    status, out, _ = command("export", *PI, "--to", "tuning")
    assert status == 0 and "KP = 3 %/%" in Path(f"{NAME}_tuning.md").read_text("utf-8")
    lines = out.splitlines()
    assert len(lines) <= 25 and max(map(len, lines)) <= int(columns)
    assert out.count("Next: ") == 1 and "Siemens" in out
    said = " ".join(out.split())
    assert "level_2 (0 to 10 V) by pump_2 (0 to 10 V), reverse acting: K = 3 V/V" in said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("quadruple-tank", "--to", "st"), "--controller: got none, expected the name of one"),
        (("quadruple-tank", "--to", "st", "--controller", "PI SIMC"), "perhaps 'PI, SIMC' was"),
        (("quadruple-tank", "--to", "c", "--controller", "PI, arrest time"), "does not: "),
        (("quadruple-tank", "--to", "tuning", "--controller", "LQI, Bryson"), "PID"),
        ((*PI, "--to", "c", "--fail-safe", "pump_3=1 V"), "perhaps 'pump_"),
        ((*PI, "--to", "c", "--fail-safe", "pump_1"), "'=' and its value"),
        ((*PI, "--to", "c", "--fail-safe", "pump_1=1 m"), "pump_1 from 0 to 10 V"),
        ((*PI, "--to", "c", "--fail-safe", "pump_1=11 V"), "10"),
        ((*PI, "--to", "c", "--sensor-delay", "level_1=-1 s"), "-1"),
        (("no-such-tank", "--to", "fmu"), "no-such-tank"),
    ],
)
def test_mistakes_end_in_one_message_and_no_file(command, tmp_path, arguments, words):
    status, out, error = command("export", *arguments)
    assert status == 2 and out == "" and "Traceback" not in error
    assert words in " ".join(error.split())
    assert not list(tmp_path.iterdir())


def test_a_law_in_python_is_refused_with_the_reason(command, tmp_path):
    Path("law.py").write_text(
        "inputs = ['level_1.sp', 'level_1.pv']\noutputs = ['pump_1.out']\n"
        "def step(state, inputs, parameters, time_step):\n"
        "    return {}, {'pump_1.out': 3.0}\n",
        "utf-8",
    )
    Path("own.toml").write_text(
        'process = "quadruple-tank"\n[controllers.mine]\nlaw = "law.py"\n'
        'setpoints = ["level_1"]\nmeasurements = ["level_1"]\nmanipulated = ["pump_1"]\n'
        '[scenario]\nduration = "1 min"\nnoise = false\n'
        '[[scenario.setpoint]]\nsignal = "level_1"\nat = "10 s"\nby = "1 V"\n',
        "utf-8",
    )
    status, _, error = command("export", "own.toml", "--controller", "mine", "--to", "st")
    assert status == 2 and "Python" in error and "Traceback" not in error
    assert {path.name for path in tmp_path.iterdir()} == {"law.py", "own.toml"}


def test_without_a_compiler_no_fmu_is_written(command, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "/nonexistent")
    monkeypatch.setitem(sys.modules, "ziglang", None)
    status, _, error = command("export", *PI, "--to", "fmu")
    assert status == 2 and "ziglang" in error and "compiler" in error
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        (*PI, "--to", "fmu", "--precision", "single"),
        (*PI, "--to", "c", "--dialect", "scl"),
        (*PI, "--to", "st", "--fmi", "2.0"),
        (*PI, "--to", "tuning", "--fail-safe", "pump_1=1 V"),
        ("quadruple-tank", "--to", "fmu", "--rate-limit", "pump_1=1 V/s"),
    ],
)
def test_an_option_without_effect_is_refused(command, tmp_path, arguments):
    status, _, error = command("export", *arguments)
    assert status == 2 and "leave it out" in error and not list(tmp_path.iterdir())


@pytest.mark.thorough
def test_a_tank_that_real_cannot_hold_is_left_out_and_the_block_is_written(command, tmp_path):
    """The area of a cone's tip is bounded by a number far below those of REAL."""
    Path("cone.toml").write_text(CONE, "utf-8")
    status, out, _ = command(
        "export", "cone.toml", "--controller", "PI, SIMC", "--to", "st", "--precision", "single"
    )
    said = " ".join(out.split())
    assert status == 0 and "no test project" in said and "1e-60" in said
    assert {path.name for path in tmp_path.iterdir()} == {"cone.toml", "cone_pi_simc.st"}


@pytest.mark.thorough
def test_a_period_that_time_cannot_hold_is_refused(command, tmp_path):
    Path("cone.toml").write_text(CONE.replace('"1 s"', '"1000.5 ms"'), "utf-8")
    status, _, error = command("export", "cone.toml", "--controller", "PI, SIMC", "--to", "st")
    assert status == 2 and "a whole number of milliseconds" in error
    assert {path.name for path in tmp_path.iterdir()} == {"cone.toml"}


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["PI, Ziegler-Nichols", "PI, Ziegler-Nichols, slowed 1.98 times"])
def test_the_title_of_the_ranking_names_a_controller_too(command, name):
    status, shown, _ = command("export", "three-tanks", "--controller", name, "--to", "c", "--json")
    assert status == 0
    assert json.loads(shown)["controller"] == "PI, Ziegler-Nichols"
