"""What Tables 5 and 6 share: their printed numbers, their rows and the figures beside them.

The controllers are not printed, so that ours are designs by the rules of the course. A number is
reproduced where nearly all runs of every reading of the simulator leave it open, see `readings`,
and lie near enough together to decide anything.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np

from clepsydra.papers.figure import Curve, Figure, Panel, curves
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.controllers import Kind
from clepsydra.papers.four_tank_laboratory.readings import (
    DESIGNED,
    MEDIANS,
    ON_PAPER,
    READINGS,
    USUAL,
    Reading,
    agreeing,
    claimed_in_all,
    readings_of,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    FULL_LEVEL,
    NON_MINIMUM,
    OF_THE_COURSE,
    PHASE_MARGIN,
    SENSOR_GAIN,
    SET_UPS,
    UNCONVERTED,
    SetUp,
    Units,
)
from clepsydra.papers.four_tank_laboratory.simulator import BAND, SCORES, SEEDS, TARGET, runs
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row, Rows

#: The report shows one run, so that what noise does to nearly all runs is left open.
_CENTRAL = (0.025, 0.975)
#: What runs that spread by more than this share of their median leave open decides nothing.
_WIDEST = 0.5
_TANKS = (1, 2)
#: Runs between these quantiles.
_NEARLY_ALL = 1 + round(_CENTRAL[1] * (SEEDS - 1)) - round(_CENTRAL[0] * (SEEDS - 1))


_TABLES: dict[Kind, str] = {"decentralised": "Table 5", "robust": "Table 6"}
#: The name and the first of the two figures of a kind.
_FIGURES: dict[Kind, tuple[str, int]] = {
    "decentralised": ("Decentralised PI", 7),
    "robust": ("Glover-McFarlane", 9),
}
GLOVER = "Glover-McFarlane with γ = 1.1 γ_min"
UNITS = {"rise": "s", "overshoot": "%", "recovery": "s"}
#: How the scores are read.
_HOW = {
    "rise": "From 10 to 90 % of the step",
    "overshoot": "Of the step",
    "recovery": f"Until back within {100 * BAND:g} % of 15 cm",
}


@cache
def _scored(
    score: str, set_up: SetUp, kind: Kind, tank: int, reading: Reading, units: Units = "percent"
) -> np.ndarray:
    found = runs(set_up, kind, units, reading.of(set_up).holes, reading.noise)
    return found.scored(score, tank)


def _spread(values: np.ndarray) -> tuple[float, float, float]:
    """Return the median, and what nearly all runs lie between."""
    # Not between two runs, of which one may never have recovered.
    low, high = np.quantile(values, _CENTRAL, method="nearest")
    return float(np.median(values)), float(low), float(high)


def _lines(kind: Kind, set_up: SetUp, score: str) -> dict[tuple[int, ...], Printed]:
    """Return the printed numbers of a score by the tanks that each is for: one may be for both."""
    groups: tuple[tuple[int, ...], ...] = (_TANKS, (1,), (2,))
    keys = {
        tanks: (_TABLES[kind], f"{score} {'/'.join(map(str, tanks))}, {set_up.phase}")
        for tanks in groups
    }
    return {tanks: PRINTED[key] for tanks, key in keys.items() if key in PRINTED}


def everywhere(kind: Kind, score: str) -> dict[Reading | str, np.ndarray]:
    """Return a score [set-up, tank] in every reading, of the designs in volts, and as printed."""

    def medians(reading: Reading, units: Units = "percent") -> np.ndarray:
        both = product(SET_UPS, _TANKS)
        found = [np.median(_scored(score, s, kind, tank, reading, units)) for s, tank in both]
        return np.reshape(found, (2, 2))

    printed = [
        line.value
        for set_up, tank in product(SET_UPS, _TANKS)
        for tanks, line in _lines(kind, set_up, score).items()
        if tank in tanks
    ]
    return {
        **{reading: medians(reading) for reading in READINGS},
        DESIGNED: medians(USUAL, "volts"),
        ON_PAPER: np.reshape(printed, (2, 2)),
    }


def beside_minimum(kind: Kind, place: str, name: str, score: str, sign: float) -> Row:
    """Judge a claim on non-minimum phase beside minimum phase, in each tank.

    The sign tells whether the score of non-minimum phase is larger by the claim, or smaller.
    """
    values = everywhere(kind, score)
    holds = {reading: sign * other > sign * one for reading, (one, other) in values.items()}
    told = "; ".join(
        f"{set_up.phase} {one:.3g} and {two:.3g} {UNITS[score]}"
        for set_up, (one, two) in zip(SET_UPS, values[USUAL], strict=True)
    )
    line = PRINTED[place, name].told(
        glover=GLOVER, medians=MEDIANS, band=100 * BAND, poured=0.25 * FULL_LEVEL
    )
    return claimed_in_all(line, holds, told)


def table_rows(kind: Kind) -> Rows:
    """Compare the scores of a table with our controllers."""
    for set_up, score in product(SET_UPS, SCORES):
        for tanks, line in _lines(kind, set_up, score).items():
            yield _row(kind, set_up, score, tanks, line)


def _row(kind: Kind, set_up: SetUp, score: str, tanks: tuple[int, ...], line: Printed) -> Row:
    spreads = {
        reading: [_spread(_scored(score, set_up, kind, tank, reading)) for tank in tanks]
        for reading in readings_of(set_up)
    }
    # The tank of the usual reading that is farther from the print stands for both.
    median, least, most = max(spreads[USUAL], key=lambda spread: abs(spread[0] - line.value))
    printed, half = line.value, line.number.half_unit
    holding = {
        reading: all(low - half <= printed <= high + half for _, low, high in found)
        for reading, found in spreads.items()
    }
    # Only runs that lie near enough together can be compared with one.
    every = (spread for found in spreads.values() for spread in found)
    decides = all(high - low <= _WIDEST * value for value, low, high in every)
    reach = most - median if printed > median else median - least
    always = all(holding.values()) and decides
    of_both = ", of the tank that is farther off" if len(tanks) == 2 else ""
    around = GLOVER + " around " if kind == "robust" else ""
    shaping = "a dynamic decoupling" if around and set_up is NON_MINIMUM else "PI control"
    words = (
        f"The controller is not printed; ours is {around}{shaping} with "
        f"{math.degrees(PHASE_MARGIN):.0f}° at {set_up.crossover:g} rad/s, as the course's "
        f"exercise asks, designed in volts ({SENSOR_GAIN:g} V/cm) and run {UNCONVERTED}: "
        f"empty tanks, {USUAL}, pours of 6.25 cm, with {OF_THE_COURSE}. "
        f"{_HOW[score]}, median of {SEEDS} runs{of_both}."
    )
    of_all = (
        f"The middle {_NEARLY_ALL} of them are {least:.3g} to {most:.3g} {line.unit}, "
        "and in the other readings of noise and holes they leave it open as well."
    )
    row = replace(line, note=f"{words} {of_all}").compared(
        median,
        tolerance=reach / median if always and median else 0.0,
        unprinted=words,
    )
    if not any(holding.values()):
        return row
    if all(holding.values()):
        return row.undecided(
            f"The middle {_NEARLY_ALL} of {SEEDS} runs leave it open, but spread by more than "
            f"{100 * _WIDEST:g} % of their median, too far to decide."
        )
    among, outside = agreeing(holding)
    return row.undecided(
        f"With {among} it lies between the lowest and the highest of the middle {_NEARLY_ALL} of "
        f"{SEEDS} runs, and with {outside} it does not."
    )


def table_figures(kind: Kind) -> Iterator[Figure]:
    """Return the runs of Figs. 7 and 8, or 9 and 10: levels and pumps of one seed."""
    name, first = _FIGURES[kind]
    for number, set_up in enumerate(SET_UPS, first):
        found = runs(set_up, kind, "percent")
        time = found.time
        target = Curve("reference", time[[0, -1]], np.full(2, 100.0 * TARGET), "dashed")
        levels = {f"tank {i}": 100.0 * (found.levels[i - 1, 0] / FULL_LEVEL) for i in _TANKS}
        pumps = {f"pump {pump}": 100.0 * found.pumps[pump - 1] for pump in _TANKS}
        yield Figure(
            f"Fig. {number}",
            f"{name}, both references 60 %, then pours into tank 1 and tank 2, {set_up.phase}",
            (
                Panel("", "level [% of 25 cm]", [target, *curves(time, levels)]),
                Panel("", "pump [% of 15 V]", curves(time, pumps)),
            ),
            "One seed of the simulator's noise, from empty tanks.",
        )
