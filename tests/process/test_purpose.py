"""The key "averaging": what a tank is there for."""

import re

import pytest
from written_plants import plant_of

from clepsydra import InputError
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process

BASIN = """
name = "basin"
sampling_period = "1 min"
manipulated = ["outflow"]
controlled = ["level"]

[components.salt]
range = ["0 g/l", "10 g/l"]

[reservoirs.works]

[tanks.basin]
area = "100 m^2"
height = "4 m"

[flows.inflow]
destination = "basin"
range = ["0 l/s", "20 l/s"]
nominal = "5 l/s"
concentration = { salt = "2 g/l" }

[pumps.outflow]
source = "basin"
destination = "works"
gain = "1 l/(s V)"
range = ["0 V", "10 V"]

[sensors.level]
tank = "basin"
range = ["0 m", "4 m"]

[sensors.strength]
tank = "basin"
component = "salt"
range = ["0 g/l", "10 g/l"]

[operating_point]
level = "2 m"
"""


def load(text: str, folder):
    return plant_of(folder, text).process


def with_line(line: str, text: str = BASIN) -> str:
    return text.replace("controlled = ", f"{line}\ncontrolled = ", 1)


def test_only_the_equalisation_tank_of_the_catalogue_averages():
    found = {name: load_process(name).averaging for name in catalogue_names()}
    assert {name for name, averaging in found.items() if averaging} == {"equalisation-tank"}
    assert found["equalisation-tank"] == ("level",)


def test_a_level_or_a_volume_with_a_pump_behind_it_may_average(tmp_path):
    assert load(BASIN, tmp_path).averaging == ()
    assert load(with_line('averaging = ["level"]'), tmp_path).averaging == ("level",)
    volume = BASIN.replace(
        '[sensors.level]\ntank = "basin"\nrange = ["0 m", "4 m"]',
        '[sensors.level]\ntank = "basin"\nquantity = "volume"\nrange = ["0 m^3", "400 m^3"]',
    ).replace('level = "2 m"', 'level = "200 m^3"')
    assert load(with_line('averaging = ["level"]', volume), tmp_path).averaging == ("level",)


def test_a_variant_may_say_so(tmp_path):
    text = BASIN + '\n[variants.buffer]\naveraging = ["level"]\n'
    assert load(text, tmp_path).averaging == ()
    assert load_process(tmp_path / "plant.toml", "buffer").averaging == ("level",)


@pytest.mark.parametrize(
    ("line", "change", "message"),
    [
        ('averaging = "level"', {}, "expected a list of controlled levels"),
        ("averaging = []", {}, "expected a list of controlled levels"),
        (
            'averaging = ["levle"]',
            {},
            "a controlled level or volume of a tank; perhaps 'level' was",
        ),
        ('averaging = ["strength"]', {}, "got 'strength', expected a controlled level or volume"),
        ('averaging = ["level", "level"]', {}, "expected every name once"),
        (
            'averaging = ["strength"]',
            {'controlled = ["level"]': 'controlled = ["strength"]'},
            "no such key, since no level or volume of a tank is controlled",
        ),
        (
            'averaging = ["level"]',
            {
                'manipulated = ["outflow"]': 'manipulated = ["inflow"]',
                'range = ["0 V", "10 V"]': 'range = ["0 V", "10 V"]\nnominal = "5 V"',
            },
            "whose outflow a controller moves; none draws from basin",
        ),
    ],
)
def test_a_mistake_is_answered_with_its_line_and_a_remedy(line, change, message, tmp_path):
    text = with_line(line)
    for old, new in change.items():
        assert old in text
        text = text.replace(old, new)
    with pytest.raises(InputError) as refusal:
        load(text, tmp_path)
    said = str(refusal.value)
    number = text.splitlines().index(line) + 1
    assert re.search(rf"plant\.toml, line {number}, averaging: got ", said), said
    assert message in said, said
