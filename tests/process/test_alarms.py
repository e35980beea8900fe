"""Alarms of a process file: what the template shows can be written, and editors know it."""

import re
import tomllib
from pathlib import Path

import pytest
from json_schema import faults
from written_plants import plant_of

import clepsydra as cl
from clepsydra.process.alarm import AlarmKind, Priority
from clepsydra.process.schema import process_schema

ALARMED = Path(__file__).parents[1] / "alarmed-tank.toml"
SCHEMA = process_schema()


def test_what_the_template_shows_can_be_written(tmp_path):
    template = cl.new_process("my-plant", folder=tmp_path).read_text(encoding="utf-8")
    block = re.search(r"^# \[alarms\.level_1\]\n(# .*\n)+", template, re.MULTILINE).group()
    lines = [line[2:] for line in block.splitlines()]
    shown = "\n".join(line for line in lines if re.match(r"\[|\w+ = ", line))
    plant = plant_of(tmp_path, template.replace(block, shown + "\n"))
    assert {alarm.kind for alarm in plant.process.alarms} == set(AlarmKind)
    assert list(faults(tomllib.loads(template.replace(block, shown)), SCHEMA)) == []


@pytest.mark.parametrize(
    "alarms",
    ['high = "8 cm"\nhigh_low = "7 cm"', 'high = { limit = "8 cm", delay = "2 s" }',
     'high = "8 cm"\npriority = "urgent"', 'high = "8 cm"\ninterlock = { pump_1 = "0 V" }'],
)  # fmt: skip
def test_the_schema_refuses_what_the_reader_does(alarms):
    head = ALARMED.read_text(encoding="utf-8").partition("[alarms.level_1]")[0]
    assert list(faults(tomllib.loads(f"{head}[alarms.level_1]\n{alarms}\n"), SCHEMA))


def test_what_is_left_out(tmp_path):
    text = ALARMED.read_text(encoding="utf-8").partition("[alarms.level_1]")[0]
    own = (
        'high_high = "90 %"\nhigh = "80 %"\nrate = "1 cm/s"\ndeviation = "1 cm"\nflatline = "60 s"'
    )
    found = {
        alarm.kind: alarm
        for alarm in plant_of(tmp_path, f"{text}[alarms.level_1]\n{own}").process.alarms
    }
    assert found[AlarmKind.HIGH_HIGH].priority is Priority.HIGH
    assert found[AlarmKind.HIGH].priority is Priority.MEDIUM
    assert found[AlarmKind.RATE].priority is Priority.LOW
    # 1 % of 20 cm; of what has a small limit a tenth of that.
    assert found[AlarmKind.HIGH].deadband == pytest.approx(0.002)
    assert found[AlarmKind.DEVIATION].deadband == pytest.approx(0.001)
    assert found[AlarmKind.RATE].deadband == pytest.approx(0.001)
    assert (found[AlarmKind.FLATLINE].limit, found[AlarmKind.FLATLINE].on_delay) == (0.0, 60.0)
    assert found[AlarmKind.FLATLINE].moves == {"pump_1": pytest.approx(0.1)}


def test_what_holds_for_all_yields_to_an_alarm_of_its_own(tmp_path):
    text = ALARMED.read_text(encoding="utf-8").partition("[alarms.level_1]")[0]
    own = 'high = "80 %"\nlow = { limit = "10 %", deadband = "1 cm", on_delay = "0 s" }'
    shared = 'deadband = "2 cm"\non_delay = "5 s"\npriority = "low"\nacknowledged = true'
    high, low = plant_of(tmp_path, f"{text}[alarms.level_1]\n{own}\n{shared}").process.alarms
    assert (high.deadband, high.on_delay, high.priority) == (0.02, 5.0, Priority.LOW)
    assert (low.deadband, low.on_delay, low.acknowledged) == (0.01, 0.0, True)


def test_a_flatline_watches_what_reaches_its_measurement(tmp_path):
    """The pump of a tank above does; that of the tank below makes no transmitter stuck."""
    below = """
[tanks.tank_2]
area = "28 cm^2"
height = "20 cm"
[orifices.outlet_2]
source = "tank_2"
destination = "basin"
area = "0.2 cm^2"
[pumps.pump_2]
source = "basin"
destination = "tank_2"
gain = "3.33 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "1 V"
[sensors.level_2]
tank = "tank_2"
range = ["0 cm", "20 cm"]
[alarms.level_2]
flatline = "1 min"
"""
    text = ALARMED.read_text(encoding="utf-8") + below
    edit = ('destination = "basin"\narea = "0.071', 'destination = "tank_2"\narea = "0.071')
    plant = plant_of(tmp_path, text, edit)
    watched = {
        alarm.measurement: set(alarm.moves)
        for alarm in plant.process.alarms
        if alarm.kind is AlarmKind.FLATLINE
    }
    assert watched == {"level_1": {"pump_1"}, "level_2": {"pump_1", "pump_2"}}


def test_a_variant_has_alarms_of_its_own(tmp_path):
    text = ALARMED.read_text(encoding="utf-8")
    text += '[variants.low]\ndescription = "lower"\nalarms.level_1.high_high = "12 cm"\n'
    (tmp_path / "plant.toml").write_text(text, encoding="utf-8")
    plant = cl.load(f"{tmp_path / 'plant.toml'}:low")
    assert plant.process.alarms[0].limit == pytest.approx(0.12)
