"""The step of both references of Tables 5 and 6 from empty tanks, without the pumps' noise."""

from __future__ import annotations

from functools import partial

from clepsydra.linear.analysis import analyse
from clepsydra.papers.contest import Contest, Contests
from clepsydra.papers.four_tank_laboratory.controllers import KINDS, at_the_simulator
from clepsydra.papers.four_tank_laboratory.margins import NAMES
from clepsydra.papers.four_tank_laboratory.set_ups import SET_UPS, SetUp, plant
from clepsydra.papers.four_tank_laboratory.simulator import stretch_of, target_of

WORDS = (
    "Both references step from empty tanks to 60 %, as in Tables 5 and 6, but without the noise of "
    "the pumps. The report prints no controllers: these are designed by the rules of its course in "
    "volts, and run as its simulator runs them, with the same numbers in percent, at three times "
    "the gain and without anti-windup."
)


def contests() -> Contests:
    """Return the step of both set-ups, in the percent of the simulator."""
    return {f"{each.phase.capitalize()}, every 50 ms": partial(_contest, each) for each in SET_UPS}


def _contest(set_up: SetUp) -> Contest:
    process = plant(set_up, "percent")
    targets = {name: target_of(process, name) for name in process.controlled}
    published = {NAMES[kind]: at_the_simulator(set_up, kind, process) for kind in KINDS}
    analysis = analyse(process, outputs=targets)
    return Contest(analysis, targets, stretch_of(set_up), published, empty=True)
