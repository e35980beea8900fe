"""The verbs of the laboratory, from the page to the run of its session."""

import json
import re
import zlib
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

import clepsydra as cl
from clepsydra.cli import main

SCRIPT = Path(cl.__file__).parent / "report" / "page" / "lab.js"
NAMES = ["PI, SIMC", "PI, AMIGO"]


def called(*words):
    with pytest.raises(SystemExit) as ended:
        main(words)
    return ended.value.code


@pytest.mark.skipif(not SCRIPT.exists(), reason="the page is not built")
def test_a_page_is_written_and_its_session_runs_again(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    chosen = [word for name in NAMES for word in ("--controller", name)]
    assert not called("lab", "three-tanks", *chosen, "-o", "tanks.html", "--no-open")
    page = (tmp_path / "tanks.html").read_text(encoding="utf-8")
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    assert policy == (
        "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline' "
        "'wasm-unsafe-eval'; img-src data:"
    )
    assert not re.search(r"(?:src|href)=.?(?:https?:)?//", page)
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])
    alike = json.loads(zlib.decompress(b64decode(data["packed"])))
    assert [each["name"] for each in alike["controllers"]][:2] == NAMES
    session = {key: data[key] for key in ("form", "version", "digest", "process", "seed")}
    session |= {"controllers": NAMES, "start": "empty", "samples": 4000, "touches": []}
    (tmp_path / "session.json").write_text(json.dumps(session), encoding="utf-8")
    capsys.readouterr()
    assert not called("replay", "session.json", "--json")
    told = json.loads(capsys.readouterr().out)
    plant = cl.load("three-tanks")
    at_rest = plant.point.as_dict()
    for name, level in told["levels"].items():
        assert level == pytest.approx(at_rest[name], rel=1e-4)
    assert told["scores"]["iae[level_3]"] > 0.0


def test_a_session_that_is_none_is_refused(tmp_path, capsys):
    path = tmp_path / "session.json"
    path.write_text("[]", encoding="utf-8")
    assert called("replay", str(path)) == 2
    assert "session.json: got no object, expected a session" in capsys.readouterr().err


def test_a_regulator_that_no_page_has_room_for_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    n = 13
    savemat("reg1.mat", {"A": np.eye(n), "B": np.ones((n, 1)), "C": np.ones((1, n)), "D": 0.0})
    chosen = ("--controller", NAMES[0], "--controller", "reg1.mat", "--no-open")
    assert called("lab", "three-tanks", *chosen) == 2
    said = capsys.readouterr().err
    assert "reg1.mat, A: got '13 × 13', expected at most 12 states" in said and "study file" in said
    assert called("lab", "three-tanks", *chosen[:3], "no.mat", "--no-open") == 2
    assert "no.mat: got no such file" in capsys.readouterr().err


@pytest.mark.skipif(not SCRIPT.exists(), reason="the page is not built")
def test_a_lesson_has_a_page_for_each_rig_and_one_with_answers(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wanted = ("lab", "--lesson", "wind-up", "--variant", "7", "--no-open")
    assert not called(*wanted) and not called(*wanted, "--answers")
    names = ["wind-up-7-answers.html", "wind-up-7-lab.html"]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    solution = "integral stays where the pump can follow it"
    assert [solution in (tmp_path / name).read_text("utf-8") for name in names] == [True, False]
    page = (tmp_path / names[1]).read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])
    session = {key: data[key] for key in ("form", "version", "digest", "process", "seed")}
    controllers = ["PI, no anti-windup", "PI, anti-windup"]
    session |= {"controllers": controllers, "start": "rest", "samples": 9, "touches": []}
    (tmp_path / "session.json").write_text(json.dumps(session), encoding="utf-8")
    capsys.readouterr()
    assert session["process"] == "wind-up#7" and not called("replay", "session.json")
    assert "One tank" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("three-tanks", "--lesson", "wind-up"), "PROCESS: got a lesson beside it"),
        (("--lesson", "wind-up", "--all"), "--all: got a lesson beside it"),
        (("--lesson", "windup"), "'wind-up' was meant"),
        (("three-tanks", "--answers"), "--answers: got no lesson"),
        ((), "PROCESS: got no process"),
        (("wet-well", "--variant", "3"), "no hole, split or gain"),
        (("three-tanks", "--variant", "-1"), "variant: got -1"),
        (("three-tanks", "--all", "--controller", "PI, SIMC"), "--controller beside it"),
    ],
)
def test_what_does_not_go_together_is_refused(words, said, capsys):
    assert called("lab", *words, "--no-open") == 2
    assert said in " ".join(capsys.readouterr().err.split())


@pytest.mark.skipif(not SCRIPT.exists(), reason="the page is not built")
def test_all_designs_are_in_a_page_and_the_others_are_told(tmp_path, capsys):
    page = tmp_path / "tanks.html"
    assert not called("lab", "three-tanks#2", "--all", "-o", str(page), "--no-open")
    told = capsys.readouterr().out
    assert "Without Start/stop levels: feed is no" in told
    data = json.loads(re.search(r'id="data">(.*?)</script>', page.read_text("utf-8"), re.DOTALL)[1])
    alike = json.loads(zlib.decompress(b64decode(data["packed"])))
    names = {each["name"] for each in alike["controllers"]}
    assert {"PI, SIMC", "LQI with Kalman filter", "Fuzzy PI"} <= names
    assert data["process"] == "three-tanks#2"
