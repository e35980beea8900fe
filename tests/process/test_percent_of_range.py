"""Percent of a range, wherever a signal from outside has one."""

import pytest

import clepsydra as cl

FILE = """
name = "one-tank"
sampling_period = "1 s"
controlled = ["level_1"]
[reservoirs.basin]
[tanks.tank_1]
area = "28 cm2"
height = "20 cm"
[orifices.outlet_1]
source = "tank_1"
destination = "basin"
area = "0.071 cm2"
[pumps.pump_1]
source = "basin"
destination = "tank_1"
gain = "1 lpm/A"
range = ["4 mA", "20 mA"]
nominal = "50 %"
[flows.rain]
destination = "tank_1"
range = ["0.1 lpm", "0.5 lpm"]
nominal = "25 %"
step = ["10 %", "-5 %"]
[sensors.level_1]
tank = "tank_1"
range = ["0 cm", "20 cm"]
"""


def test_nominal_values_and_steps_in_percent_are_those_of_the_range(tmp_path):
    path = tmp_path / "plant.toml"
    path.write_text(FILE, encoding="utf-8")
    process = cl.load(path).process
    assert process.signal("pump_1").initial == pytest.approx(12e-3, rel=1e-15)
    assert process.signal("rain").initial == pytest.approx(0.2e-3 / 60, rel=1e-15)
    (rain,) = (each for each in process.elements if each.name == "rain")
    assert rain.steps == pytest.approx((0.04e-3 / 60, -0.02e-3 / 60), rel=1e-15)


def test_percent_beyond_the_range_are_refused(tmp_path):
    path = tmp_path / "plant.toml"
    path.write_text(FILE.replace('"50 %"', '"150 %"'), encoding="utf-8")
    with pytest.raises(
        cl.InputError, match=r"nominal: got '28.0 mA', expected a signal of at most 20 mA"
    ):
        cl.load(path)
