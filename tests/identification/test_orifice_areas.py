"""Areas of holes, at rest, against Torricelli by hand."""

import math

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.identification.orifice_areas import orifice_areas_at_rest

PLANT = cl.load("laboratory-four-tanks:report,volts")
PROCESS = PLANT.process
HOLES = {"outlet_1": 0.1563, "outlet_2": 0.1283, "outlet_3": 0.0637, "outlet_4": 0.0566}  # cm²


def record(levels, volts):
    return {f"tank_{i}.level": 0.01 * h for i, h in enumerate(levels, 1)} | {
        f"pump_{i}": u for i, u in enumerate(volts, 1)
    }


def test_levels_at_rest_by_hand():
    """Torricelli tank by tank, from the flows of the pumps."""
    levels, volts = (19.0, 21.0, 13.0, 11.0), (6.0, 8.0)
    root = [math.sqrt(2 * 981.0 * h) for h in levels]
    flows = 4.32 * volts[0], 3.74 * volts[1]
    upper = 0.375 * flows[1], 0.375 * flows[0]
    lower = 0.625 * flows[0] + upper[0], 0.625 * flows[1] + upper[1]
    expected = [q / v for q, v in zip((*lower, *upper), root, strict=True)]
    found = orifice_areas_at_rest(PROCESS, [record(levels, volts)])
    for i, area in enumerate(expected, 1):
        assert 1e4 * found[f"outlet_{i}"] == pytest.approx(area, rel=1e-10), i


def test_several_records_agree_on_the_holes():
    points = [
        PLANT.at(inputs={"pump_1": one, "pump_2": two}).point.as_dict()
        for one, two in ((5.0, 5.0), (6.0, 3.0), (3.0, 6.5))
    ]
    found = orifice_areas_at_rest(PROCESS, points)
    assert {name: 1e4 * area for name, area in found.items()} == pytest.approx(HOLES, rel=1e-6)


def test_refusals():
    sound = record((19.0, 21.0, 13.0, 11.0), (6.0, 8.0))
    with refused(expected="at least one"):
        orifice_areas_at_rest(PROCESS, [])
    with refused(place="record 1, tank_2.level"):
        orifice_areas_at_rest(PROCESS, [sound | {"tank_2.level": math.nan}])
    with refused(place="record 2, pump_1"):
        orifice_areas_at_rest(PROCESS, [sound, {k: v for k, v in sound.items() if k != "pump_1"}])
    with refused(value="no flow through outlet_3"):
        orifice_areas_at_rest(PROCESS, [sound | {"tank_3.level": 0.0}])
    with refused(expected="orifices"):
        orifice_areas_at_rest(cl.load("averaging-tank").process, [sound])
