"""No controller of a study is better than the limit says that it could be."""

from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.loop.loop import Loop

#: What a limit is proved within.
TOLERANCE = 0.005
#: Every process of the catalogue as it is, and in each variant that it is not in by itself.
PLANTS = [
    name
    for each in cl.catalogue()
    for name in (
        each.name,
        *(f"{each.name}:{v}" for v in each.variants if v not in each.default_variants),
    )
]


def nominal(scenario):
    """Return a scenario without the noise of sensors and flows, as its limits are without."""
    loads = scenario.quiet_disturbances
    loads = scenario.disturbances if loads is None else loads
    return replace(scenario, noise=np.zeros_like(scenario.noise), noises=(), disturbances=loads)


@pytest.mark.thorough
@pytest.mark.parametrize("name", PLANTS)
def test_every_plant_has_its_limits_or_the_reason_and_no_controller_beats_them(studied, name):
    limits = cl.limit(name)
    assert limits.found or limits.refused
    assert len(limits.proved) == len(limits.found)
    assert all(each.reason for each in limits.refused)
    if limits.proved:  # else there is nothing to beat, and its study would be for nothing
        study = studied(name)
        scenario = nominal(study.scenario)
        for each in study.ranking:
            run = Loop(each.controller, study.plant.linear).run(scenario)
            assert limits.times(run) > 1.0 - TOLERANCE, each.controller.name
