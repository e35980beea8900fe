"""Which scores a run of a controller has: limits of its own, and no setpoint to follow."""

from dataclasses import replace

import numpy as np
import pytest

from clepsydra.designs.simc import design_simc
from clepsydra.designs.start_stop_levels import design_start_stop_levels
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.process.reader import load_process
from clepsydra.studies.ranking import rank
from clepsydra.studies.trial import scores_of, tried


def test_saturation_is_counted_at_the_narrower_limits_of_actuator_and_controller() -> None:
    analysis = analyse(load_process("quadruple-tank"))
    designed = design_simc(analysis.model, analysis.pairing)
    scenario = default_scenario(analysis.model)

    def run(**limits: float):
        controller = replace(designed, values=designed.values | limits)
        return Loop(controller, analysis.model).run(scenario)

    narrow = run(low_limit_1=2.8, high_limit_1=3.4, high_limit_2=12.0)
    assert narrow.limits("pump_1") == (2.8, 3.4)
    assert narrow.limits("pump_2") == (0.0, 10.0)
    volts = narrow.values["pump_1"]
    stood = np.sum((volts == 2.8) | (volts == 3.4)) * scenario.sampling_period
    found = scores_of(narrow)
    assert found["time_in_saturation[pump_1]"] == stood > 60.0
    assert volts.min() > 0.0 and volts.max() < 10.0  # nothing of it at the actuator's
    # A limit beyond the actuator's is none: the pump still ends at 10 V.
    above = narrow.values["pump_2"]
    assert found["time_in_saturation[pump_2]"] == np.sum((above <= 0.0) | (above >= 10.0))
    # What the controller does not move has the actuator's.
    left = replace(designed, manipulated=("pump_2", "pump_1"))
    assert replace(narrow, controller=left).limits("pump_1") == (0.0, 10.0)


@pytest.mark.thorough
def test_start_and_stop_have_no_overshoot_and_come_last_where_it_is_asked_for() -> None:
    analysis = analyse(load_process("wet-well:start-stop"))
    model = linearise(analysis.operating_point)
    scenario = default_scenario(analysis.model)
    switches = tried(design_start_stop_levels(model), analysis, model, scenario)
    steps = ("overshoot", "rise_time", "settling_time", "settling_time_noisy")
    assert not [key for key in switches.scores if key.partition("[")[0] in steps]
    assert switches.scores["iae_load[level]"] > 0.0
    first, last = rank((switches, quick_pi(analysis, model, scenario)), ("overshoot",))
    assert (first.controller.name, last.controller.family) == (
        "PI, quick",
        switches.controller.family,
    )
    assert last.mean_error == np.inf and first.mean_error == pytest.approx(1.0)


def quick_pi(analysis, model, scenario):
    controller = replace(design_simc(analysis.model, analysis.pairing), name="PI, quick")
    return tried(controller, analysis, model, scenario)
