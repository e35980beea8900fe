"""How long an integration step may be where instruments are much quicker than the sampling."""

from dataclasses import replace

import numpy as np
import pytest

from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.reader import load_process

RELIEF = "equalisation-tank:relief"


def sampled(name: str, period: float):
    return analyse(replace(load_process(name), sampling_period=period))


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "period", "substeps"),
    [
        # The valve's lag of 0.3 s, a hundredth of its stroke: settled 200 times, one step each.
        (RELIEF, 60.0, 200),
        # Settled 20 times, and just less: ten steps each.
        (RELIEF, 6.0, 20),
        (RELIEF, 5.9, 197),
        # Flow meters with 5 s: settled 12 times, then 24 times.
        ("equalisation-tank:dosing", 60.0, 120),
        ("equalisation-tank:dosing", 120.0, 24),
        # Meters and pumps with 2 s: settled once, then 20 times.
        ("wet-well:flow-meters", 2.0, 10),
        ("wet-well:flow-meters", 40.0, 20),
        # Tanks alone, however often the fastest of 22.76 s settles.
        ("quadruple-tank", 1000.0, 440),
    ],
)
def test_only_lags_of_instruments_that_settle_get_steps_as_long_as_themselves(
    name: str, period: float, substeps: int
) -> None:
    assert substeps_for(sampled(name, period).model) == substeps


@pytest.mark.thorough
def test_the_tanks_are_as_exact_as_the_reference_solver_while_the_valve_jumps_each_sample() -> None:
    """Steps as long as the lag of 0.3 s; the valve goes up to its whole stroke from sample to
    sample, and the basin with it."""
    analysis = analyse(load_process(RELIEF))
    model = linearise(analysis.operating_point)
    loop = Loop(design_simc(analysis.model, analysis.pairing), model)
    short = default_scenario(analysis.model)
    samples, random = 60, np.random.default_rng(3)
    noise = np.zeros((samples, len(loop.process.measurements)))
    noise[:, 0] = random.normal(0.0, 0.2, samples)
    scenario = Scenario(
        60.0, short.setpoints[:samples], short.disturbances[:samples], noise, (), seed=3
    )
    coarse, exact = loop.run(scenario), loop.run(scenario, solver="reference")
    valve = exact.values["relief.position"]
    assert coarse.substeps == 200
    assert np.abs(np.diff(valve)).max() > 0.3
    for state in loop.process.state:
        missed = np.abs(coarse.values[state.name] - exact.values[state.name]).max() / state.span
        assert missed < 1e-7, state.name
    # A step three times as long as the lag is beyond the reach of the method.
    wild = loop.run(scenario, substeps=66)
    assert not np.abs(wild.values["relief.position"] - valve).max() < 1e-3
