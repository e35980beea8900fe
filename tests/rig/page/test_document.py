"""The page of a running rig as a file, and what it is told of what it cannot see."""

import json
import re
from pathlib import Path

import pytest
from rig_bench import bench

import clepsydra as cl
from clepsydra.laboratory.rig import Rig
from clepsydra.rig.assembly import plant_settings
from clepsydra.rig.doors.page.document import attached_text, delay_places
from clepsydra.rig.doors.page.door import PageDoor
from clepsydra.rig.doors.page.opening import page_door
from clepsydra.rig.tags import tags_of

DELAYED = Path(__file__).parents[2] / "dead-time.toml"
#: Of that file: outlet [m²], tank [m²], delay and period [s], and the flow at rest [m³/s].
OUTLET, TANK, DELAY, PERIOD, REST = 0.3e-4, 100e-4, 5.0, 2.0, 3e-3 / 60
GRAVITY = 9.81


def test_what_comes_out_of_a_delay_is_what_ran_into_it_before():
    with bench(DELAYED) as plant:
        (place,) = delay_places(plant.settings)
        plant.image.write("feed.command", 0.0)
        found = []
        for _ in range(8):
            plant.step()
            found.append(plant.image.remembered()[1][place])
    # A tank that drains through an orifice loses flow at a constant rate, by Torricelli.
    slope = OUTLET**2 * GRAVITY / TANK
    after = [max(0.0, PERIOD * sample - DELAY) for sample in range(1, 9)]
    assert found == pytest.approx([REST - slope * time for time in after], rel=1e-9)


@pytest.fixture(scope="module")
def rig():
    plant = cl.load("quadruple-tank")
    bench = Rig(plant.linear, [cl.design.simc(plant)])
    return bench, plant_settings(bench, speed=1.0, fail_safe={})


def test_the_door_gets_the_page_that_was_written_for_it(rig, tmp_path):
    bench, settings = rig
    door = page_door(bench, settings, tags_of(bench.point), tmp_path / "rig", speed=4.0)
    text = door.page.read_text("utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])
    assert data["attached"] == {"plant": settings.layout.plant, "speed": 4.0}
    assert door.plant == settings.layout.plant
    assert {cell.name for cell in door.cells} <= set(settings.layout.written)
    assert door.token == ""
    # A rig that is started again counts anew, whatever its samples are called.
    assert door.start != PageDoor(door.page, door.plant, door.cells).start


def test_a_page_holds_neither_what_cannot_be_done_nor_a_token(rig, tmp_path):
    bench, settings = rig
    door = page_door(bench, settings, tags_of(bench.point), tmp_path, host="0.0.0.0", port=0)
    text = door.page.read_text("utf-8")
    assert door.token
    assert door.token not in text
    for part in ('id="laws"', 'id="runs"'):
        assert part not in text


@pytest.mark.thorough
@pytest.mark.parametrize("name", [each.name for each in cl.catalogue()])
def test_every_process_has_its_page(name):
    plant = cl.load(name)
    bench = Rig(plant.linear, [cl.design.simc(plant)])
    settings = plant_settings(bench, speed=1.0, fail_safe={})
    text = attached_text(bench, settings, speed=1.0)
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])
    shown = {*data["measurements"], *data["inputs"], *data["disturbances"], *data["levels"]}
    assert shown <= {*settings.layout.columns}
