"""The command: what it prints where, its exit status, and what it leaves on disk."""

import json
import math
import os
import shutil
import subprocess
import sys
from importlib import resources
from pathlib import Path

import pandas
import pytest

from clepsydra.cli.output import print_json
from clepsydra.studies.designs import DESIGNS

NAMES = ["quadruple-tank", "quadruple-tank-nonminimum-phase"]
ONE_TANK = Path(__file__).parents[1] / "one-tank.toml"
TWO = """
process = "plant.toml"
[controllers."PI, SIMC"]
design = "simc"
[controllers."by hand".loops.level]
measurement = "level_1"
output = "pump_1"
actions = "PI"
action = "reverse"
gain = "2 V/cm"
integral_time = "1 min"
"""


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def one_document(text: str):
    """Parse a text that is one JSON document and nothing else, without NaN and Infinity."""

    def refuse(constant: str) -> None:
        raise ValueError(f"{constant} is not JSON")

    return json.loads(text, parse_constant=refuse)


def process(code: str, *arguments: str, folder: Path, **environment: str):
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=folder,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(str(Path(path).resolve()) for path in sys.path if path),
            **environment,
        },
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=600,
    )


COMMAND = "from clepsydra.cli import main; main()"
#: What takes long to load, for tables, pictures and models of other libraries.
UNUSED = {"jinja2", "matplotlib", "pandas", "pyarrow", "rich", "xarray", "control"}


@pytest.fixture
def two(tmp_path):
    """Write a study of two controllers into the folder where the command runs."""
    shutil.copy(ONE_TANK, tmp_path / "plant.toml")
    (tmp_path / "two.toml").write_text(TWO)
    return tmp_path


def check_study(output, folder, stem):
    """Check the one document of a study, its report and its data; return the document."""
    document = one_document(output)
    ranking = document["ranking"]
    assert [entry["rank"] for entry in ranking] == list(range(1, len(ranking) + 1))
    assert names(folder) == [f"{stem}.html", f"{stem}.parquet"]
    assert Path(document["report"]).samefile(folder / f"{stem}.html")
    assert Path(document["trajectories"]).samefile(folder / f"{stem}.parquet")
    table = pandas.read_parquet(folder / f"{stem}.parquet")
    assert set(table["controller"]) == {entry["controller"] for entry in ranking}
    assert len(table) == len(ranking) * document["scenario"]["samples"]
    page = (folder / f"{stem}.html").read_text(encoding="utf-8")
    assert page.rstrip().endswith("</html>")
    assert all(entry["controller"] in page for entry in ranking)
    return document


def check_table(result, folder, stem, controllers):
    """Check that a study showed a table which fits a terminal, and said what it wrote."""
    status, output, errors = result
    assert status == 0 and "Traceback" not in errors
    lines = output.splitlines()
    table = [line for line in lines if not line.startswith("Written:")]
    assert all(len(line) <= 100 for line in table)
    assert len({output.index(text) for text in controllers}) == len(controllers)
    assert str(folder / f"{stem}.html") in output.replace("\n", "")
    assert names(folder) == [f"{stem}.html", f"{stem}.parquet"]


def test_study_prints_one_document_and_writes_report_and_data(command, two):
    status, output, _ = command("study", "two.toml", "--json", "--output", "out")
    assert status == 0
    document = check_study(output, two / "out", "two")
    assert {entry["controller"] for entry in document["ranking"]} == {"PI, SIMC", "by hand"}


def test_a_study_for_programs_loads_no_library_that_it_does_without(two):
    code = "import sys\nfrom clepsydra.cli import main\ntry: main()\n"
    code += "finally: sys.stderr.write(' '.join(sys.modules))"
    done = process(code, "study", "two.toml", "--json", folder=two)
    assert done.returncode == 0 and not UNUSED & set(done.stderr.split())
    assert names(two) == ["plant.toml", "two.toml"]


def test_study_shows_a_ranked_table_that_fits_a_terminal(command, two):
    out = two / "out"
    check_table(command("study", "two.toml", "-o", str(out)), out, "two", ("PI, SIMC", "by hand"))


