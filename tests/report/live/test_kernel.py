"""A kernel in the page computes in parts what it computes at once, and what another host does."""

from pathlib import Path

import numpy as np
import pytest
from hosted_report import inputs_of, live_of, run
from page_in_node import source
from tools import need

import clepsydra as cl

#: Its dead time is made of rings that turn several times a sample.
DEAD_TIME = Path(__file__).parents[2] / "dead-time.toml"
SCRIPT = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import {{ Kernel }} from "{source("live/kernel.ts")}";
const module = await WebAssembly.compile(await unpacked(given.module));
const found = given.parts.map((parts) => {{
  const kernel = new Kernel(module, given.sizes);
  kernel.inputs.set(given.inputs);
  for (let again = 0; again < 2; ++again) {{
    kernel.begin(given.state, given.parameters);
    for (const samples of parts) kernel.run(samples);
  }}
  return {{ record: kernel.record, state: kernel.state }};
}});
answer(found);
"""


@pytest.mark.parametrize(
    ("design", "process", "rings"),
    [("simc", "quadruple-tank", 0), ("recomputed_lqi", "quadruple-tank", 0),
     ("smith_predictor", "eight-tanks", 1), ("smith_predictor", DEAD_TIME, 4)],
)  # fmt: skip
def test_in_parts_it_computes_what_it_computes_at_once(design, process, rings, node):
    need("wasmtime")
    plant = cl.load(process)
    data = live_of(cl.study(plant, controllers=[getattr(cl.design, design)(plant)]))
    (live,), samples = data["controllers"], data["samples"]
    loop, inputs = live["loop"], inputs_of(data)
    random = np.random.default_rng(3)
    cuts = [np.sort(random.choice(np.arange(1, samples), 9, replace=False)) for _ in range(5)]
    parts = [np.diff(each, prepend=0, append=samples).tolist() for each in cuts]
    found = node(SCRIPT, {
        "module": data["modules"][loop["module"]],
        "sizes": {
            "state": len(loop["state"]), "parameters": len(loop["parameters"]),
            "inputs": inputs.shape[1], "outputs": loop["outputs"], "samples": samples,
            "rings": loop["rings"],
        },
        "inputs": inputs.ravel().tolist(), "parameters": loop["parameters"],
        "state": loop["state"], "parts": [[samples], *parts],
    })  # fmt: skip
    assert len(loop["rings"]) == rings
    record, state = run(data, live, live["values"])
    for each in found:
        assert np.array_equal(each["record"], record.ravel() + 0.0)
        assert np.array_equal(each["state"], state + 0.0)
