"""What a page shows to flow is what flows."""

from pathlib import Path

import numpy as np
import pytest
from page_in_node import answered, source

import clepsydra as cl
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.replay import replayed
from clepsydra.laboratory.rig import Rig
from clepsydra.laboratory.session import session_of

DEAD_TIME = Path(__file__).parents[1] / "dead-time.toml"
SCRIPT = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import {{ Flows }} from "{source("lab/flows.ts")}";
import {{ Rig }} from "{source("lab/rig.ts")}";
const modules = await Promise.all(
  given.data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
const rig = new Rig(given.data, modules);
const flows = new Flows(modules[given.data.flows.module], given.data.flows);
rig.reset(given.start);
for (let sample = 0; sample < given.samples; ++sample) {{
  for (const [what, ...how] of given.hands[sample] ?? []) rig[what](...how);
  rig.step();
}}
flows.update(rig);
answer({{
  session: rig.session(),
  flows: given.data.flows.paths.map((path, place) => flows.sum([place])),
}});
"""


@pytest.mark.parametrize(
    ("name", "start", "samples", "hands"),
    [
        (
            "quadruple-tank", "empty", 90,
            {
                3: [("touch", "pour_into_tank_3", 1e-5)],
                9: [("parameters", {"extra_outlet_of_tank_1.area": 7e-6, "outlet_4.area": 0.0})],
                20: [("touch", "pump_2.stopped", 1.0)],
            },
        ),
        ("wet-well", "empty", 900, {}),
        ("equalisation-tank", "rest", 60, {9: [("touch", "inflow", 0.5)]}),
    ],
)  # fmt: skip
def test_flows_are_those_of_the_plant_as_it_runs(name, start, samples, hands, tmp_path):
    plant = cl.load(name)
    rig = Rig(plant.linear, [cl.design.simc(plant)])
    given = {"data": page_data(rig), "start": start, "samples": samples, "hands": hands}
    found = answered(SCRIPT, given, tmp_path)
    run = replayed(rig, session_of(found["session"], "session"), "session")
    process, motion = rig.process, rig.process.motion
    values = {p.name: p.initial for p in process.parameters}
    for each in hands.values():
        for what, *how in each:
            values |= how[0] if what == "parameters" else {}
    parameters = [values[p.name] for p in process.parameters]
    last = {name: column[-1] for name, column in run.values.items()}
    outside = {d.name: rig.inputs[d.name] for d in process.disturbances} | {
        how[0]: how[1] for each in hands.values() for what, *how in each if what == "touch"
    }
    flows = motion.flows(
        motion.to_contents([last[x.name] for x in process.state], parameters),
        [],
        [last[m.name] for m in motion.memories],
        [last[f"{u.name}.applied"] for u in process.inputs],
        [outside[d.name] for d in process.disturbances],
        parameters,
    )
    expected = np.array(flows).ravel()
    # What is next to nothing is told as nothing.
    expected[np.abs(expected) < 1e-5 * given["data"]["flows"]["much"]] = 0.0
    assert found["flows"] == pytest.approx(expected.tolist(), rel=1e-14)
    assert np.count_nonzero(expected) >= 2


def test_what_comes_out_of_a_delay_flows_on(tmp_path):
    plant = cl.load(DEAD_TIME)
    rig = Rig(plant.linear, [cl.design.simc(plant)])
    data = page_data(rig)
    given = {"data": data, "start": "rest", "samples": 3, "hands": {}}
    found = answered(SCRIPT, given, tmp_path)["flows"]
    flows = {
        path["element"]: flow for path, flow in zip(data["flows"]["paths"], found, strict=True)
    }
    assert flows["channel"] == pytest.approx(flows["outlet_1"], rel=1e-12)
    assert flows["channel"] > 0.0