def test_of_a_long_study_the_recommended_run_is_written_and_all_on_request(
    command, two, monkeypatch
):
    monkeypatch.setattr("clepsydra.cli.study.LARGEST", 1)
    status, output, _ = command("study", "two.toml")
    assert status == 0
    assert output.endswith("\nTrajectories of 1 of 2 controllers; all of them: --every-run\n")
    names_of = lambda: set(pandas.read_parquet(two / "two.parquet")["controller"])  # noqa: E731
    (kept,) = names_of()
    assert f"Use {kept} on" in " ".join(output.split())
    assert "Trajectories of" not in command("study", "two.toml", "--every-run")[1]
    assert len(names_of()) == 2


@pytest.mark.thorough
def test_without_a_folder_the_current_one_is_used_and_the_seed_is_an_option(command, two):
    document = one_document(command("study", "two.toml", "--json", "--seed", "5")[1])
    assert document["scenario"]["seed"] == 5 and not {"report", "trajectories"} & set(document)
    assert command("study", "two.toml", "--seed", "5")[0] == 0
    assert names(two) == ["plant.toml", "two.html", "two.parquet", "two.toml"]


@pytest.mark.thorough
def test_a_study_of_a_process_tries_every_design(command, tmp_path):
    out = tmp_path / "out"
    status, output, _ = command("study", str(ONE_TANK), "--json", "--output", str(out))
    assert status == 0
    document = check_study(output, out, "one-tank")
    tried = [entry["controller"] for entry in document["ranking"] + document["not_applicable"]]
    assert len(set(tried)) == len(tried) == len(DESIGNS) + 2  # two are tuned


@pytest.mark.thorough
def test_the_table_of_every_design_fits_a_terminal(command, tmp_path):
    out = tmp_path / "out"
    controllers = ("PI, SIMC", "PI, phase margin", "LQI, Bryson")
    check_table(
        command("study", str(ONE_TANK), "--all", "-o", str(out)), out, "one-tank", controllers
    )


def test_numbers_that_json_has_no_form_for_become_null(capsys):
    values = {"a": [1.5, math.inf, (-math.inf, {"b": math.nan})], 3: None, "text": "ÅÖ ∞"}
    print_json(values)
    expected = {"a": [1.5, None, [None, {"b": None}]], "3": None, "text": "ÅÖ ∞"}
    assert one_document(capsys.readouterr().out) == expected


#: Johansson's table I: gamma, k [cm³/(s V)], v [V].
PHASES = {
    NAMES[0]: ((0.70, 0.60), (3.33, 3.35), (3.00, 3.00)),
    NAMES[1]: ((0.43, 0.34), (3.14, 3.29), (3.15, 3.15)),
}


@pytest.mark.parametrize("name", [NAMES[0], pytest.param(NAMES[1], marks=pytest.mark.thorough)])
def test_analyse_prints_johanssons_closed_forms(command, tmp_path, name):
    status, output, _ = command("analyse", name, "--json")
    assert status == 0
    document = one_document(output)
    (g1, g2), (k1, k2), (v1, v2) = PHASES[name]
    areas, holes = (28.0, 32.0, 28.0, 32.0), (0.071, 0.057, 0.071, 0.057)
    flows = (
        g1 * k1 * v1 + (1 - g2) * k2 * v2,
        g2 * k2 * v2 + (1 - g1) * k1 * v1,
        (1 - g2) * k2 * v2,
        (1 - g1) * k1 * v1,
    )
    levels = [(q / a) ** 2 / (2 * 981.0) for q, a in zip(flows, holes, strict=True)]
    times = [A / a * math.sqrt(2 * h / 981.0) for A, a, h in zip(areas, holes, levels, strict=True)]
    poles = sorted(pole["re"] for pole in document["poles"])
    assert poles == pytest.approx(sorted(-1 / time for time in times), rel=1e-9)
    assert all(pole["im"] == 0 for pole in document["poles"])
    zeros = sorted(zero["re"] for zero in document["zeros"])
    _, _, t3, t4 = times
    total, product = -(t3 + t4) / (t3 * t4), (1 - (1 - g1) * (1 - g2) / (g1 * g2)) / (t3 * t4)
    assert sum(zeros) == pytest.approx(total, rel=1e-9)
    assert zeros[0] * zeros[1] == pytest.approx(product, rel=1e-9)
    gain = g1 * g2 / (g1 + g2 - 1)
    assert document["rga"][0] == pytest.approx([gain, 1 - gain], rel=1e-9)
    assert document["rga"][1] == pytest.approx([1 - gain, gain], rel=1e-9)
    point = json.dumps(document["operating_point"])
    assert "tank_1.level" in point and "pump_1" in point
    found = numbers(document["operating_point"])
    for level in levels:
        assert any(abs(value - level / 100) < 1e-11 for value in found)
    assert names(tmp_path) == []


