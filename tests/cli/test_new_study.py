"""``clepsydra new --study``: a study file that works as it stands, for every process."""

import re
import tomllib

import numpy as np
import pytest
from json_schema import faults

from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.studies.file.reader import read_study, study_schema


def refused(result, *words):
    status, output, errors = result
    assert (status, output) == (2, "")
    assert errors.startswith("clepsydra: ") and "Traceback" not in errors
    for word in words:
        assert word in errors, (word, errors)


@pytest.mark.parametrize(
    "name",
    [
        "equalisation-tank",
        *(
            pytest.param(name, marks=pytest.mark.thorough)
            for name in [*catalogue_names(), "wet-well:flow-meters"]
            if name != "equalisation-tank"
        ),
    ],
)
def test_what_is_written_is_read_and_every_controller_made(command, tmp_path, name):
    status, output, errors = command("new", "--study", "mine", "--process", name)
    assert (status, errors) == (0, "")
    assert output == "Study file: mine.toml\nRun it with: clepsydra study mine.toml\n"
    study = read_study(tmp_path / "mine.toml")
    assert study.process.address == name or study.process.name == name
    model = linearise(study.analysis.operating_point)
    first, second, tuned, by_hand = (
        request.make(study.analysis, model) for request in study.controllers
    )
    assert [request.tune is not None for request in study.controllers] == [
        False,
        False,
        True,
        False,
    ]
    assert tuned.values == first.values and second.family
    # Written with four digits; an integral time too.
    for key in first.values:
        if key.endswith((".proportional_gain", ".integral_time")):
            assert by_hand.values[key] == pytest.approx(first.values[key], rel=6e-4)
    run = Loop(by_hand, model).run(study.scenario)
    at = study.analysis.operating_point.as_dict()
    for output in study.process.controlled:
        setpoint = run.values[f"{output}.setpoint"]
        last = slice(-study.scenario.samples // 50, None)
        step = max(abs(s.size) for s in study.scenario.segments if s.signal == output)
        error = np.mean(run.true_measurement(output)[last] - setpoint[last])
        assert run.true_measurement(output)[0] == pytest.approx(at[output], rel=1e-9)
        # An averaging level is on its way back for days.
        share = 1.0 if output in study.process.averaging else 0.2
        assert abs(error) < share * step, (output, error, step)


def test_its_steps_are_those_of_the_usual_scenario(command, tmp_path):
    command("new", "--study", "mine", "--process", "quadruple-tank")
    study = read_study(tmp_path / "mine.toml")
    usual = default_scenario(study.analysis.model)
    assert study.scenario.segments == usual.segments
    assert np.array_equal(study.scenario.noise, usual.noise)
    assert study.scenario.setpoints == pytest.approx(usual.setpoints, rel=1e-12)


def test_the_process_of_the_readme_is_studied_where_none_is_named(command, tmp_path):
    assert command("new", "--study", "mine.toml")[0] == 0
    assert read_study(tmp_path / "mine.toml").process.name == "quadruple-tank"


def test_a_process_file_of_ones_own(command, tmp_path):
    (tmp_path / "plant.toml").write_bytes(catalogue_file("three-tanks").read_bytes())
    assert command("new", "--study", "mine", "--process", "plant.toml")[0] == 0
    assert 'process = "plant.toml"' in (tmp_path / "mine.toml").read_text()
    assert read_study(tmp_path / "mine.toml").process.path == tmp_path / "plant.toml"


def test_what_is_commented_out_may_be_written(command, tmp_path):
    """Every line that begins with "# " and a key is one that the reader takes."""
    command("new", "--study", "mine", "--process", "equalisation-tank")
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    opened = re.sub(r"^# (\[ranking\]|[a-z_.]+ = )", r"\1", text, flags=re.MULTILINE)
    (tmp_path / "all.toml").write_text(opened, encoding="utf-8")
    tables = tomllib.loads(opened)
    assert list(faults(tables, study_schema())) == []
    assert set(tables) == set(study_schema()["properties"])
    assert len(opened.splitlines()) == len(text.splitlines())
    study = read_study(tmp_path / "all.toml")
    assert study.scores == ("iae", "total_variation")
    model = linearise(study.analysis.operating_point)
    for request in study.controllers:
        request.make(study.analysis, model)
    bounds = study.controllers[2].tune.bounds
    assert [(bound.owner, bound.key) for bound in bounds] == [
        ("level", "gain"),
        ("level", "integral_time"),
    ]


def test_help_says_that_studies_are_written(command):
    for arguments in (("--help",), ("new", "--help")):
        status, output, _ = command(*arguments)
        words = " ".join(output.replace("│", " ").split())
        assert status == 0, arguments
        assert "a commented process file, or with --study a study file" in words, arguments


def test_nothing_is_ever_written_over(command, tmp_path):
    (tmp_path / "mine.toml").write_text("mine")
    refused(command("new", "--study", "mine"), "NAME", "mine.toml")
    assert (tmp_path / "mine.toml").read_text() == "mine"


def test_options_that_do_not_fit_are_refused(command, tmp_path):
    refused(command("new", "mine", "--process", "three-tanks"), "--process", "add --study")
    refused(command("new", "mine", "--study", "--from", "three-tanks"), "--from", "--process")
    refused(command("new", "my study", "--study"), "NAME", "my study")
    refused(command("new", "mine", "--study", "--process", "three-tonks"), "three-tanks")
    assert not list(tmp_path.iterdir())


def test_every_key_of_a_tuning_is_shown_and_its_limits_may_be_written(command, tmp_path):
    command("new", "--study", "mine", "--process", "three-tanks")
    file = tmp_path / "mine.toml"
    text = file.read_text("utf-8")
    _, _, tuning = text.partition('tuned".tune]')
    controller = study_schema()["properties"]["controllers"]["additionalProperties"]
    for key in controller["properties"]["tune"]["properties"]:
        assert re.search(rf"^(# )?{key}\b", tuning, re.MULTILINE), key
    file.write_text(re.sub("^# (overshoot|total_variation) =", r"\1 =", text, flags=re.MULTILINE))
    (limits,) = [each.tune.limits for each in read_study(file).controllers if each.tune]
    assert limits.overshoot == pytest.approx(10.0)
    assert limits.total_variation == pytest.approx({"feed": 3e-4})  # of 100 cm³/s, the range
