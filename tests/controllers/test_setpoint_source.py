"""The choice of a setpoint: local, remote, or what stands for neither."""

import math

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import PidForm, Signal
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.studies.file.reader import read_study

LEVEL = Signal("level_1", "V", low=0.0, high=16.0, initial=5.0)
PUMP = Signal("pump_1", "V", low=0.0, high=10.0, initial=3.0)
LOCAL, REMOTE = 6.0, 7.5
STUDY = """process = "equalisation-tank"
[controllers.a.loops.level]
measurement = "level"
output = "outflow"
actions = "PI"
action = "direct"
gain = "2 %/%"
integral_time = "1 h"
remote_setpoint = true
"""


def law():
    return multiloop_pid_law([LEVEL], [PUMP], PidForm(remote_setpoint=True))


class Loop:
    def __init__(self, source):
        self.law = law()
        self.state = {s.name: s.initial for s in self.law.state} | {
            "level_1.working_setpoint": 5.0, "level_1.last_setpoint_source": float(source),
        }  # fmt: skip

    def scan(self, source):
        inputs = {signal.name: signal.initial for signal in self.law.inputs}
        inputs |= {
            "level_1.sp": LOCAL,
            "level_1.remote_setpoint": REMOTE,
            "level_1.setpoint_source": source,
        }
        following, _, _ = self.law.function(
            [self.state[entry.name] for entry in self.law.state],
            [inputs[signal.name] for signal in self.law.inputs],
            [parameter.initial for parameter in self.law.parameters],
        )
        names = [entry.name for entry in self.law.state]
        self.state = dict(zip(names, np.array(following).ravel().tolist(), strict=True))
        return self.state["level_1.working_setpoint"], self.state["level_1.last_setpoint_source"]


@pytest.mark.parametrize("last", [0, 1])
@pytest.mark.parametrize("wrong", [2.0, -1.0, 0.5, math.nan, math.inf])
def test_what_stands_for_no_source_leaves_the_last_one(last, wrong):
    loop = Loop(last)
    expected = ((LOCAL, 0.0), (REMOTE, 1.0))
    for _ in range(3):
        assert loop.scan(wrong) == expected[last]
    assert loop.scan(1.0) == expected[1]
    assert loop.scan(wrong) == expected[1]
    assert loop.scan(0.0) == expected[0]
    assert loop.scan(wrong) == expected[0]


def test_the_remembered_source_fits_into_single_precision(tmp_path):
    """Its input may be any integer of 32 bits; what is remembered of it holds in 24.

    What may not is refused when single precision is printed.
    """
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    study = read_study(tmp_path / "study.toml")
    plant = cl.load("equalisation-tank")
    controller = study.controllers[0].make(study.analysis, plant.linear)
    exported = cl.export(controller, plant, tmp_path, to="c", precision="single")
    assert any("last_setpoint_source" in file.read_text() for file in exported.files)