def numbers(value) -> list[float]:
    if isinstance(value, dict):
        return [number for entry in value.values() for number in numbers(entry)]
    if isinstance(value, list):
        return [number for entry in value for number in numbers(entry)]
    return [value] if isinstance(value, float) else []


@pytest.mark.parametrize("name", NAMES)
def test_analyse_shows_the_same_to_a_reader(command, name):
    status, output, _ = command("analyse", name, "--all")
    assert status == 0
    assert all(len(line) <= 100 for line in output.splitlines())
    for words in ("pump_1", "level_1", "tank_1"):
        assert words in output


CATALOGUE = resources.files("clepsydra.process") / "catalogue" / "quadruple-tank.toml"


def edited(*changes: tuple[str, str]) -> bytes:
    text = CATALOGUE.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text.encode()


BAD_FILES = {
    "empty": b"",
    "cut off": edited()[:1700],
    "binary": bytes(range(256)) * 10,
    "negative area": edited(('area = "28 cm^2"', 'area = "-28 cm^2"')),
    "not a number": edited(('area = "28 cm^2"', 'area = "nan cm^2"')),
    "unknown unit": edited(('area = "28 cm^2"', 'area = "28 smoots"')),
    "unit of another kind": edited(('area = "28 cm^2"', 'area = "28 V"')),
    "unknown key": edited(('height = "20 cm"', 'heigth = "20 cm"')),
    "flow to nowhere": edited(('destination = "basin"', 'destination = "moon"')),
    "no sampling": edited(('sampling_period = "1 s"', 'sampling_period = "0 s"')),
    "no equilibrium": edited(('nominal = "3.00 V"', 'nominal = "9.99 V"')),
    "name of a path": edited(('name = "quadruple-tank"', 'name = "../outside"')),
    "name of a folder": edited(('name = "quadruple-tank"', 'name = "a/b"')),
}


@pytest.mark.parametrize("verb", ["analyse", pytest.param("study", marks=pytest.mark.thorough)])
@pytest.mark.parametrize("case", BAD_FILES)
def test_a_bad_file_is_one_message_and_leaves_nothing(command, tmp_path, verb, case):
    path, folder = tmp_path / "bad.toml", tmp_path / "out"
    path.write_bytes(BAD_FILES[case])
    folder.mkdir()
    arguments = ["--output", str(folder)] if verb == "study" else []
    for json_option in ([], ["--json"]):
        status, output, errors = command(verb, str(path), *json_option, *arguments)
        assert (status, output) == (2, ""), json_option
        assert errors.startswith("clepsydra: "), json_option
        assert errors.count("\n") == 1, json_option
        assert "Traceback" not in errors, json_option
        if case != "no equilibrium":
            assert "bad.toml" in errors, json_option
        assert names(folder) == [] and names(tmp_path) == ["bad.toml", "out"], json_option


def test_a_process_without_a_rest_says_which_level_is_too_high(command, tmp_path):
    (tmp_path / "bad.toml").write_bytes(BAD_FILES["no equilibrium"])
    assert "tank_" in command("study", "bad.toml")[2]


