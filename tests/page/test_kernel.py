"""A kernel in the page: in parts it computes what it computes at once, and what the engine does."""

import base64
from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import Kernel
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.engine.web_assembly import web_assembly
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.program.delay_ring import DelayRing

from .conftest import source

SAMPLES = 400
#: Its dead time is made of rings that turn several times a sample.
DEAD_TIME = Path(__file__).parents[1] / "dead-time.toml"
SCRIPT = f"""
import {{ Kernel }} from "{source("live/kernel.ts")}";
const module = await WebAssembly.compile(Buffer.from(given.module, "base64"));
const found = given.parts.map((parts) => {{
  const kernel = new Kernel(module, given.sizes);
  kernel.inputs.set(given.inputs);
  for (let again = 0; again < 2; ++again) {{
    kernel.begin(given.state, given.parameters);
    for (const samples of parts) kernel.run(samples);
  }}
  return {{ record: [...kernel.record], state: [...kernel.state] }};
}});
answer(found);
"""


def loop_of(design, process):
    plant = cl.load(process)
    controller = getattr(cl.design, design)(plant)
    loop = Loop(controller, plant.linear)
    program = closed_loop(plant.process, controller, substeps=loop.substeps)
    return loop, program, default_scenario(plant.linear)


@pytest.mark.parametrize(
    ("design", "process", "rings"),
    [("simc", "quadruple-tank", 0), ("recomputed_lqi", "quadruple-tank", 0),
     ("smith_predictor", "eight-tanks", 1), ("smith_predictor", DEAD_TIME, 4)],
)  # fmt: skip
def test_in_parts_it_computes_what_the_engine_does(design, process, rings, node):
    loop, program, scenario = loop_of(design, process)
    given = {name: column[:SAMPLES] for name, column in loop.inputs_of(scenario).items()}
    given = {**loop.at_rest(), **given}
    job = Kernel(program, fuse=False).prepare(
        SAMPLES, inputs={signal.name: given[signal.name] for signal in program.inputs},
        state=loop.initial_state(), parameters=loop.law_parameters(),
    )  # fmt: skip
    held, places = job.initial_rings().ravel(), rings_and_turns(program)
    starts = np.cumsum([0, *(ring.length for ring, _ in places)])[:-1]
    random = np.random.default_rng(3)
    cuts = [np.sort(random.integers(0, SAMPLES, 9)) for _ in range(5)]
    parts = [np.diff(each, prepend=0, append=SAMPLES).tolist() for each in cuts]
    found = node(SCRIPT, {
        "module": base64.b64encode(web_assembly(program)).decode("ascii"),
        "sizes": {
            "state": len(program.state), "parameters": len(program.parameters),
            "inputs": len(program.inputs), "outputs": len(program.outputs), "samples": SAMPLES,
            "rings": [
                {"initial": float(held[start]), "length": ring.length, "turns": turns}
                for start, (ring, turns) in zip(starts, places, strict=True)
            ],
        },
        "inputs": job.shared.ravel().tolist(), "parameters": job.parameters.ravel().tolist(),
        "state": job.initial[0, : len(program.state), 0].tolist(),
        "parts": [[SAMPLES], *([n for n in each if n] for each in parts)],
    })  # fmt: skip
    assert len(places) == rings
    expected = job.run()
    numbers = [place for place, each in enumerate(program.state) if not isinstance(each, DelayRing)]
    for each in found:
        assert np.array_equal(each["record"], expected.record.ravel() + 0.0)
        state = np.array(each["state"])
        assert np.array_equal(state[numbers], expected.final_state[numbers, 0] + 0.0)
