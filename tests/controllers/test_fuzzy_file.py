"""Files of fuzzy controllers: every mistake has its line, and units are what they say."""

from dataclasses import replace
from pathlib import Path

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError

TEXT = """title = "A level"
points = 51

[inputs.e]
of = "level_1"
unit = "mV"
gain = 0.002
dead_zone = 5
[inputs.e.sets]
N = { left_shoulder = [-1, 0] }
ZO = { triangle = [-1, 0, 1] }
P = { right_shoulder = [0, 1] }

[inputs.de]
of = "level_1"
quantity = "measurement_rate"
unit = "V/min"
filter_time = "2 s"
range = [-2, 2]
[inputs.de.sets]
N = { gaussian = [-2, 1] }
P = { gaussian = [2, 1] }

[outputs.u]
moves = "pump_2"
action = "increment"
unit = "V/min"
rate_limit = "0.5 V/s"
gain = 3
range = [-1, 1]
[outputs.u.sets]
S = { left_shoulder = [-1, 0] }
M = { trapezoid = [-1, -0.5, 0.5, 1] }
L = { right_shoulder = [0, 1] }

[rules]
down = "if e is N then u is S"
stay = "if e is ZO and (de is N or de is P) then u is M"
up = "if e is P then u is L"
"""
PLANT = cl.load("quadruple-tank")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def controlled(text=TEXT, plant=PLANT):
    Path("a.toml").write_text(text, encoding="utf-8")
    return cl.design.fuzzy(plant, "a.toml", name="mine")


def test_units_and_gains_are_converted_to_the_laws():
    controller = controlled()
    values = controller.values
    assert values["e.gain"] == pytest.approx(2.0)  # 0.002 per mV
    assert values["e.dead_zone"] == pytest.approx(5e-3)
    assert values["de.gain"] == pytest.approx(60.0)  # 1 per V/min, a rate in V/s
    assert values["de.filter_time"] == 2.0
    assert values["pump_2.output_gain"] == pytest.approx(3.0 / 60.0)
    assert values["pump_2.rate_limit"] == 0.5
    assert (values["pump_2.low_limit"], values["pump_2.high_limit"]) == (0.0, 10.0)
    assert controller.manipulated == ("pump_2",) and controller.setpoints == ("level_1",)
    assert controller.initial_state["pump_2.last_output"] == 3.0
    assert controller.initial_state["de.filtered"] == pytest.approx(
        PLANT.point.as_dict()["level_1"]
    )
    assert controller.design == "Written out: 3 rules, centroid on 51 points; A level."
    assert controller.law.description[0] == "down: if e is N then u is S"


def test_each_error_has_the_setpoint_of_its_own_measurement():
    rate = 'of = "level_1"\nquantity = "measurement_rate"\nunit = "V/min"\nfilter_time = "2 s"'
    assert rate in TEXT
    found = controlled(TEXT.replace(rate, 'of = "level_2"\nunit = "V"'))
    assert found.measurements == found.setpoints == ("level_1", "level_2")
    rate_of_another = controlled(TEXT.replace(rate, rate.replace("level_1", "level_2")))
    assert rate_of_another.measurements == ("level_1", "level_2")
    assert rate_of_another.setpoints == ("level_1",)


@pytest.mark.parametrize(("line", "time"), [("", 4.0), ('\nfading_time = "0.5 min"', 30.0)])
def test_what_a_bumpless_start_of_a_position_saves_fades_in_ten_samples_or_as_written(line, time):
    position = TEXT.replace('action = "increment"\nunit = "V/min"', f'unit = "V"{line}')
    plant = cl.Plant(replace(PLANT.process, sampling_period=0.4))
    assert controlled(position, plant).values["pump_2.fading_time"] == time


def test_a_position_is_told_to_have_no_integral_action():
    assert controlled().notes == ()
    text = TEXT.replace('action = "increment"\nunit = "V/min"', 'unit = "V"')
    (note,) = controlled(text).notes
    assert note == "pump_2 has no integral action: a load leaves an offset."


