"""Sessions that the page opens and keeps: what is wrong in one is told, and nothing is lost."""

import json

import pytest
from page_in_node import answered, source

READ = f"""
import {{ readSession }} from "{source("lab/session_file.ts")}";
answer(given.texts.map((text) => {{
  try {{
    return readSession(text, given.data);
  }} catch (error) {{
    return error.message;
  }}
}}));
"""
KEEP = f"""
import {{ KeptRuns }} from "{source("lab/kept_runs.ts")}";
const held = new Map(given.held);
const store = {{
  get length() {{ return held.size; }},
  key: (place) => [...held.keys()][place],
  getItem: (key) => held.get(key),
  setItem(key, text) {{
    if (text.length > given.room) throw new Error("full");
    held.set(key, text);
  }},
  removeItem: (key) => void held.delete(key),
}};
const kept = new KeptRuns(given.data, given.isThere ? store : undefined);
const written = given.runs.map((run) => kept.write(run));
for (const id of given.removed) kept.remove(id);
answer({{ written, read: new KeptRuns(given.data, store).read(), keys: [...held.keys()] }});
"""
DATA = {
    "form": 2, "version": "0.1.0", "digest": "abc", "process": "tank", "seed": 1,
    "parameters": [{"name": "outlet.area"}], "measurements": ["level"],
    "laws": {"given": [{}, {}]},
    "controllers": [
        {"name": "PI", "inputs": [["pump.mode", 1], ["level.setpoint", 1]],
         "parameters": [["outlet.area", 1], ["controller.gain", 2]]},
        {"name": "PID", "inputs": [["pump.mode", 1]], "parameters": [["controller.filter", 2]]},
    ],
}  # fmt: skip
TOUCHES = [
    {"sample": 0, "input": "level.setpoint", "value": 0.5},
    {"sample": 3, "parameters": {"outlet.area": 0}},
    {"sample": 3, "settings": {"controller.gain": 3.5}, "of": "PI"},
    {"sample": 4, "controller": "PID", "start": "settled"},
    {"sample": 5, "noise": True},
    {"sample": 19, "drift": "level", "rate": 1e-5},
]
SESSION = {
    "form": 2, "version": "0.1.0", "digest": "abc", "process": "tank", "seed": 1,
    "controllers": ["PI", "PID"], "start": "rest", "samples": 20, "touches": TOUCHES,
    "titles": {"PID": "reg1.mat"},
}  # fmt: skip


def read(texts, folder):
    return answered(READ, {"data": DATA, "texts": texts}, folder)


def test_a_session_that_is_as_saved_is_taken(tmp_path):
    assert read([json.dumps(SESSION)], tmp_path) == [SESSION]


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"form": 1}, "form: got 1, expected 2; open it in a laboratory of the version"),
        ({"version": "0.0.9"}, 'version: got "0.0.9", expected "0.1.0"'),
        ({"digest": "abd"}, 'digest: got "abd", expected "abc"; open the laboratory in which'),
        ({"process": "weir"}, 'process: got "weir", expected "tank"'),
        ({"controllers": ["PI"]}, 'controllers: got ["PI"], expected ["PI","PID"]'),
        ({"seed": 2}, "seed: got 2, expected 1"),
        ({"start": "full"}, 'start: got "full", expected rest or empty'),
        ({"samples": 0}, "samples: got 0"),
        ({"samples": 2.5}, "samples: got 2.5"),
        ({"touches": {}}, "touches: got {}"),
        ({"touches": [3]}, "touches[0]: got 3"),
        ({"touches": [{"sample": -1}]}, "touches[0].sample: got -1"),
        ({"touches": [{"sample": 1, "input": "x", "value": 1}]}, 'touches[0].input: got "x"'),
        (
            {"touches": [{"sample": 1, "input": "pump.mode", "value": None}]},
            "touches[0].value: got null, expected a finite number",
        ),
        (
            {"touches": [{"sample": 1, "parameters": {"hole": 1}}]},
            'touches[0].parameters: got "hole"',
        ),
        (
            {"touches": [{"sample": 1, "settings": {"controller.filter": 1}, "of": "PI"}]},
            'touches[0].settings: got "controller.filter"',
        ),
        ({"touches": [{"sample": 1, "settings": {}, "of": "I"}]}, 'touches[0].of: got "I"'),
        (
            {"touches": [{"sample": 1, "controller": "PI", "start": "now"}]},
            'touches[0].start: got "now"',
        ),
        ({"touches": [{"sample": 1, "noise": 1}]}, "touches[0].noise: got 1"),
        ({"touches": [{"sample": 1, "drift": "pump", "rate": 1}]}, 'touches[0].drift: got "pump"'),
        ({"titles": []}, "titles: got []"),
        ({"titles": {"I": "reg1.mat"}}, 'titles: got "I"'),
        ({"titles": {"PID": "x" * 301}}, "titles.PID: got"),
        ({"touches": [{**TOUCHES[1], "sample": 20}]}, "touches[0].sample: got 20"),
        (
            {"touches": [TOUCHES[4], TOUCHES[3]]},
            "touches[1].sample: got 4, expected a sample from 5",
        ),
    ],
)
def test_what_is_wrong_in_a_session_is_told_in_its_place(changed, words, tmp_path):
    (told,) = read([json.dumps(SESSION | changed)], tmp_path)
    assert told.startswith(words)


def test_what_is_no_session_is_told(tmp_path):
    broken, other = read(["{", "[]"], tmp_path)
    assert broken == "no JSON; choose a session that a laboratory saved"
    assert other.startswith("no session of a laboratory")


def keep(runs, folder, held=(), room=10_000, is_there=True, removed=()):
    given = {"data": DATA, "held": held, "room": room, "isThere": is_there, "removed": removed}
    return answered(KEEP, given | {"runs": runs}, folder)


def run(key, **changed):
    return {"id": key, "name": f"Run {key}", "isPinned": False, "session": SESSION} | changed


def test_runs_are_kept_one_by_one_and_those_of_other_laboratories_left_alone(tmp_path):
    foreign = [["clepsydra laboratory xyz 1", "{}"], ["clepsydra laboratory abc 9", "damaged"]]
    runs = [run("2", isPinned=True), run("1"), run("3"), run("1", name="first")]
    found = keep(runs, tmp_path, held=foreign, removed=["3"])
    assert found["written"] == [True] * 4
    assert found["read"] == [run("1", name="first"), run("2", isPinned=True)]
    assert {key for key, _ in foreign} <= {*found["keys"]}


def test_a_full_store_keeps_what_it_had_and_says_so(tmp_path):
    room = len(json.dumps(run("1"), separators=(",", ":")))
    found = keep([run("1"), run("1", name="long" * 50)], tmp_path, room=room)
    assert found["written"] == [True, False]
    assert found["read"] == [run("1")]


def test_where_nothing_outlasts_the_page_no_room_is_asked_for(tmp_path):
    found = keep([run("1")], tmp_path, is_there=False)
    assert (found["written"], found["read"]) == ([True], [])
