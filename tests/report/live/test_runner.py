"""Which runs a page asks its worker for, in Node."""

from page_in_node import source

#: A worker that notes the runs that are posted; `given` are numbers to ask for, and what comes.
SCRIPT = f"""
import {{ Runner }} from "{source("live/runner.ts")}";
const [posted, timers] = [[], []];
globalThis.setTimeout = (act) => timers.push(act);
let come;
const worker = {{
  addEventListener: (kind, act) => {{ if (kind === "message") come = (data) => act({{ data }}); }},
  postMessage: (message) => posted.push(message.kind === "run" ? message.values[0] : message.kind),
}};
const heard = [];
const listener = {{
  ran: (trial, message) => heard.push([trial.values[0], message.whole]),
  analysed: (trial) => heard.push([trial.values[0], "analysed"]),
  refused: (words, isFinal) => heard.push([words, isFinal]),
}};
const runner = new Runner(worker, {{ kind: "load" }}, listener);
for (const each of given)
  if (typeof each === "number") runner.ask({{ controller: 0, values: [each], isAsBefore: false }});
  else if (each === "patience") timers.splice(0).forEach((act) => act());
  else come(each);
answer([posted, heard]);
"""
READY = {"kind": "ready"}


def ran(run, whole=True):
    return {"kind": "ran", "run": run, "whole": whole}


def test_one_run_goes_and_only_the_newest_waits(node):
    given = [1, 2, READY, 3, 4, 5, ran(0), {"kind": "analysed", "run": 0}, ran(1)]
    posted, heard = node(SCRIPT, given)
    assert posted == ["load", 2, 5]
    assert heard == [[2, True], [2, "analysed"], [5, True]]


def test_a_run_that_takes_long_makes_way_once_it_has_shown_something(node):
    given = [READY, 1, 2, ran(0, whole=False), 3]
    assert node(SCRIPT, given)[0] == ["load", 1]
    posted, heard = node(SCRIPT, [*given, "patience", ran(1)])
    assert posted == ["load", 1, 3]
    assert heard == [[1, False], [3, True]]


def test_a_run_that_breaks_off_leaves_room_for_the_next(node):
    refused = {"kind": "refused", "words": "The run broke off."}
    posted, heard = node(SCRIPT, [READY, 1, 2, refused])
    assert posted == ["load", 1, 2]
    assert heard == [["The run broke off.", False]]
    assert node(SCRIPT, [refused])[1] == [["The run broke off.", True]]