# What is replaced by what, and the message that is answered, from its place on.
MISTAKES = [
    ("points = 51", "points = 1", "a.toml, line 2, points: got 1, expected a whole number from 3"),
    ("points = 51", "points = 51.5", "a.toml, line 2, points: got 51.5, expected a whole number"),
    ("points = 51", "points = true", "a.toml, line 2, points: got 'true', expected a whole number"),
    ("points = 51", "dots = 51", "a.toml, line 2, dots: got 'dots', expected one of title, points"),
    ('unit = "mV"\n', "", "a.toml, line 4, inputs.e.unit: got no unit, expected a unit"),
    ('"mV"', '"mm"', "a.toml, line 6, inputs.e.unit: got '1 mm', expected a quantity convertible"),
    ('of = "level_1"\nunit', 'of = "level_9"\nunit', "a.toml, line 5, inputs.e.of: got 'level_9'"),
    ('of = "level_1"\nunit', 'of = "level_3"\nunit', "a.toml, line 5, inputs.e.of: got 'level_3', "
     "expected for an error, a controlled sensor"),
    ("gain = 0.002", 'gain = "big"', "a.toml, line 7, inputs.e.gain: got 'big', expected a number"),
    ("gain = 0.002", "gain = 1e13", "a.toml, line 7, inputs.e.gain: got 10000000000000.0, expected "
     "what makes"),
    ("dead_zone = 5", "dead_zone = -5", "a.toml, line 8, inputs.e.dead_zone: got -5, expected"),
    ("dead_zone = 5", 'filter_time = "1 s"', "a.toml, line 8, inputs.e.filter_time: got '1 s', "
     "expected a filter of a rate only"),
    ("[-1, 0, 1]", "[-1, 0]", "a.toml, line 11, inputs.e.sets.ZO.triangle: got '[-1, 0]', expected "
     "a list of 3 numbers"),
    ("[-1, 0, 1]", "[1, 0, -1]", "a.toml, line 11, inputs.e.sets.ZO.triangle: got '[1, 0, -1]', "
     "expected numbers in rising order"),
    ("[-1, 0, 1]", '[-1, 0, "x"]', "a.toml, line 11, inputs.e.sets.ZO.triangle: got 'x', expected "
     "a number"),
    ("{ triangle = [-1, 0, 1] }", "{ circle = [-1, 0, 1] }", "a.toml, line 11, "
     "inputs.e.sets.ZO.circle: got 'circle', expected one of left_shoulder"),
    ("{ triangle = [-1, 0, 1] }", "{}", "a.toml, line 11, inputs.e.sets.ZO: got no shape"),
    ("ZO = { triangle = [-1, 0, 1] }", "N = { triangle = [-1, 0, 1] }",
     "a.toml, line 11: got 'N = { triangle = [-1, 0, 1] }', expected"),
    ('"measurement_rate"', '"speed"', "a.toml, line 16, inputs.de.quantity: got 'speed'"),
    ("range = [-2, 2]", "range = [2, -2]", "a.toml, line 19, inputs.de.range: got '[2, -2]'"),
    ("[-2, 1]", "[-2, 0]", "a.toml, line 21, inputs.de.sets.N.gaussian: got '[-2, 0]', expected a "
     "centre, and a width above zero"),
    ('moves = "pump_2"', 'moves = "pump_3"', "a.toml, line 25, outputs.u.moves: got 'pump_3'"),
    ('"increment"', '"absolute"', "a.toml, line 26, outputs.u.action: got 'absolute'"),
    ('unit = "V/min"\nrate', 'unit = "V"\nrate', "a.toml, line 27, outputs.u.unit: got '1 V', "
     "expected a quantity convertible to V/s"),
    ('"0.5 V/s"', '"0 V/s"', "a.toml, line 28, outputs.u.rate_limit: got '0 V/s', expected a rate"),
    ("gain = 3", 'gain = 3\nfading_time = "1 s"', "a.toml, line 30, outputs.u.fading_time: got "
     "'1 s', expected a fading time of a position only"),
    ("range = [-1, 1]\n", "", "a.toml, line 24, outputs.u.range: got no range"),
    ("L = { right_shoulder = [0, 1] }", "L = { right_shoulder = [1.5, 2] }",
     "a.toml, line 34, outputs.u.sets.L: got 'a set outside of the range'"),
    ("L = { right_shoulder = [0, 1] }", "L = { triangle = [0.605, 0.61, 0.615] }",
     "a.toml, line 34, outputs.u.sets.L: got 'a set between two points', expected a set above "
     "zero at one of the 51 points"),
    ("u is L", "u is XL", "a.toml, line 39, rules.up: got 'XL', expected a set of u (S, M, L)"),
    ("e is P then", "x is P then", "a.toml, line 39, rules.up: got 'x', expected an input (e, de)"),
    ("u is L", "v is L", "a.toml, line 39, rules.up: got 'v', expected an output (u)"),
    ("e is P then", "e is then", "a.toml, line 39, rules.up: got 'then after if e is', expected "
     "the name of a set; write as in if e is N"),
    ('up = "if e is P then u is L"', "", "a.toml, line 24, outputs.u: got no rule that fires at "
     "e = 1, de = -2, expected a rule that fires wherever the inputs are; add a rule or widen a "
     "set, since the output would be held there."),
    ("P = { right_shoulder = [0, 1] }", "P = { right_shoulder = [1, 2] }\n",
     "a.toml, line 12, inputs.e.sets.P: got 'a set outside of the range'"),
    ("ZO = { triangle = [-1, 0, 1] }", "ZO = { triangle = [-1, -0.5, 0] }", "a.toml, line 9, "
     "inputs.e.sets: got no rule that fires at e = 0, de = -2 for u, since no set is above zero "
     "there, expected"),
    ('up = "if', "stay = \"if", "a.toml, line 39: got"),
    ("[rules]\n", "[rules]\nup-2 = 7\n", "a.toml, line 37, rules.up-2: got 7, expected a rule"),
    ("outputs.u", "outputs.e", "a.toml, line 4, inputs.e: got 'e', expected a name of its own"),
    ("[outputs.u]", "[outputs.u__v]", "a.toml, line 24, outputs.u__v: got 'u__v', expected a name"),
    (TEXT, "  \n", "a.toml: got an empty file, expected a fuzzy; begin with a copy"),
    (TEXT[TEXT.index("[inputs"):], "", "a.toml, line 1, inputs: got no inputs"),
    (TEXT[TEXT.index("[inputs.e]"):TEXT.index("[outputs.u]")], "[inputs]\n", "a.toml, line 4, "
     "inputs: got 'none', expected a table for each of the inputs"),
    (TEXT[TEXT.index("[rules]"):], "", "a.toml, line 1, rules: got no rules"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), MISTAKES, ids=range(len(MISTAKES)))
