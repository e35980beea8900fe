"""What keeps a plant from the operating point that is asked for, told in its own flows."""

import pytest
from brine_station import STATION
from refusals import refused
from written_plants import plant_of

import clepsydra as cl
from clepsydra import NoEquilibrium

DEMAND = 'nominal = "20 l/min"'
KV = 'kv = "0.6 m^3/h"'
GAIN = 'gain = "0.4 l/(min %)"'
BRINE = '"200 g/l"'
PUMP = "water_pump would have to be 120 %, outside its range from 0 % to 100 %: at 100 % it gives "
PUMP += "40 l/min, and 48 l/min are needed"


def reasons(folder, *edits):
    with pytest.raises(NoEquilibrium) as caught:
        _ = plant_of(folder, STATION, *edits).point
    return caught.value


def test_pump_and_valve_that_are_too_small_are_told_in_flows(tmp_path):
    """60 l/min take 48 l/min of water and 12 l/min of brine."""
    found = reasons(tmp_path, (DEMAND, 'nominal = "60 l/min"'))
    assert found.reasons == (
        PUMP,
        "brine_valve would have to be 120 %, outside its range from 0 % to 100 %: at 100 % it "
        "gives 0.6 m³/h, and 0.72 m³/h are needed",
    )
    assert found.place.endswith("plant.toml, line 35, operating_point")


def test_beyond_the_range_of_a_curved_valve_no_signal_is_made_up(tmp_path):
    """With a lag of the pump and a stroke of the valve, which stand where they are sent."""
    slow = 'characteristic = "equal percentage"\nstroke_time = "20 s"'
    edits = (KV, f"{KV}\n{slow}"), (GAIN, f'{GAIN}\nlag = "3 s"')
    found = reasons(tmp_path, (DEMAND, 'nominal = "60 l/min"'), *edits)
    assert found.reasons == (
        PUMP,
        "brine_valve would have to go beyond 100 %, the end of its range: at 100 % it gives "
        "0.6 m³/h, and 0.72 m³/h are needed",
    )


def test_what_flows_in_would_have_to_flow_back(tmp_path):
    """Of 30 l/min of 40 g/l that come, 10 l/min are too much."""
    feed = '[flows.feed]\ndestination = "blender"\nrange = ["0 l/min", "50 l/min"]\n'
    feed += 'nominal = "30 l/min"\nconcentration = { salt = "40 g/l" }\n[flows.demand]'
    found = reasons(tmp_path, ("[flows.demand]", feed))
    assert found.reasons == (
        "water_pump would have to be -20 %, outside its range from 0 % to 100 %: 8 l/min would "
        "have to flow back through it",
        "brine_valve would have to be -20 %, outside its range from 0 % to 100 %: 0.12 m³/h would "
        "have to flow back through it",
    )


@pytest.mark.parametrize("demand", ["20", "60"])
def test_no_mixture_is_stronger_than_the_strongest(tmp_path, demand):
    edits = (BRINE, '"30 g/l"'), (DEMAND, f'nominal = "{demand} l/min"')
    assert reasons(tmp_path, *edits).reasons == (
        "strength asks for 40 g/l of salt in blender, but no mixture of 0 g/l (water) and 30 g/l "
        "(brine), which is what flows in, gives 40 g/l",
    )


def test_a_mixture_may_be_as_strong_as_the_strongest(tmp_path):
    """Then no water is needed; 20 l/min of brine are twice what the valve lets through."""
    (only,) = reasons(tmp_path, (BRINE, '"40 g/l"')).reasons
    assert "brine_valve would have to be 200 %" in only


def test_evaporation_makes_stronger_than_any_mixture(tmp_path):
    edits = (BRINE, '"30 g/l"'), ('height = "1.5 m"', 'height = "1.5 m"\nevaporation = "5 mm/d"')
    assert all("mixture" not in words for words in reasons(tmp_path, *edits).reasons)


def test_a_gain_without_its_percent_is_shown_on_its_line(tmp_path):
    """16 l/min of water are needed, and 0.4 l/min at 100 % are a hundredth of what was meant."""
    found = reasons(tmp_path, (GAIN, 'gain = "0.4 l/min"'))
    words = "at 100 % it gives 0.4 l/min, and 16 l/min are needed ("
    hint = "line 16, pumps.water_pump.gain: a gain in l/min is the flow at 100 %; that of each "
    hint += "percent is in l/(min %))"
    assert words in found.reasons[0]
    assert found.reasons[0].endswith(hint)
    # Of half the flow that is needed no unit is missing.
    (small,) = reasons(tmp_path, (GAIN, 'gain = "8 l/min"')).reasons
    assert small.endswith("at 100 % it gives 8 l/min, and 16 l/min are needed")


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (
            (GAIN, 'gain = "16.4 l/min"'),
            "water_pump rests at 97.56 %, close to the end of its range at 100 %, where a "
            "controller can hardly raise it: it gives 16 l/min of at most 16.4 l/min",
        ),
        (
            (KV, 'kv = "12 m^3/h"'),
            "brine_valve rests at 2 %, close to the end of its range at 0 %, where a controller "
            "can hardly lower it: it gives 0.24 m³/h of at most 12 m³/h",
        ),
    ],
)
def test_an_operating_point_without_room_is_warned_of(tmp_path, edit, words):
    plant = plant_of(tmp_path, STATION, edit)
    (said,) = plant.point.warnings
    assert said.startswith(f"{words}; move the operating point")
    assert f"! {words}" in " ".join(str(cl.analyse(plant)).split())
    assert plant_of(tmp_path, STATION).point.warnings == ()


def test_a_study_says_that_there_is_no_room(tmp_path):
    plant = plant_of(tmp_path, STATION, (GAIN, 'gain = "16.4 l/min"'))
    said = " ".join(str(cl.study(plant, [cl.design.simc(plant)])).split())
    assert "! water_pump rests at 97.56 %, close to the end of its range at 100" in said


def test_a_value_out_of_range_is_told_in_the_unit_of_its_signal(tmp_path):
    plant = plant_of(tmp_path, STATION, ('range = ["0 m", "1.5 m"]', 'range = ["0 cm", "150 cm"]'))
    beyond = plant.at(outputs={"level": "160 cm", "strength": "40 g/l"})
    with refused(
        place="operating point, outputs.level",
        value="160 cm",
        expected="a value from 0 to 150 cm",
        remedy="choose a value inside the range of level",
    ):
        _ = beyond.point


DRAINED = """
name = "drained"
sampling_period = "5 s"
controlled = ["level"]
[reservoirs.works]
[tanks.sump]
diameter = "1 m"
height = "1 m"
[flows.feed]
destination = "sump"
range = ["0 l/min", "40 l/min"]
nominal = "20 l/min"
[pumps.drain]
source = "sump"
destination = "works"
gain = "0.4 l/(min %)"
range = ["0 %", "100 %"]
suction_level = "5 cm"
[sensors.level]
tank = "sump"
range = ["0 m", "1 m"]
[operating_point]
level = "6 cm"
"""


def test_nothing_rests_where_a_pump_would_draw_air(tmp_path):
    assert plant_of(tmp_path, DRAINED).point.as_dict()["drain"] == pytest.approx(0.5)
    with pytest.raises(NoEquilibrium, match=r"nothing would rest there, since .*drain"):
        _ = plant_of(tmp_path, DRAINED, ("6 cm", "4 cm")).point
