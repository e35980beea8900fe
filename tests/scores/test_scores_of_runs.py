"""Which scores a run of a controller has: limits of its own, and no setpoint to follow."""

from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl


def test_saturation_is_counted_at_the_narrower_limits_of_actuator_and_controller() -> None:
    plant = cl.load("quadruple-tank")
    limits = {
        "pump_1.low_limit": "2.8 V",
        "pump_1.high_limit": "3.4 V",
        "pump_2.high_limit": "12 V",
    }
    events = [cl.step("level_1", "+2 V", at="10 s"), cl.step("level_2", "+3 V", at="150 s")]
    narrow = cl.simulate(plant, cl.design.simc(plant).with_values(limits), events)
    assert narrow.limits("pump_1") == (2.8, 3.4)
    assert narrow.limits("pump_2") == (0.0, 10.0)
    volts = narrow.values["pump_1"]
    stood = np.sum((volts == 2.8) | (volts == 3.4)) * plant.process.sampling_period
    assert narrow.scores["time_in_saturation[pump_1]"] == stood > 60.0
    assert volts.min() > 0.0 and volts.max() < 10.0  # nothing of it at the actuator's
    # A limit beyond the actuator's is none: the pump still ends at 10 V.
    above = narrow.values["pump_2"]
    stood = np.sum((above <= 0.0) | (above >= 10.0))
    assert narrow.scores["time_in_saturation[pump_2]"] == stood
    # The limits of a controller are those of what it moves, whichever comes first.
    other = replace(narrow.controller, manipulated=("pump_2", "pump_1"))
    assert replace(narrow, controller=other).limits("pump_1") == (0.0, 10.0)


STARTS_AND_STOPS = """
process = "wet-well:start-stop"

[scenario]
duration = "20 min"
noise = false

[[scenario.setpoint]]
signal = "level"
at = "1 min"
by = "5 %"

[[scenario.load]]
signal = "inflow"
at = "10 min"
by = "5 l/s"

[ranking]
scores = ["overshoot"]

[controllers.switches]
design = "start_stop_levels"

[controllers.quick]
design = "simc"
"""


def test_start_and_stop_have_no_overshoot_and_come_last_where_it_is_asked_for(tmp_path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(STARTS_AND_STOPS, encoding="utf-8")
    first, last = cl.study(path).ranking
    assert (first.controller.name, last.controller.name) == ("quick", "switches")
    steps = ("overshoot", "rise_time", "settling_time", "settling_time_noisy")
    assert not [key for key in last.scores if key.partition("[")[0] in steps]
    assert last.scores["iae_load[level]"] > 0.0
    assert last.mean_error == np.inf and first.mean_error == pytest.approx(1.0)
