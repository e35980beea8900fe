"""Scripts of a rig: read, refused with their places, done at their times."""

from pathlib import Path

import pytest
from rig_bench import bench

import clepsydra as cl
from clepsydra.rig.instructor import Instructor
from clepsydra.rig.script import read_script
from clepsydra.rig.tag import WIRE_CUT, WIRE_DELAY, WIRE_LOSS

WHOLE = """
[[do]]
at = "1 min"
fail = { level_1 = "dead", pump_2 = "stopped" }
noise = true
[[do]]
at = "30 s"
write = { "level_1.sp" = "7 V", "pump_1.mode" = 0 }
disturb = { inflow_1 = "5 cm^3/s" }
"""


def read(rig, folder, text):
    path = Path(folder, "script.toml")
    path.write_text(text)
    return read_script(path, rig.process, list(rig.table.tags.values()))


def test_it_is_done_in_the_order_of_its_times(tmp_path):
    with bench() as rig:
        actions = read(rig, tmp_path, WHOLE)
        assert [action.at for action in actions] == [30.0, 60.0]
        instructor = Instructor(rig.process, rig.image)
        said = [action.do(rig.table, instructor) for action in actions]
        assert said[1] == "level_1: dead, pump_2: stopped, noise on"
        assert rig.read("level_1.sp").value == 7.0 and rig.read("pump_1.mode").value == 0.0
        assert rig.image.read("inflow_1") == pytest.approx(5e-6)
        assert not rig.read("level_1.pv").good and rig.image.read("pump_2.stopped") == 1.0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no [[do]]"),
        ("[[do]]\n", "no time"),
        ('[[do]]\nat = "1 m"\n', "do[0].at"),
        ('[[do]]\nat = "1 s"\nfial = {}\n', "perhaps 'fail' was meant"),
        ('[[do]]\nat = "1 s"\nfail = { level_9 = "dead" }\n', "level_9"),
        ('[[do]]\nat = "1 s"\nfail = { level_1 = "deaf" }\n', "dead"),
        ('[[do]]\nat = "1 s"\nwrite = { "level_1.pv" = "1 V" }\n', "the plant writes it"),
        ('[[do]]\nat = "1 s"\nwrite = { "level_1.sp" = "1 cm" }\n', "level_1.sp"),
        ('[[do]]\nat = "1 s"\nwrite = { "level_1.sp" = "20 V" }\n', "outside of what"),
        ('[[do]]\nat = "1 s"\nwrite = { "pump_1.mode" = 0.5 }\n', "whole number"),
        ('[[do]]\nat = "1 s"\ndisturb = { inflow = "1 l/min" }\n', "inflow_1"),
        ('[[do]]\nat = "1 s"\nnoise = "on"\n', "true or false"),
        ('[[do]]\nat = "1 s"\nwires = "cut"\n', "delay, loss and cut"),
        ('[[do]]\nat = "1 s"\nwires = { lost = 0.1 }\n', "perhaps 'loss' was meant"),
        ('[[do]]\nat = "1 s"\nwires = { delay = "61 s" }\n', "from 0 to 60 s"),
        ('[[do]]\nat = "1 s"\nwires = { delay = "5 %" }\n', "do[0].wires.delay"),
        ('[[do]]\nat = "1 s"\nwires = { loss = 10 }\n', "from 0 to 100 %"),
        ('[[do]]\nat = "1 s"\nwires = { cut = 1 }\n', "true or false"),
        ("[[do]\n", "line 1"),
    ],
)
def test_what_is_wrong_is_refused_with_its_place(tmp_path, text, said):
    with bench() as rig, pytest.raises(cl.InputError) as refused:
        read(rig, tmp_path, text)
    assert said in str(refused.value) and "script.toml" in str(refused.value)


def test_wires_are_slow_lossy_and_cut_and_what_is_left_out_stays(tmp_path):
    text = """
[[do]]
at = "1 s"
wires = { delay = "200 ms", loss = "10 %", cut = true }
[[do]]
at = "2 s"
wires = { cut = false }
[[do]]
at = "3 s"
wires = { delay = "0 s", loss = 0 }
"""
    with bench() as rig:
        instructor = Instructor(rig.process, rig.image)
        said, found = [], []
        for action in read(rig, tmp_path, text):
            said.append(action.do(rig.table, instructor))
            found.append([rig.image.read(name) for name in (WIRE_DELAY, WIRE_LOSS, WIRE_CUT)])
        assert found == [[0.2, 0.1, 1.0], [0.2, 0.1, 0.0], [0.0, 0.0, 0.0]]
        assert said == [
            "answers 0.2 s late, 10 % of requests lost, cable pulled",
            "cable plugged in",
            "answers 0 s late, 0 % of requests lost",
        ]
