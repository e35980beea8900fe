"""Exported WebAssembly in a page of Chromium, opened from a file and offline, beside the engine.

A page from a file may import nothing: it holds each exported script as a module of its own, and
each module of WebAssembly in base 64.
"""

import base64

import numpy as np
import pytest
from scripted import CALLED, NAMES, ScriptedRun, module

pytestmark = pytest.mark.browser
SCANS, RUNS = 2_000, 100
BEGIN = """<!doctype html>
<meta charset="utf-8"><link rel="icon" href="data:,">
<script type="module">
%s
globalThis.programs = {};
globalThis.run = async ({ name, ...given }) => {
  const { source, ...exported } = programs[name];
  const bytes = Uint8Array.from(atob(source), (letter) => letter.charCodeAt(0));
  return called(exported, await WebAssembly.compile(bytes), given);
};
</script>
"""
EACH = """<script type="module">
%s
globalThis.programs["%s"] = { instantiate, signals, source: "%s" };
</script>
"""
#: Runs all that is given, one after the other.
ALL = """async (given) => {
    const found = [];
    for (const each of given) found.push(await run(each));
    return found;
}"""
#: The sizes of an instance's memory after no scan and after one.
MEMORIES = """async (given) => {
    const plain = WebAssembly.instantiate, memories = [];
    WebAssembly.instantiate = (module, imports) => {
        memories.push(imports.env.memory);
        return plain(module, imports);
    };
    for (const scans of [0, 1]) await run({ ...given, scans });
    return memories.map((memory) => memory.buffer.byteLength);
}"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A page with every program."""
    parts = [BEGIN % CALLED.read_text("utf-8")]
    for name in NAMES:
        printed = module(name)
        source = base64.b64encode(printed.module).decode()
        parts.append(EACH % (printed.script, name, source))
    path = tmp_path_factory.mktemp("page") / "exported.html"
    path.write_text("".join(parts), encoding="utf-8")
    return path


def differing(page, runs: list[ScriptedRun]) -> list[str]:
    """Return the programs of those runs that are not the engine's in every bit."""
    answers = page.evaluate(ALL, [run.told for run in runs])
    return [run.name for run, answer in zip(runs, answers, strict=True) if not run.is_found(answer)]


def test_what_is_exported_computes_in_a_page_what_the_engine_does(path, opened):
    assert differing(opened(path), [ScriptedRun(name, SCANS, 0, 1) for name in NAMES]) == []


def test_a_run_goes_on_in_a_page_as_if_it_had_never_been_left(path, opened):
    """Random runs, each left before random samples and taken up again, maybe by another one."""
    random = np.random.default_rng(8)
    drawn = [*NAMES, *random.choice(NAMES, RUNS - len(NAMES))]
    runs = [
        ScriptedRun(name, int(random.integers(50, 300)), int(random.integers(1, 12)), seed)
        for seed, name in enumerate(drawn)
    ]
    assert len(runs) == RUNS
    assert differing(opened(path), runs) == []


def test_a_large_kernel_takes_memory_of_its_own_in_a_page(path, opened):
    """Between an instance that has not run and one that has made a step."""
    before, after = opened(path).evaluate(MEMORIES, ScriptedRun("LQI, recomputed", 1, 0, 1).told)
    assert after > before
