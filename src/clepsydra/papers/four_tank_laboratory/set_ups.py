"""The two set-ups of the laboratory: their processes, models and printed numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.printed import Printed
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

Units = Literal["percent", "volts"]
#: Those of the report; those of the lower tanks fitted to its manual control, with its upper ones;
#: and the upper ones as much smaller as the lower ones, which those levels leave open.
Holes = Literal["report", "lower fitted", "fitted"]
Noise = Literal["none", "three deviations", "one deviation"]

#: Level that counts as 100 %, and voltage of a pump that does.
FULL_LEVEL, FULL_VOLTAGE = 25.0, 15.0  # cm, V
#: Cross-section of every tank, acceleration of gravity.
AREA, GRAVITY = 15.5179, 981.0  # cm², cm/s²
#: k_c [V/cm], k [cm³/(s V)].
SENSOR_GAIN, PUMP_GAINS = 0.2, PRINTED.numbers("Exercise 2.1.7", "k1", "k2")
#: Standard deviation of the pumps' flow, in shares of that of the catalogue: there the simulator's
#: 30 % are three of them.
DEVIATIONS: dict[Noise, float] = {"none": 0.0, "three deviations": 1.0, "one deviation": 3.0}
#: The phase margin of every decentralised loop [rad].
PHASE_MARGIN = np.pi / 3.0


@dataclass(frozen=True)
class SetUp:
    """One of the two ways in which the valves can stand."""

    phase: str
    process: str
    course_levels: tuple[float, ...]  # around which the course's model is linear [cm]
    pairing: tuple[tuple[str, str], ...]
    crossover: float  # [rad/s]
    level_table: str  # where levels and voltages are printed
    hole_places: tuple[str, str, str, str]  # where the equation of the hole of each tank stands

    @property
    def split(self) -> float:
        """γ of both valves."""
        return PRINTED["Exercise 2.1.6", f"γ1 and γ2, {self.phase}"].value

    @property
    def voltages(self) -> tuple[float, float]:
        """Of Table 1 or 2 [V]."""
        both = PRINTED[self.level_table, "u1 and u2"].value
        return both, both

    @property
    def levels(self) -> tuple[Printed, ...]:
        """Of Table 1 or 2 [cm]."""
        return tuple(PRINTED[self.level_table, f"h{tank}"] for tank in (1, 2, 3, 4))

    @property
    def holes(self) -> tuple[Printed, ...]:
        """Of (22) to (25) [cm²]."""
        places = enumerate(self.hole_places, start=1)
        return tuple(PRINTED[place, f"a{tank}, {self.phase}"] for tank, place in places)


MINIMUM = SetUp(
    phase="minimum phase",
    process="laboratory-four-tanks",
    course_levels=(18.0, 18.0, 14.0, 19.0),
    pairing=(("level_1", "pump_1"), ("level_2", "pump_2")),
    crossover=0.1,
    level_table="Table 1",
    hole_places=("(24)", "(24)", "(22)", "(23)"),
)
NON_MINIMUM = SetUp(
    phase="non-minimum phase",
    process="laboratory-four-tanks-nonminimum-phase",
    course_levels=(17.0, 20.0, 7.5, 7.0),
    pairing=(("level_1", "pump_2"), ("level_2", "pump_1")),
    crossover=0.02,
    level_table="Table 2",
    hole_places=("(25)", "(25)", "(25)", "(25)"),
)
SET_UPS = (MINIMUM, NON_MINIMUM)


@cache
def plant(set_up: SetUp, units: Units = "volts", holes: Holes = "report") -> Process:
    """Return the process of a set-up."""
    if holes == "lower fitted":
        areas = ("outlet_3.area", "outlet_4.area")
        upper = {name: plant(set_up, units).signal(name).initial for name in areas}
        return plant(set_up, units, "fitted").with_parameters(upper)
    return load_process(f"{set_up.process}:{holes},{units}")


@cache
def course_model(set_up: SetUp, units: Units = "volts") -> LinearModel:
    """Return the linear model around the levels of the course, with the holes of the report.

    The course gives the levels; that nothing rests at them exactly does not matter for the time
    constants (10), which depend on the levels alone.
    """
    process = plant(set_up, units)
    state, rest = np.array(set_up.course_levels) / 100.0, find_equilibrium(process)
    point = OperatingPoint.at(process, state, rest.inputs, rest.disturbances)
    return linearise(point).select(outputs=process.controlled)
