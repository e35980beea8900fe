"""The verb that lists designs: each with its words and source, and which apply to a process."""

import json

import pytest

import clepsydra as cl

#: What is made of a file and is no method.
_OF_FILES = ("own", "fuzzy")


def test_every_design_is_listed_with_what_it_takes_and_its_source(command):
    status, said, _ = command("designs", "--all")
    assert status == 0
    entries = {each.splitlines()[0]: each for each in said.split("\n\n")[:-1]}
    assert list(entries) == [name.rstrip("_") for name in dir(cl.design) if name not in _OF_FILES]
    for each in entries.values():
        assert max(map(len, each.splitlines())) <= 100
    assert "closed_loop_time_constant" in entries["simc"]
    # Its docstring refers to that of the settings, which names Hägglund's book.
    assert "As for" not in said and "Advanced PID Control" in entries["amigo"]


@pytest.mark.parametrize("process", ["wet-well", "quadruple-tank"])
def test_a_design_applies_where_a_study_tries_it(command, process):
    """By the first controller that a study makes of each design."""
    status, said, _ = command("designs", process, "--json")
    assert status == 0
    verdicts = {each["name"]: each for each in json.loads(said)["designs"]}
    study = cl.study(process, only="PI, arrest time")
    assert verdicts["arrest_time"]["applies"] is (not study.not_applicable)
    assert verdicts["simc"]["applies"] is True
    assert verdicts["lqi_by_weights"]["applies"] is None
    assert verdicts["lqi_by_weights"]["needs"] == ["weights"]
    refusals = [each for each in verdicts.values() if each["applies"] is False]
    assert refusals and all("not applicable" in each["reason"] for each in refusals)
    if study.not_applicable:
        reason = dict(study.not_applicable)["PI, arrest time"]
        assert reason in verdicts["arrest_time"]["reason"]


def test_what_depends_on_an_argument_says_so(command):
    _, said, _ = command("designs", "equalisation-tank", "--all")
    assert "equalisation-tank: depends on its weights" in said
    assert "equalisation-tank: applies" in said


def test_what_applies_is_answered_in_a_screen(command, at_widths):
    _, said, _ = command("designs", "--json", "quadruple-tank")
    applying = [each["name"] for each in json.loads(said)["designs"] if each["applies"]]
    told = at_widths("designs", "quadruple-tank")
    for columns in (80, 100):
        lines = told[columns].splitlines()
        assert len(lines) <= 25 and max(map(len, lines)) <= columns
        assert lines[0].startswith(f"{len(applying)} of ")
        assert ", ".join(applying) in " ".join(told[columns].split())
        assert "regulator (regulator)" in " ".join(told[columns].split())


@pytest.mark.parametrize("columns", ["80", "100"])
def test_the_usual_designs_come_first_and_the_rest_is_counted(command, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    _, said, _ = command("designs")
    head, *rows, more, _ = said.splitlines()
    assert len(rows) <= 22 and max(map(len, said.splitlines())) <= int(columns)
    names = [row.split()[0] for row in rows]
    known = [name.rstrip("_") for name in dir(cl.design) if name not in _OF_FILES]
    assert head.split()[0] == "design" and set(names) < set(known)
    assert names.index("simc") < names.index("lqi") < names.index("feedback_linearisation")
    assert more.startswith(f"{len(known) - len(names)} more, ") and more.endswith("--all")


def test_no_process_is_refused(command):
    status, said, error = command("designs", "quadruple-tnak")
    assert (status, said) == (2, "") and "quadruple-tank" in error
