"""What `cl.run_rig` refuses before anything is started, and what a rig that only shows offers."""

import pytest
from refusals import refused

import clepsydra as cl


@pytest.mark.parametrize(
    ("place", "given"),
    [
        ("rig, fail_safe", {"fail_safe": {"pump_1": "20 V"}}),
        ("rig, fail_safe", {"fail_safe": {"pump_1": "-1 V"}}),
        ("rig, fail_safe", {"fail_safe": {"level_1": "1 V"}}),
        ("rig, silence", {"silence": "0 s"}),
        ("rig, silence", {"silence": "40 ms", "speed": 20.0}),
        ("rig, speed", {"speed": 2e4}),
        ("rig, doors", {"doors": cl.Doors(["modbus-rtu"])}),
        ("rig, host", {"doors": cl.Doors(["modbus"], host="0.0.0.0")}),
    ],
)
def test_it_is_refused_and_nothing_is_begun(tmp_path, place, given):
    folder = tmp_path / "rig"
    with refused(place=place):
        cl.run_rig("quadruple-tank", folder=folder, **given)
    assert not folder.exists()


def test_a_silence_of_one_sample_is_long_enough(tmp_path):
    running = cl.run_rig("quadruple-tank", folder=tmp_path, silence="50 ms", speed=20.0)
    assert running.settings.plant.silence == 0.05


def test_through_a_door_that_takes_nothing_every_tag_is_shown_as_the_plants(tmp_path):
    pytest.importorskip("asyncua")
    for read_only, writers in ((True, {"plant"}), (False, {"plant", "controller", "operator"})):
        doors = cl.Doors(["opc-ua"], read_only=read_only)
        (door,) = cl.run_rig("quadruple-tank", folder=tmp_path, doors=doors).settings.doors
        assert {tag.writer.value for tag in door.tags} == writers
