"""Wires between a controller and tags: none between two units."""

import pytest

from clepsydra.base.errors import InputError
from clepsydra.deploy.exportable import exportable
from clepsydra.hil.wiring import check_units
from clepsydra.linear.linearise import operating_point_of
from clepsydra.papers.averaging_tank.range_controllers import controller_of
from clepsydra.papers.averaging_tank.step_run import model_of
from clepsydra.rig.tags import tags_of


def test_a_controller_without_units_is_refused():
    """Its concentrations are mol/m³, those on the wires kmol/m³."""
    point = operating_point_of(model_of("outflow", 0.01, high=True))
    ready = exportable(controller_of("outflow", "PI", 0.01), point)
    told = r"concentration.sp: got '1', expected kmol/m.3, as its tag"
    with pytest.raises(InputError, match=told):
        check_units(ready, tags_of(point))
