"""Sessions and rigs that cannot be: told where, and what to do."""

import json

import pytest

import clepsydra as cl
from clepsydra.laboratory.page_data import FORM
from clepsydra.laboratory.page_file import numbers_of_page
from clepsydra.laboratory.replay import replayed
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import read_session, session_of


@pytest.fixture(scope="module")
def rig():
    plant = cl.load("three-tanks")
    return Rig(plant.linear, [cl.design.simc(plant), cl.design.amigo(plant)])


@pytest.fixture
def saved(rig):
    return {
        "form": FORM, "version": cl.__version__, "digest": rig.digest, "process": "three-tanks",
        "controllers": [each.name for each in rig.controllers], "start": "rest", "samples": 20,
        "seed": 1, "touches": [{"sample": 3, "input": "feed.mode", "value": 0}],
    }  # fmt: skip


def test_a_file_that_is_damaged_is_told_by_its_line(saved, tmp_path):
    path = tmp_path / "session.json"
    path.write_text(json.dumps(saved, indent=1)[:60], encoding="utf-8")
    with pytest.raises(cl.InputError, match=r"session\.json, line \d, column \d+: got no JSON"):
        read_session(path)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"version": "0.0.9"}, "version: got '0.0.9'.*run it with Clepsydra 0.0.9"),
        ({"form": 7}, "form: got 7"),
        ({"form": True}, "form: got True"),
        ({"start": "full"}, "start: got 'full', expected one of rest, empty"),
        ({"samples": 0}, "samples: got 0"),
        ({"seed": -1}, "seed: got -1"),
        ({"controllers": [1]}, "controllers: got"),
        ({"titles": ["reg1.mat"]}, "titles: got"),
        ({"titles": {"a": "x" * 301}}, r"titles\.a: got"),
        ({"touches": [3]}, r"touches\[0\]: got no object"),
        ({"touches": [{"sample": 20, "input": "a", "value": 1}]}, r"touches\[0\]\.sample: got 20"),
        ({"touches": [{"sample": 2, "noise": 1}]}, r"touches\[0\], noise: got 1"),
        ({"touches": [{"sample": 1, "input": "a", "value": None}]}, r"\[0\]\.value: got None"),
        ({"touches": [{"sample": 1, "drift": "level_3"}]}, r"\[0\]\.rate: got None"),
        ({"touches": [{"sample": 1, "parameters": {"a": "b"}}]}, r"\.parameters\.a: got 'b'"),
        ({"touches": [{"sample": 1, "settings": {}}]}, r"touches\[0\], of: got nothing"),
        ({"touches": [{"sample": 1, "controller": "a", "start": "hot"}]}, r"start: got 'hot'"),
        (
            {"touches": [{"sample": 5, "noise": True}, {"sample": 4, "noise": False}]},
            r"touches\[1\]\.sample: got 4, expected a sample from 5",
        ),
    ],
)
def test_what_is_wrong_in_a_session_is_told_in_its_place(saved, changed, words):
    with pytest.raises(cl.InputError, match=words):
        session_of(saved | changed, "session.json")


def test_what_is_missing_is_told(saved):
    for name in saved:
        rest = {key: value for key, value in saved.items() if key != name}
        with pytest.raises(cl.InputError, match=f"session.json, {name}: got nothing"):
            session_of(rest, "session.json")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"digest": "0" * 16}, "digest: got '0000000000000000'.*controllers that the page was"),
        ({"touches": [{"sample": 0, "input": "feed.mood", "value": 0}]}, "'feed.mode' was meant"),
        ({"touches": [{"sample": 0, "controller": "PI, SIMD"}]}, "'PI, SIMC' was meant"),
        ({"touches": [{"sample": 0, "drift": "levle_3", "rate": 1}]}, "'level_3' was meant"),
        (
            {"touches": [{"sample": 0, "parameters": {"outlet_3.are": 1}}]},
            "'outlet_3.area' was meant",
        ),
        (
            {"touches": [{"sample": 0, "settings": {"controller.gain": 1}, "of": "PI, SIMC"}]},
            r"touches\[0\]\.settings: got 'controller.gain'",
        ),
    ],
)
def test_a_session_of_another_rig_is_refused(rig, saved, changed, words):
    with pytest.raises(cl.InputError, match=words):
        replayed(rig, session_of(saved | changed, "session.json"), "session.json")


def test_a_session_that_is_as_saved_runs(rig, saved):
    run = replayed(rig, session_of(saved, "session.json"), "session.json")
    assert run.scores["total_variation[feed]"] == pytest.approx(0.0, abs=1e-16)


def test_a_rig_without_controllers_or_with_one_twice_is_refused():
    plant = cl.load("three-tanks")
    simc = cl.design.simc(plant)
    for given, words in (([], "at least one controller"), ([simc, simc], "got 'PI, SIMC'")):
        with pytest.raises(cl.InputError, match=words):
            cl.lab(plant, given)


def test_a_page_that_is_none_is_refused(rig, saved, tmp_path):
    path = tmp_path / "lab.html"
    for text, words in (
        ("<p>none</p>", "got no page of a laboratory"),
        ('<script type="application/json" id="data">{"form": 1}</script>', "form: got 1"),
        (
            f'<script type="application/json" id="data">{{"form": {FORM}}}</script>',
            "a damaged page",
        ),
    ):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(cl.InputError, match=words):
            numbers_of_page(path)
