"""What no controller can do, since a final element is too small: both flows by hand."""

import json
import math

import pytest
from written_plants import plant_of

import clepsydra as cl
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.studies.warnings.out_of_reach import out_of_reach

LEVEL = """
name = "vessel"
title = "Vessel"
sampling_period = "5 s"
controlled = ["level"]
[reservoirs.basin]
[tanks.vessel]
area = "7 m^2"
height = "4 m"
{outflow}
[flows.feed]
destination = "vessel"
range = ["0 m^3/h", "100 m^3/h"]
nominal = "20 m^3/h"
step = {step}
[sensors.level]
tank = "vessel"
range = ["0 m", "4 m"]
[operating_point]
level = "2 m"
"""
PUMP = """
[pumps.drain]
source = "vessel"
destination = "basin"
gain = "0.259 m^3/(h %)"
range = ["{least}", "100 %"]
"""
VALVE = """
[valves.drain]
source = "vessel"
destination = "basin"
kv = "{kv} m^3/h"
pressure = "1 bar"
range = ["0 %", "100 %"]
"""


@pytest.fixture
def said(tmp_path):
    """Return a function: what drains the vessel, the step of its feed → what is told."""

    def reach(outflow, step="12 m^3/h"):
        model = plant_of(tmp_path, LEVEL.format(outflow=outflow, step=json.dumps(step))).linear
        return out_of_reach(model, default_scenario(model))

    return reach


def test_a_pump_that_is_too_small_is_told_with_both_flows(said):
    """100 times 0.259 m³/h against 20 + 12."""
    (found,) = said(PUMP.format(least="0 %"))
    assert found.seen == (
        "drain gives at most 25.9 m³/h, and 32 m³/h are needed to hold the load step of feed by "
        "12 m³/h"
    )
    assert "size" in found.remedy


@pytest.mark.parametrize("step", ["5.8 m^3/h", "-5.8 m^3/h"])
def test_what_it_can_give_is_no_word_worth(said, step):
    assert said(PUMP.format(least="0 %"), step) == ()


def test_a_pump_that_cannot_go_as_low_is_told(said):
    """A tenth of 25.9 m³/h, against 20 - 18."""
    (found,) = said(PUMP.format(least="10 %"), "-18 m^3/h")
    assert "gives at least 2.59 m³/h, and 2 m³/h are needed" in found


def test_the_most_of_a_valve_is_that_at_the_level_that_is_held(said):
    """Kv √(p / bar), with 2 m of water beside the 1 bar, and its setpoint steps are in reach."""
    head = 1.0 + 1000.0 * 9.81 * 2.0 / 1e5
    most = 23.0 * math.sqrt(head)
    assert 20.0 < most < 32.0
    (found,) = said(VALVE.format(kv=23))
    assert f"gives at most {most:.3g} m³/h, and 32 m³/h are needed" in found
    assert said(VALVE.format(kv=33 / math.sqrt(head))) == ()


def test_of_two_steps_that_are_out_of_reach_the_larger_is_told(said):
    """One after the other, 20 + 7 and 20 + 7 + 15 m³/h."""
    (found,) = said(PUMP.format(least="0 %"), ["7 m^3/h", "15 m^3/h"])
    assert "42 m³/h are needed to hold the load step of feed by 15 m³/h" in found


def test_a_study_says_it_before_it_says_that_none_can_be_recommended(tmp_path):
    plant = plant_of(tmp_path, LEVEL.format(outflow=PUMP.format(least="0 %"), step='"12 m^3/h"'))
    found = cl.study(plant, [cl.design.simc(plant)])
    assert found.warnings[0].startswith("drain gives at most 25.9 m³/h, and 32 m³/h are needed")
    assert found.verdict.startswith(found.warnings[0].brief)
    assert "No controller of this study can be recommended" in found.verdict