@pytest.mark.parametrize("verb", ["study", "analyse"])
@pytest.mark.parametrize("name", ["quadruple-tonk", "missing.toml", ".", ""])
def test_an_unknown_process_is_a_message(command, tmp_path, verb, name):
    status, output, errors = command(verb, name)
    assert (status, output) == (2, "")
    assert "Traceback" not in errors and errors.startswith("clepsydra: ")
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    "arguments",
    [
        ["stduy", "quadruple-tank"],
        ["study", "quadruple-tank", "--jsn"],
        ["study"],
        ["analyse"],
        ["analyse", "quadruple-tank", "extra"],
        ["study", "quadruple-tank", "--seed", "-1"],
        ["study", "quadruple-tank", "--seed", "one"],
        ["study", "quadruple-tank", "--output"],
        ["--jsn"],
    ],
)
def test_wrong_usage_ends_with_status_2(command, tmp_path, arguments):
    status, output, errors = command(*arguments)
    assert (status, output) == (2, "")
    assert errors.strip() and "Traceback" not in errors
    assert names(tmp_path) == []


@pytest.mark.parametrize("ending", ["html", "parquet"])
def test_an_output_that_cannot_be_written_is_a_message(command, tmp_path, ending):
    (tmp_path / f"quadruple-tank.{ending}").mkdir()
    status, _, errors = command("study", NAMES[0], "--json", "--output", ".")
    assert status == 2
    assert f"quadruple-tank.{ending}" in errors and "Traceback" not in errors
    assert all(not name.endswith(".part") for name in names(tmp_path))


def test_an_interrupted_study_ends_with_status_130(command, tmp_path):
    """Control-C comes while a law runs."""
    (tmp_path / "law.py").write_text(
        "inputs = ['level_1.sp', 'level_1.pv']\noutputs = ['pump_1.out']\n"
        "def step(state, inputs, parameters, time_step):\n"
        "    raise KeyboardInterrupt\n"
    )
    (tmp_path / "own.toml").write_text(
        f'process = "{ONE_TANK}"\n[controllers.mine]\nlaw = "law.py"\n'
        'setpoints = ["level_1"]\nmeasurements = ["level_1"]\nmanipulated = ["pump_1"]\n'
    )
    status, output, errors = command("study", "own.toml")
    assert (status, output) == (130, "")
    assert errors == "clepsydra: interrupted; nothing was left half-written\n"
    assert names(tmp_path) == ["law.py", "own.toml"]


@pytest.mark.thorough
def test_a_real_process_studies_a_file_of_ones_own(two):
    done = process(COMMAND, "study", "two.toml", "--json", folder=two)
    assert done.returncode == 0, done.stderr
    assert one_document(done.stdout)["process"] == "one-tank"
    assert names(two) == ["plant.toml", "two.toml"]
    done = process(COMMAND, "analyse", "plant.toml", "--json", folder=two)
    assert done.returncode == 0, done.stderr
    assert {"poles", "zeros", "rga", "operating_point"} <= one_document(done.stdout).keys()


@pytest.mark.thorough
def test_a_real_process_refuses_a_bad_file(tmp_path):
    (tmp_path / "bad.toml").write_bytes(BAD_FILES["negative area"])
    done = process(COMMAND, "study", "bad.toml", "--json", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("clepsydra: ")
    for part in ("bad.toml", "line", "tanks.tank_1.area", "-28 cm^2"):
        assert part in done.stderr
    assert "Traceback" not in done.stderr
    assert names(tmp_path) == ["bad.toml"]


def test_a_warning_of_a_library_is_said_once_and_in_words(tmp_path):
    code = (
        "import clepsydra.cli, warnings\n"
        "def told():\n"
        "    for _ in range(3):\n"
        "        warnings.warn('overflow encountered in multiply', RuntimeWarning)\n"
        "    warnings.warn('old', FutureWarning)\n"
        "clepsydra.cli._run = lambda arguments: told()\n"
        "clepsydra.cli.main()"
    )
    said = process(code, folder=tmp_path, PYTHONWARNINGS="")
    assert said.returncode == 0
    (line,) = said.stderr.splitlines()
    assert line.startswith("clepsydra: on the way a number could not be computed (overflow")
    as_it_is = process(code, folder=tmp_path, PYTHONWARNINGS="default")
    assert "RuntimeWarning: overflow encountered" in as_it_is.stderr
