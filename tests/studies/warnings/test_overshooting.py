"""What ends an overshoot is judged by the levels whose overshoot is told."""

import re
from dataclasses import replace

import clepsydra as cl
from clepsydra.studies.warnings.overshooting import overshooting


def ramp_of(run, model):
    (remark,) = overshooting(run, model, run.scores)
    seconds, left = re.search(r"ramp the setpoint over (\d+) s: (\d+) %", str(remark)).groups()
    assert int(left) <= 10
    return float(seconds)


def test_a_level_that_averages_asks_for_no_longer_ramp():
    """Pole placement overshoots level_1 and level_2, of which the second takes longer to ramp."""
    plant = cl.load("quadruple-tank")
    run = cl.simulate(plant, cl.design.pole_placement(plant))
    averaging = replace(run, process=replace(run.process, averaging=("level_2",)))
    assert ramp_of(averaging, plant.measured) < ramp_of(run, plant.measured)
