"""A scenario that asks a measurement to pass its alarms is told so before it runs."""

from pathlib import Path

from written_plants import plant_of

import clepsydra as cl

TANK = (Path(__file__).parents[2] / "alarmed-tank.toml").read_text(encoding="utf-8")
HELD = "it holds pump_1, so that the setpoint is never held"


def caveats(folder, high_high, setpoint):
    plant = plant_of(folder, TANK, ('limit = "15 cm"', f'limit = "{high_high}"'))
    step = [cl.step("level_1", to=setpoint, at="10 s")]
    found = cl.study(plant, [cl.design.simc(plant)], step, duration="100 s")
    return [str(each.words) for each in found.ranking[0].caveats]


def test_a_setpoint_beyond_an_interlock_is_told(tmp_path):
    said = caveats(tmp_path, "15 cm", "17 cm")
    assert any("setpoint of level_1 of 17 cm" in words and HELD in words for words in said)


def test_a_setpoint_before_it_is_not(tmp_path):
    assert not any("high-high" in words for words in caveats(tmp_path, "15 cm", "14.9 cm"))


def test_an_alarm_at_the_operating_point_is_told(tmp_path):
    said = caveats(tmp_path, "14 cm", "13 cm")
    assert any("At the operating point level_1 rests at 14.54 cm" in words for words in said)
