"""Where a law rests and how robust its loop is, found in the page from its programs alone."""

from dataclasses import replace
from itertools import chain

import numpy as np
import pytest
from page_in_node import source

import clepsydra as cl
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.loop.loop import Loop
from clepsydra.report.live.law_programs import resting, slopes
from clepsydra.report.live.modules import Modules
from clepsydra.report.live.sampled_plant import sampled_plant
from clepsydra.report.live.sliders import bolder, sliders

PROCESSES = [entry.name for entry in cl.catalogue()]
DESIGNS = (
    "simc", "lqi", "lqi_kalman", "gain_scheduled_pid", "smith_predictor", "polynomial",
    "glover_mcfarlane", "disturbance_rejection", "feedback_linearisation",
)  # fmt: skip
#: Each search for a peak stops where a maximum can rise by no more than this share.
RISE = 1e-9
ROBUSTNESS = f"""
import {{ unpacked, unpackedNumbers }} from "{source("live/bytes.ts")}";
import {{ Kernel }} from "{source("live/kernel.ts")}";
import {{ analysisOf, lawOf, plantOf }} from "{source("live/linear_loop.ts")}";
import {{ marginsOf }} from "{source("live/margins.ts")}";
const found = [];
for (const {{ module, slopes, plant, values, period }} of given) {{
  const kernel = new Kernel(await WebAssembly.compile(await unpacked(module)), {{
    state: 0, parameters: values.length, inputs: 0, outputs: slopes.entries.length, rings: [],
    samples: 1,
  }});
  kernel.begin([], values);
  kernel.run(1);
  const process = plantOf(plant, await unpackedNumbers(plant.packed));
  const law = lawOf(slopes, kernel.record);
  const {{ poles, stable, peak }} = analysisOf(process, law);
  found.push({{ stable, peak, margins: marginsOf(process, plant, law, poles, period) }});
}}
answer(found);
"""
RESTING = f"""
import {{ unpacked }} from "{source("live/bytes.ts")}";
import {{ RestingLaw }} from "{source("live/start.ts")}";
const found = [];
for (const {{ module, law, own, cases }} of given) {{
  const resting = new RestingLaw(law, await WebAssembly.compile(await unpacked(module)), own);
  found.push(cases.map((values) => resting.begin({{ law: 0, state: law.state }}, values)));
}}
answer(found);
"""


def controllers(plant):
    for name in DESIGNS:
        try:
            yield getattr(cl.design, name)(plant)
        except cl.NotApplicable:
            continue


def values_of(controller):
    return [controller.values[each.name] for each in controller.law.parameters]


def state_of(controller):
    return [controller.initial_state[entry.name] for entry in controller.law.state]


def moved(controller, factor):
    """Return the values with every slider moved that has several decades."""
    values = np.array(values_of(controller))
    for place, power in bolder(controller):
        values[place] *= factor**power
    for setting in (each for loop in sliders(controller) for each in loop["settings"]):
        if setting["logarithmic"]:
            values[setting["values"]] *= factor
    return values.tolist()


@pytest.mark.sampled
@pytest.mark.parametrize("process", PROCESSES)
def test_peak_and_margins_are_those_that_python_finds(process, node):
    plant, given, expected = cl.load(process), [], []
    for controller in controllers(plant):
        modules = Modules()
        told = slopes(controller, plant.measured, modules)
        given.append({
            "module": modules.held[told["module"]], "slopes": told,
            "plant": sampled_plant(controller, plant.measured),
            "values": [*values_of(controller), *state_of(controller)],
            "period": plant.process.sampling_period,
        })  # fmt: skip
        peak = sampled_loop(controller, plant.measured).maximum_sensitivity
        expected.append((peak, cl.margins(controller, plant)))
    assert len(given) >= 5
    for found, (peak, table) in zip(node(ROBUSTNESS, given), expected, strict=True):
        assert found["stable"] and found["peak"] == pytest.approx(peak, rel=2 * RISE)
        margins = [
            [each[key] for key in ("gain", "phase", "crossover", "delay", "peak")]
            for each in found["margins"]
        ]
        assert [each["name"] for each in found["margins"]] == list(table.index)
        np.testing.assert_allclose(margins, table.to_numpy(), rtol=1e-9)


@pytest.mark.sampled
@pytest.mark.parametrize("process", PROCESSES)
def test_a_law_rests_where_python_says(process, node):
    plant, given, expected = cl.load(process), [], []
    for controller in controllers(plant):
        modules, loop = Modules(), Loop(controller, plant.measured)
        told, cases = resting(loop, modules), [moved(controller, by) for by in (1.0, 0.6, 1.5)]
        given.append({
            "module": modules.held[told["module"]], "law": told, "own": values_of(controller),
            "cases": cases,
        })  # fmt: skip
        names = [each.name for each in controller.law.parameters]
        for values in cases:
            other = replace(controller, values=dict(zip(names, values, strict=True)))
            whole = other._rested_as(controller).initial_state
            expected.append([whole[entry.name] for entry in controller.law.state])
    assert len(given) >= 5
    for found, states in zip(chain(*node(RESTING, given)), expected, strict=True):
        np.testing.assert_allclose(found, states, rtol=1e-12, atol=1e-12)
