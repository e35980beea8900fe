"""Exercises 2.1.7 and 2.1.8: the gains of the pumps and the holes, as the report finds them."""

from __future__ import annotations

import numpy as np

from clepsydra.identification.orifice_areas import orifice_areas_at_rest
from clepsydra.identification.pump_gains import pump_gain
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.manual_runs import by_hand
from clepsydra.papers.four_tank_laboratory.set_ups import (
    AREA,
    GRAVITY,
    MINIMUM,
    OF_THE_COURSE,
    PUMP_GAINS,
    SET_UPS,
    SetUp,
    plant,
)
from clepsydra.papers.printed import short
from clepsydra.papers.row import Row, Rows

#: The report prints no g; from this one to 981 cm/s² is left open.
OTHER_GRAVITY = 980.0  # cm/s²


def run() -> Found:
    """Find gains and holes from levels, as the report does."""
    rows = [*_gains()]
    for set_up in SET_UPS:
        rows += [*_areas(set_up), *_levels(set_up)]
    return (*rows, _tank_of_23())


def _gains() -> Rows:
    volts, duration = MINIMUM.voltages[0], 10.0
    runs = by_hand(MINIMUM, (volts, volts), duration=duration, plugged=True, every=1)
    for pump in (1, 2):
        found = [
            1e6 * pump_gain(runs.time, 0.01 * level, np.full(len(level), volts), AREA * 1e-4).value
            for level in runs.levels[pump - 1]
        ]
        mean, error = float(np.mean(found)), float(np.std(found, ddof=1) / np.sqrt(len(found)))
        yield (
            PRINTED["Exercise 2.1.7", f"k{pump}"]
            .compared(
                mean,
                tolerance=3.0 * error / mean,
                why=f"From {len(found)} runs of {duration:g} s with plugged outlets at "
                f"{volts:g} V and noisy pumps, with {OF_THE_COURSE}; standard error "
                f"{error:.3f}, of which three are left open.",
            )
            .circular("The simulator was given the printed gains.")
        )


def _printed_record(set_up: SetUp) -> dict[str, float]:
    levels = {f"tank_{i}.level": 0.01 * h.value for i, h in enumerate(set_up.levels, 1)}
    return levels | {f"pump_{i}": volts for i, volts in enumerate(set_up.voltages, 1)}


def _areas(set_up: SetUp) -> list[Row]:
    found = orifice_areas_at_rest(plant(set_up), [_printed_record(set_up)])
    # A hole is in proportion to 1/√g.
    ratio = float(np.sqrt(GRAVITY / OTHER_GRAVITY))
    areas = [1e4 * found[f"outlet_{tank}"] for tank in (1, 2, 3, 4)]
    return [
        line.compared(
            area,
            tolerance=ratio - 1.0,
            why=f"Balances (6) at the levels of {set_up.level_table} and 7.5 V, with "
            f"{GRAVITY:g} cm/s²; g is not printed, and {OTHER_GRAVITY:g} cm/s² gives "
            f"{ratio * area:.4f} cm².",
        )
        for line, area in zip(set_up.holes, areas, strict=True)
    ]


def _levels(set_up: SetUp) -> list[Row]:
    """Compare the printed levels with those that the printed holes make: the way back."""
    volts = {f"pump_{i}": value for i, value in enumerate(set_up.voltages, 1)}
    point = find_equilibrium(plant(set_up), inputs=volts).as_dict()
    gravity = GRAVITY / OTHER_GRAVITY - 1.0
    levels = [100.0 * point[f"tank_{tank}.level"] for tank in (1, 2, 3, 4)]
    # h is proportional to 1/(g a²) and, in a lower tank, to the flow a₃ √(g h₃) from above, which
    # the pump gives whatever a₃ and g are; so half a unit of the last digit of a leaves this open.
    rooms = [1e-4 / hole.value + gravity for hole in set_up.holes]
    return [
        line.compared(
            level,
            tolerance=room,
            why="At rest with both pumps at 7.5 V. The digits of the hole and g leave "
            f"{level * (1.0 - room):.2f} to {level * (1.0 + room):.2f} cm open.",
        ).circular("The way back: the printed hole comes from this level.")
        for line, level, room in zip(set_up.levels, levels, rooms, strict=True)
    ]


def _tank_of_23() -> Row:
    """Find which tank rests at 23.5 cm."""
    flows = {
        3: (1.0 - MINIMUM.split) * PUMP_GAINS[1] * MINIMUM.voltages[1],
        4: (1.0 - MINIMUM.split) * PUMP_GAINS[0] * MINIMUM.voltages[0],
    }
    speed = np.sqrt(2.0 * GRAVITY * MINIMUM.levels[3].value)
    areas = {tank: flow / speed for tank, flow in flows.items()}
    printed = MINIMUM.holes[3].value
    nearest = min(areas, key=lambda tank: abs(areas[tank] - printed))
    return PRINTED["text before (23)", "tank that rests at 23.5 cm"].compared(
        float(nearest),
        right_if=(
            ("Table 1 has 23.5 cm as h4", MINIMUM.levels[3].text == "23.5"),
            (
                "a4 of (23) follows from the flow into tank 4, "
                f"{short(areas[4])} cm², not from that into tank 3, {short(areas[3])} cm²",
                bool(abs(areas[4] - printed) < 0.5e-4 < abs(areas[3] - printed)),
            ),
        ),
    )
