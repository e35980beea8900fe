"""What is proved is what is exported: the same program and the same files."""

import json

import pytest
from deployed import files_of
from refusals import refused
from spoilt_programs import FMUS, items_of, quickly
from tools import need_compiler, need_grammar, need_importer

import clepsydra as cl
from clepsydra.cli.application import application
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.deploy.compiler import find_compiler
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.targets import runs_of

SETTINGS = PlantShell(
    fail_safe={"pump_1": 2.0},
    sensor_delay={"level_1": 7.0},
    setpoint_rate={"level_2": 0.1},
    rate_limit={"pump_2": 0.5},
)


@pytest.fixture(scope="module")
def study():
    return cl.study("quadruple-tank", only="PI, SIMC")


@pytest.mark.parametrize("settings", [None, pytest.param(SETTINGS, marks=pytest.mark.thorough)])
def test_the_files_of_an_export_are_those_that_are_proved(settings, study, tmp_path):
    need_compiler()
    need_grammar()
    need_importer()
    chosen = next(c.controller for c in study.ranking if c.controller.name == "PI, SIMC")
    ready = exportable(chosen, study.analysis.operating_point, settings)
    item = next(item for item in items_of(study, settings) if item.name == "PI, SIMC")
    assert digest(item.program) == digest(ready.program)
    compiler = find_compiler("tests")
    job = Job(item, 100, 1, tmp_path, compiler)
    printed = {
        (run.name, run.precision): run.printed(job)
        for run in runs_of("controller", compiler, ("c", "st"))
    }
    name = ready.program.name
    for precision in ("double", "single"):
        files = files_of(ready, "c", precision=precision)
        assert files.items() <= printed["C", precision].items()
    for dialect, ending in (("matiec", "st"), ("codesys", "st"), ("scl", "scl")):
        files = files_of(ready, "st", dialect=dialect)
        text = printed[f"Structured Text, {dialect}", "double"]["text"]
        # With the mark that TIA Portal wants at the start of a file.
        assert files[f"{name}.{ending}"].decode("utf-8-sig") == text.decode()


def test_another_setting_is_another_program(study):
    digests = {
        digest(items_of(study, settings)[0].program)
        for settings in (None, SETTINGS, PlantShell(fail_safe={"pump_1": 2.0}))
    }
    assert len(digests) == 3


def test_a_setting_that_does_not_fit_is_said_of_the_controller(study):
    """The command refuses it as the export does; a proof of several names the controllers."""
    outside = PlantShell(fail_safe={"pump_1": 99.0})
    item = items_of(study, outside)[0]
    assert item.program is None and "fail_safe" in item.refusal
    chosen = study.ranking[0].controller
    with refused(place="fail_safe"):
        exportable(chosen, study.analysis.operating_point, outside)


@pytest.mark.thorough
def test_the_commands_prove_what_they_export_with_the_same_options(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.toml").write_text(
        'process = "equalisation-tank"\n[controllers.slow]\ndesign = "arrest_time"\n', "utf-8"
    )

    quickly(monkeypatch, without=(*FMUS, *(f"{name} exchange" for name in FMUS)))

    def said(*arguments: str) -> dict:
        with pytest.raises(SystemExit) as ended:
            application()(args=[*arguments, "--controller", "slow", "--json"])
        assert not ended.value.code
        return json.loads(capsys.readouterr().out)

    options = ("--fail-safe", "outflow=20 %", "--sensor-delay", "level=120 s")
    digests = [
        said("export", "one.toml", "--to", "c", *chosen)["digest"] for chosen in ((), options)
    ]
    proof = said("verify", "one.toml", *options)
    programs = {row["program"] for row in proof["rows"] if row["subject"] == "slow"}
    assert programs == {digests[1]} and digests[0] != digests[1] and proof["holds"]
