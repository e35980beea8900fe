"""A batch of runs under an analyser that is late and seldom: any lane is its own run."""

from pathlib import Path

import numpy as np

from clepsydra import Kernel
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.loop import Loop
from clepsydra.process.reader import load_process

FILE = Path(__file__).parents[2] / "docs" / "examples" / "analyser.toml"
SAMPLES = 300


def test_any_lane_equals_its_own_run_bit_for_bit():
    analysis = analyse(load_process(f"{FILE}:seldom"))
    loop = Loop(design_simc(analysis.model, analysis.pairing), analysis.model)
    program = closed_loop(loop.process, loop.controller, substeps=loop.substeps)
    kernel = Kernel(program, individual=["rinse"])

    def run(rinses):
        profile = np.full((len(rinses), SAMPLES), 1e-4)
        profile[:, 20:] = np.array(rinses)[:, None]
        return kernel.run(
            SAMPLES, inputs=loop.at_rest() | {"rinse": profile}, state=loop.initial_state(),
            parameters=loop.law_parameters(),
        )  # fmt: skip

    rinses = np.linspace(0.0, 2e-4, 11)
    together = run(rinses)
    told = together.output("strength")
    assert np.ptp(told[:, 100]) > 0.1
    # Between two reports the last one is held, in every lane.
    assert np.array_equal(told[:, 102:114], np.repeat(told[:, 102:103], 12, axis=1))
    for scenario, rinse in enumerate(rinses):
        assert np.array_equal(together.record_of(scenario), run([rinse]).record_of(0))
