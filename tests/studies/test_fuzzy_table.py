"""A study file names a file of sets and rules."""

import pytest
from pages import blocks
from refusals import refused

import clepsydra as cl

#: A whole controller for pump 1 of the quadruple tank.
(RULES,) = (b.text for b in blocks("docs/fuzzy-files.md", "toml") if b.file == "level-rules.toml")


def study_of(folder, fuzzy, *, rules=RULES):
    """Return the path of a study file that names a file of rules beside it."""
    (folder / "rules.toml").write_text(rules, encoding="utf-8")
    path = folder / "study.toml"
    path.write_text(
        f"""process = "quadruple-tank"
[scenario]
duration = "2 min"
noise = false
[[scenario.setpoint]]
signal = "level_1"
at = "30 s"
by = "1 V"
[controllers.rules]
fuzzy = {fuzzy}
""",
        encoding="utf-8",
    )
    return path


def test_a_controller_runs_from_its_file_and_starts_without_a_bump(tmp_path):
    (candidate,) = cl.study(study_of(tmp_path, '"rules.toml"')).ranking
    run = candidate.run
    before, after = run.values["pump_1"][run.time < 30.0], run.values["pump_1"][run.time >= 32.0]
    assert before == pytest.approx(run.process.signal("pump_1").initial, abs=1e-9)
    assert after[0] > before[0] + 0.01
    assert candidate.controller.name == "rules"


@pytest.mark.thorough
def test_a_position_begins_at_rest_and_fades_to_what_the_rules_say(tmp_path):
    """At rest the rules say 0 V and the pump stands at 3 V, a tenth of which goes in a sample."""
    rules = RULES.replace('action = "increment"\nunit = "V/min"', 'action = "position"\nunit = "V"')
    path = study_of(tmp_path, '"rules.toml"', rules=rules)
    (candidate,) = cl.study(path).ranking
    pump = candidate.run.values["pump_1"]
    assert pump[0] == pytest.approx(3.0, abs=1e-9)
    assert pump[1] == pytest.approx(2.7, abs=0.05)


@pytest.mark.parametrize(("fuzzy", "value"), [("7", 7), ('"no.toml"', "no.toml"), ('"."', ".")])
def test_what_is_no_file_of_rules_is_refused_with_its_line(fuzzy, value, tmp_path):
    place = f"{tmp_path}/study.toml, line 10, controllers.rules.fuzzy"
    with refused(place=place, value=value, expected="the name of a file of sets"):
        cl.study(study_of(tmp_path, fuzzy))


def test_a_mistake_in_the_rules_is_told_with_the_line_of_their_file(tmp_path):
    """The error of a tank that has no setpoint."""
    rules = RULES.replace('of = "level_1"', 'of = "level_3"', 1)
    line = rules[: rules.index('"level_3"')].count("\n") + 1
    place = f"{tmp_path}/rules.toml, line {line}, inputs.e.of"
    with refused(place=place, value="level_3", expected="a controlled"):
        cl.study(study_of(tmp_path, '"rules.toml"', rules=rules))
