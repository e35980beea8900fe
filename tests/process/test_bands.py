"""The band of an averaging level, and load steps of several sizes: as a file gives them."""

import pytest
from refusals import refused
from written_plants import plant_of

import clepsydra as cl
from clepsydra.loop.default_scenario import default_scenario

DRUM = """
name = "drum"
sampling_period = "5 s"
controlled = ["level"]
averaging = ["level"]
manipulated = ["outflow"]

[tanks.drum]
shape = "horizontal cylinder"
diameter = "2 m"
length = "6 m"

[flows.feed]
destination = "drum"
range = ["20 m^3/h", "60 m^3/h"]
nominal = "40 m^3/h"
step = ["10 m^3/h", "-15 m^3/h"]

[flows.outflow]
source = "drum"
range = ["20 m^3/h", "60 m^3/h"]
nominal = "40 m^3/h"

[sensors.level]
tank = "drum"
range = ["0 m", "2.5 m"]
band = ["25 %", "1.5 m"]

[operating_point]
level = "1 m"
"""
AT_REST = 'level = "1 m"'
BAND = 'band = ["25 %", "1.5 m"]'


def load(folder, *edits):
    return plant_of(folder, DRUM, *edits)


def test_ends_are_in_the_unit_of_the_range_or_in_percent_of_it(tmp_path):
    assert load(tmp_path).process.bands == {"level": pytest.approx((0.625, 1.5))}


def test_each_level_has_its_own_band(tmp_path):
    text = DRUM.replace('averaging = ["level"]', 'averaging = ["level", "other"]')
    text = text.replace('controlled = ["level"]', 'controlled = ["level", "other"]')
    text = text.replace('manipulated = ["outflow"]', 'manipulated = ["outflow", "onward"]')
    text = text.replace("[flows.outflow]", '[flows.outflow]\ndestination = "second"')
    text += """other = "50 %"
[tanks.second]
area = "5 m^2"
height = "2 m"
[flows.onward]
source = "second"
range = ["20 m^3/h", "60 m^3/h"]
nominal = "40 m^3/h"
[sensors.other]
tank = "second"
span = ["0 m", "2 m"]
range = ["0 %", "100 %"]
band = ["40 %", "80 %"]
"""
    (tmp_path / "two.toml").write_text(text, encoding="utf-8")
    bands = cl.load(tmp_path / "two.toml").process.bands
    assert bands == {"level": pytest.approx((0.625, 1.5)), "other": pytest.approx((0.4, 0.8))}


@pytest.mark.parametrize(
    ("edit", "key", "value", "expected", "remedy"),
    [
        ('band = ["1.5 m", "0.5 m"]', "band", '["1.5 m", "0.5 m"]',
         "a lower end below the upper end", "exchange or correct them"),
        ('band = ["0.5 m", "2.2 m"]', "band", '["0.5 m", "2.2 m"]',
         "a band between the floor and the rim of drum, 0 to 2 m",
         "correct it, or the height of the tank"),
        ('band = ["30 %", "130 %"]', "band", "130 %",
         "an end of the band from 0 to 2.5 m, the range of level", "stay inside the range"),
        ('band = ["5 l", "1.5 m"]', "band", "5 l",
         "an end of the band of level from 0 to 2.5 m, or in % of its range",
         "'l' is no unit of it: write as in \"1.25 m\""),
        ('band = ["low", "1.5 m"]', "band", "low",
         "an end of the band of level from 0 to 2.5 m, or in % of its range",
         'write as in "1.25 m"'),
        ("band = [0.5, 1.5]", "band", "0.5",
         "an end of the band of level from 0 to 2.5 m, or in % of its range",
         'the unit is missing: write as in "1.25 m"'),
        ('band = "1 m"', "band", "1 m", "the two ends of a band",
         'write as in band = ["30 %", "70 %"]'),
        ('band = ["1.2 m", "1.5 m"]', "operating_point", "1 m",
         "a setpoint within the band of level, 1.2 to 1.5 m", "move it, or widen the band"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_band_has_line_value_and_remedy(
    edit, key, value, expected, remedy, tmp_path
):
    with pytest.raises(cl.InputError) as caught:
        load(tmp_path, (BAND, edit))
    found = caught.value
    text, place = {
        "band": (BAND, "sensors.level.band"),
        "operating_point": (AT_REST, "operating_point.level"),
    }[key]
    line = DRUM.splitlines().index(text) + 1
    assert found.place == f"{tmp_path / 'plant.toml'}, line {line}, {place}"
    assert (str(found.value), found.expected, found.remedy) == (value, expected, remedy)


def test_a_level_that_does_not_average_has_no_band(tmp_path):
    with refused(value='["25 %", "1.5 m"]', expected="no band, since this is none of the levels"):
        load(tmp_path, ('averaging = ["level"]\n', ""))


def test_load_steps_follow_each_other_and_stay_within_the_range(tmp_path):
    loads = [s for s in default_scenario(load(tmp_path).linear).segments if s.kind == "load"]
    assert [3600.0 * s.size for s in loads] == pytest.approx([10.0, -15.0])
    with refused(
        value="-35 m^3/h",
        expected="a step that stays within the range, from where the steps before it lead",
    ):
        load(tmp_path, ("-15 m^3/h", "-35 m^3/h"))
    with refused(value="much", expected="convertible to m^3/s"):
        load(tmp_path, ('"-15 m^3/h"', '"much"'))


def test_load_steps_may_lead_from_one_end_of_the_range_to_the_other(tmp_path):
    ends = load(tmp_path, ('["10 m^3/h", "-15 m^3/h"]', '["20 m^3/h", "-40 m^3/h"]'))
    loads = [s for s in default_scenario(ends.linear).segments if s.kind == "load"]
    assert [3600.0 * s.size for s in loads] == pytest.approx([20.0, -40.0])


def test_an_averaging_level_is_not_studied_without_a_load(tmp_path):
    calm = load(tmp_path, ('step = ["10 m^3/h", "-15 m^3/h"]\n', ""))
    with refused(value="level, and no load step", expected="at least one"):
        default_scenario(calm.linear)


def test_the_setpoint_step_of_a_study_stays_near_the_middle_of_a_narrow_band(tmp_path):
    narrow = load(tmp_path, (BAND, 'band = ["0.9 m", "1.2 m"]'))
    sizes = [default_scenario(p.linear).segments[0].size for p in (narrow, load(tmp_path))]
    assert sizes == pytest.approx([0.1, 0.2])  # half the way to 1.2 m; a tenth of 2.5 m, rounded
    thin = load(tmp_path, (BAND, 'band = ["0.97 m", "1.03 m"]')).linear
    assert default_scenario(thin).segments[0].size == pytest.approx(0.03)  # 1 % at least


def test_a_level_that_rests_outside_of_its_band_is_refused_before_a_study(tmp_path):
    flat = [('averaging = ["level"]', 'averaging = ["level"]\n'), ("\n[operating_point]", "")]
    flat += [('level = "1 m"', ""), (BAND, 'band = ["2 cm", "40 cm"]')]
    with refused(place="operating_point.level", expected="0.02 to 0.4 m", remedy="widen the band"):
        default_scenario(load(tmp_path, *flat).linear)
