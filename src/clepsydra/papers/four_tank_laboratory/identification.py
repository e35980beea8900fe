"""Exercises 2.1.7 and 2.1.8: the gains of the pumps and the holes, as the report finds them."""

from __future__ import annotations

import numpy as np

from clepsydra.identification.orifice_areas import orifice_areas_at_rest
from clepsydra.identification.pump_gains import pump_gain
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.set_ups import (
    AREA,
    GRAVITY,
    MINIMUM,
    PUMP_GAINS,
    SET_UPS,
    SetUp,
    plant,
)
from clepsydra.papers.four_tank_laboratory.simulator import by_hand
from clepsydra.papers.four_tank_laboratory.words import SIMULATOR
from clepsydra.papers.printed import short
from clepsydra.papers.row import Row, Rows

#: The report prints no g; with this one, and with any from 979.81 to 980.07, all eight holes agree.
GRAVITY_OF_HOLES = 980.0  # cm/s²


def run() -> Found:
    """Find gains and holes from levels, as the report does."""
    yield from _gains()
    for set_up in SET_UPS:
        yield from (*_areas(set_up), *_levels(set_up))
    yield _tank_of_23()


def _gains() -> Rows:
    volts, duration = MINIMUM.voltages[0], 10.0
    runs = by_hand(MINIMUM, (volts, volts), duration=duration, plugged=True, every=1)
    for pump in (1, 2):
        found = [
            1e6 * pump_gain(runs.time, 0.01 * level, np.full(len(level), volts), AREA * 1e-4)[0]
            for level in runs.levels[pump - 1]
        ]
        mean, error = float(np.mean(found)), float(np.std(found, ddof=1) / np.sqrt(len(found)))
        line = PRINTED["Exercise 2.1.7", f"k{pump}"].told(
            runs=len(found), duration=duration, volts=volts, simulator=SIMULATOR, error=error
        )
        row = line.compared(mean, tolerance=3.0 * error / mean)
        yield row.circular("The simulator was given the printed gains.")


def _areas(set_up: SetUp) -> Rows:
    """Compare the holes with those that the printed levels ask for."""
    record = {f"tank_{i}.level": 0.01 * h.value for i, h in enumerate(set_up.levels, 1)}
    record |= {f"pump_{i}": volts for i, volts in enumerate(set_up.voltages, 1)}
    found = orifice_areas_at_rest(plant(set_up), [record])
    # A hole is in proportion to 1/√g.
    ratio = float(np.sqrt(GRAVITY / GRAVITY_OF_HOLES))
    for tank, line in enumerate(set_up.holes, start=1):
        area = 1e4 * found[f"outlet_{tank}"]
        yield line.compared(ratio * area, split=set_up.split, g=GRAVITY_OF_HOLES, with_981=area)


def _levels(set_up: SetUp) -> Rows:
    """Compare the printed levels with those that the printed holes make: the way back."""
    volts = {f"pump_{i}": value for i, value in enumerate(set_up.voltages, 1)}
    point = find_equilibrium(plant(set_up), inputs=volts).as_dict()
    ratio = GRAVITY / GRAVITY_OF_HOLES
    # h is proportional to 1/(g a²) and, in a lower tank, to the flow a₃ √(g h₃) from above, which
    # the pump gives whatever a₃ and g are; so half a unit of the last digit of a leaves this open.
    for tank, (line, hole) in enumerate(zip(set_up.levels, set_up.holes, strict=True), start=1):
        level, room = ratio * 100.0 * point[f"tank_{tank}.level"], 1e-4 / hole.value
        line = line.told(
            g=GRAVITY_OF_HOLES, hole=hole.text, low=level * (1.0 - room), high=level * (1.0 + room)
        )
        row = line.compared(level, tolerance=room)
        yield row.circular("The way back: the printed hole comes from this level.")


def _tank_of_23() -> Row:
    """Find which tank rests at 23.5 cm."""
    speed = np.sqrt(2.0 * GRAVITY_OF_HOLES * MINIMUM.levels[3].value)
    through = (1.0 - MINIMUM.split) * MINIMUM.voltages[0] / speed
    areas = {3: through * PUMP_GAINS[1], 4: through * PUMP_GAINS[0]}
    printed = MINIMUM.holes[3].value
    nearest = min(areas, key=lambda tank: abs(areas[tank] - printed))
    return PRINTED["text before (23)", "tank that rests at 23.5 cm"].compared(
        float(nearest),
        right_if=(
            ("Table 1 has 23.5 cm as h4", MINIMUM.levels[3].text == "23.5"),
            (
                "a4 of (23) follows from the flow into tank 4, "
                f"{short(areas[4])} cm² with {GRAVITY_OF_HOLES:g} cm/s², not from that into tank "
                f"3, {short(areas[3])} cm²",
                bool(abs(areas[4] - printed) < 0.5e-4 < abs(areas[3] - printed)),
            ),
        ),
    )
