"""The verbs of the laboratory, from the page to the run of its session."""

import json
import re
from pathlib import Path

import pytest

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
    assert [each["name"] for each in data["controllers"]] == NAMES
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
