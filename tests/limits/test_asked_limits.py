"""What may be asked of a limit, and what is refused or has none."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra.limits.replay import replay

TANK = Path(__file__).parents[1] / "one-tank.toml"
STEP = [cl.step("level_1", "+1 V", at="1 s")]
PATIENT = Path(__file__).parents[1] / "dead-time.toml"


def test_bounds_the_wrong_way_round_are_refused():
    with refused(
        place="limit, within.pump_1", value="8 V to 2 V", expected="below the upper",
        remedy="exchange",
    ):  # fmt: skip
        cl.limit("quadruple-tank", STEP, within={"pump_1": ("8 V", "2 V")})


def test_bounds_that_do_not_hold_the_plant_at_rest_are_refused():
    with refused(place="limit, within.pump_1", expected="3 V to 3.5", remedy="widen"):
        cl.limit("quadruple-tank", STEP, within={"pump_1": ("0 V", "3.2 V")})


def test_bounds_of_what_is_no_input_are_refused():
    with refused(place="limit, within", value="pump_3", remedy="pump_"):
        cl.limit("quadruple-tank", STEP, within={"pump_3": ("0 V", "1 V")})


def test_a_setpoint_without_equilibrium_is_refused():
    with refused(
        place="limit, step of level_1", value="1 V", expected="can rest", remedy="smaller"
    ):
        cl.limit("quadruple-tank", [cl.step("level_1", to="1 V", at="1 s")])


def test_an_output_that_no_input_moves_is_refused(tmp_path):
    """A tank beside the plant that only a stream from outside fills."""
    beside = """
[tanks.tank_2]
area = "28 cm^2"
height = "20 cm"

[orifices.outlet_2]
source = "tank_2"
destination = "basin"
area = "0.071 cm^2"

[flows.stream]
destination = "tank_2"
range = ["0 cm^3/s", "9 cm^3/s"]
nominal = "5 cm^3/s"

[pumps.pump_2]
source = "basin"
destination = "tank_1"
gain = "3.33 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "0.5 V"

[sensors.level_2]
tank = "tank_2"
range = ["0 cm", "20 cm"]
"""
    text = TANK.read_text("utf-8").replace('["level_1"]', '["level_1", "level_2"]') + beside
    (tmp_path / "two.toml").write_text(text, "utf-8")
    step = [cl.step("level_2", "+1 cm", at="1 s")]
    with refused(place="limit, step of level_2", value="level_2", expected="some input moves"):
        cl.limit(tmp_path / "two.toml", step, duration="10 min")


def test_events_without_a_setpoint_step_are_refused():
    with refused(place="limit, events", expected="at least one", remedy="cl.step"):
        cl.limit("quadruple-tank", [cl.disturbance("inflow_1", "+1 cm^3/s", at="1 s")])


@pytest.mark.parametrize(
    ("plant", "reason"),
    [
        ("equalisation-tank", "averages the flow"),
        ("wet-well", "a switch decides"),
    ],
)
def test_an_event_without_a_limit_says_why(plant, reason):
    found = cl.limit(plant, [cl.step("level", "+1 %", at="1 min")], duration="1 h")
    assert not found.found and reason in found.refused[0].reason
    assert reason in str(found)


def test_a_search_that_the_simulation_contradicts_gives_no_number(monkeypatch):
    def doubled(*given):
        found = replay(*given)
        return replace(found, index=2.0 * found.index)

    monkeypatch.setattr("clepsydra.limits.limit.replay", doubled)
    found = cl.limit("three-tanks", [cl.step("level_3", "+1 cm", at="1 min")], duration="10 min")
    assert not found.found and "quite another error" in found.refused[0].reason


def test_friction_has_no_limit(tmp_path):
    """Where a stem stands depends on where it came from."""
    text = TANK.read_text("utf-8").partition("[pumps.pump_1]")
    valve = """
[valves.valve_1]
source = "basin"
destination = "tank_1"
kv = "0.1 m^3/h"
pressure = "1 bar"
range = ["0 %", "100 %"]
nominal = "20 %"
backlash = "2 %"
"""
    sensor = text[2].partition("[sensors")
    (tmp_path / "it.toml").write_text(text[0] + valve + "".join(sensor[1:]), "utf-8")
    found = cl.limit(tmp_path / "it.toml", [cl.step("level_1", "+1 cm", at="1 s")])
    assert "friction" in found.refused[0].reason


def test_no_course_trips_a_pump_that_it_could(tmp_path):
    """With a trip in the way of the quickest course the limit is higher, and the level below it."""
    free = TANK.read_text("utf-8")
    path = tmp_path / "it.toml"
    found = []
    for trip in ("", 'trip_above = { tank_1 = "6.3 cm" }\nhysteresis = "0.5 cm"\n'):
        path.write_text(free.replace('nominal = "1.5 V"\n', f'nominal = "1.5 V"\n{trip}'), "utf-8")
        plant = cl.load(path)
        step = [cl.step("level_1", "+0.5 cm", at="1 s")]
        found.append(cl.limit(plant, step, duration="10 min").found[0])
    assert all(each.accepted for each in found)
    assert np.max(found[1].best.values["tank_1.level"]) < 0.063


def test_dead_time_is_waited_for_and_no_longer():
    """What leaves the channel changes 5 s after what enters it, whatever the input does."""
    (found,) = cl.limit(PATIENT, [cl.step("level_2", "+1 cm", at="2 s")], duration="30 min").found
    level = found.best.values["tank_2.level"]
    assert np.ptp(level[:3]) < 1e-9 < level[6] - level[0]
    assert found.accepted


def test_an_overshoot_that_is_not_allowed_is_not_there():
    step = [cl.step("level_3", "+1 cm", at="10 s")]
    free, held = (
        cl.limit("three-tanks", step, overshoot=allowed).found[0] for allowed in (True, False)
    )
    over = [np.max(each.best.values["tank_3.level"]) - each.event.setpoints[-1, 0]
            for each in (free, held)]  # fmt: skip
    assert over[0] > 1e-6 > over[1]
    assert held.index > free.index


def test_a_run_of_another_scenario_is_no_multiple_of_a_limit():
    plant = cl.load("quadruple-tank")
    found = cl.limit(plant, STEP, duration="10 min")
    controller = cl.design.simc(plant)
    runs = [
        cl.simulate(plant, controller, [cl.step("level_1", by, at="1 s")], duration=duration)
        for by, duration in (("+1 V", "10 min"), ("+2 V", "10 min"), ("+1 V", "5 min"))
    ]
    same, larger, shorter = map(found.times, runs)
    assert same > 1.0 and larger is None and shorter is None
