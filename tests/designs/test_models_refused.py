"""What no design can be made of: no model, and a model of no process."""

from dataclasses import replace

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.phase_margin import design_phase_margin
from clepsydra.designs.simc import design_simc

PAIRING = [("level_1", "pump_1"), ("level_2", "pump_2")]
DESIGNS = {
    "simc": lambda model: design_simc(model, PAIRING),
    "phase margin": lambda model: design_phase_margin(model, PAIRING),
    "lqi": design_lqi,
}


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.mark.parametrize("design", DESIGNS)
def test_a_model_without_an_operating_point_is_refused_by_all_alike(plant, design):
    with refused(place="linear model, point", value=None, expected="a model of"):
        DESIGNS[design](replace(plant.linear, point=None))


@pytest.mark.parametrize("design", DESIGNS)
def test_what_is_no_model_is_refused(plant, design):
    with refused(place="model", value="a Process"):
        DESIGNS[design](plant.process)
    with refused(place="model", value=None):
        DESIGNS[design](None)