def test_a_mistake_is_answered_with_its_line(old, new, message):
    assert TEXT.count(old) >= 1
    with pytest.raises(InputError) as found:
        controlled(TEXT.replace(old, new))
    assert str(found.value).startswith(message), str(found.value)


def test_one_input_is_moved_by_one_output_only():
    second = TEXT[TEXT.index("[outputs.u]") : TEXT.index("[rules]")].replace(
        "outputs.u", "outputs.v"
    )
    text = TEXT.replace("[rules]", second + "[rules]").replace("u is L", "u is L and v is L")
    text = text.replace("u is M", "u is M and v is M").replace("u is S", "u is S and v is S")
    with refused(place="line 25, outputs.u.moves", value="pump_2", expected="each"):
        controlled(text)
    assert controlled(text.replace('moves = "pump_2"', 'moves = "pump_1"', 1)).manipulated == (
        "pump_1",
        "pump_2",
    )


def test_a_file_that_is_no_text_and_a_unit_that_is_none():
    Path("rules.toml").write_bytes(b"\xff\xfe")
    with refused(expected="text in UTF-8", remedy="check that this is a fuzzy file"):
        cl.design.fuzzy(PLANT, "rules.toml")
    with refused(place="line 6, inputs.e.unit", value="1 "):
        controlled(TEXT.replace('"mV"', '"1"'))
