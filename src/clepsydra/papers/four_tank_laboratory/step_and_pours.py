"""What Tables 5 and 6 share: their printed numbers, their rows and the figures beside them.

The controllers are not printed, so that ours are designs by the rules of the course. A number is
reproduced where runs of every reading reach it from either side, and not where no run of any
reading does, see `readings` and `reach`; all else is a remark.
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
from clepsydra.papers.four_tank_laboratory.reach import (
    ENOUGH,
    Reach,
    median_interval,
    surely_larger,
)
from clepsydra.papers.four_tank_laboratory.readings import (
    DESIGNED,
    LAGS,
    ON_PAPER,
    READINGS,
    USUAL,
    Reading,
    claimed_in_all,
    readings_of,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    FULL_LEVEL,
    MINIMUM,
    SET_UPS,
    SetUp,
    Units,
)
from clepsydra.papers.four_tank_laboratory.simulator import (
    POURED_LEVEL,
    SCORES,
    SEEDS,
    TARGET,
    Definition,
    runs,
)
from clepsydra.papers.four_tank_laboratory.words import loops, readings_in_words
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row, Rows, joined

_TANKS = (1, 2)
_TABLES: dict[Kind, str] = {"decentralised": "Table 5", "robust": "Table 6"}
#: The name and the first of the two figures of a kind.
_FIGURES: dict[Kind, tuple[str, int]] = {
    "decentralised": ("Decentralised PI", 7),
    "robust": ("Glover-McFarlane", 9),
}
UNITS = {"rise": "s", "overshoot": "%", "recovery": "s"}


@cache
def _scored(
    definition: Definition,
    set_up: SetUp,
    kind: Kind,
    tank: int,
    reading: Reading,
    units: Units = "percent",
) -> np.ndarray:
    one = reading.of(set_up, kind)
    (score,) = (name for name, definitions in SCORES.items() if definition in definitions)
    found = runs(set_up, kind, units, one.holes, one.noise, one.lagged)
    return found.scored(score, tank, definition)


def _lines(kind: Kind, set_up: SetUp, score: str) -> dict[tuple[int, ...], Printed]:
    """Return the printed numbers of a score by the tanks that each is for: one may be for both."""
    groups: tuple[tuple[int, ...], ...] = (_TANKS, (1,), (2,))
    keys = {
        tanks: (_TABLES[kind], f"{score} {'/'.join(map(str, tanks))}, {set_up.phase}")
        for tanks in groups
    }
    return {tanks: PRINTED[key] for tanks, key in keys.items() if key in PRINTED}


def medians(kind: Kind, score: str, reading: Reading = USUAL) -> np.ndarray:
    """Return the medians of a score [set-up, tank] as it is usually taken."""
    usual = SCORES[score][0]
    both = product(SET_UPS, _TANKS)
    found = [np.median(_scored(usual, set_up, kind, tank, reading)) for set_up, tank in both]
    return np.reshape(found, (2, 2))


def everywhere(kind: Kind, score: str) -> dict[Reading | str, np.ndarray]:
    """Return what a score lies between [2, set-up, tank]: medians in every reading, and as printed.

    A reading is one of the simulator, and of what the score is; and the designs stand there in
    volts as well.
    """

    def between(definition: Definition, reading: Reading, units: Units = "percent") -> np.ndarray:
        both = product(SET_UPS, _TANKS)
        found = [
            median_interval(_scored(definition, set_up, kind, tank, reading, units))
            for set_up, tank in both
        ]
        return np.reshape(np.transpose(found), (2, 2, 2))

    found: dict[Reading | str, np.ndarray] = {}
    usual, *further = SCORES[score]
    for reading in READINGS:
        found[reading] = between(usual, reading)
        for definition in further:
            found[f"{reading}, taken {definition}"] = between(definition, reading)
    # In volts they are slow, and may never reach what the other definitions ask for.
    for lagged in LAGS:
        lag = "" if lagged == "all" else ", with a lag of W's diagonal alone"
        in_volts = replace(USUAL, lagged=lagged)
        found[f"{DESIGNED}{lag}"] = between(usual, in_volts, "volts")
    printed = [
        (line.value - line.number.half_unit, line.value + line.number.half_unit)
        for set_up, tank in product(SET_UPS, _TANKS)
        for tanks, line in _lines(kind, set_up, score).items()
        if tank in tanks
    ]
    return found | {ON_PAPER: np.reshape(np.transpose(printed), (2, 2, 2))}


def beside_minimum(kind: Kind, place: str, name: str, score: str, sign: float) -> Row:
    """Judge a claim on non-minimum phase beside minimum phase, in each tank.

    The sign tells whether the score of non-minimum phase is larger by the claim, or smaller.
    """
    holds = {
        reading: surely_larger(*(each[:, :: int(sign)].swapaxes(0, 1)))
        for reading, each in everywhere(kind, score).items()
    }

    def told(reading: Reading) -> str:
        return "; ".join(
            f"{set_up.phase} {one:.3g} and {two:.3g} {UNITS[score]}"
            for set_up, (one, two) in zip(SET_UPS, medians(kind, score, reading), strict=True)
        )

    line = PRINTED[place, name].told(definition=SCORES[score][0], runs=SEEDS, poured=POURED_LEVEL)
    readings = readings_of_scores((score,), lag=kind == "robust")
    return claimed_in_all(line, holds, told(USUAL), readings, loops(SET_UPS, (kind,)), shown=told)


def readings_of_scores(scores: tuple[str, ...], *, lag: bool) -> str:
    """Return in words what claims about both set-ups are judged by."""
    taken = [
        f"{score} {' or '.join(map(_briefly, SCORES[score]))}"
        for score in scores
        if len(SCORES[score]) > 1
    ]
    return "; ".join([readings_in_words(holes=True, lag=lag), *taken])


def table_rows(kind: Kind) -> Rows:
    """Compare the scores of a table with our controllers."""
    for set_up, score in product(SET_UPS, SCORES):
        for tanks, line in _lines(kind, set_up, score).items():
            yield _row(kind, set_up, score, tanks, line)


def _row(kind: Kind, set_up: SetUp, score: str, tanks: tuple[int, ...], line: Printed) -> Row:
    definitions, readings = SCORES[score], readings_of(set_up, kind)
    reached = {
        (reading, definition): [
            Reach.of(_scored(definition, set_up, kind, tank, reading), line.number)
            for tank in tanks
        ]
        for reading, definition in product(readings, definitions)
    }
    # The tank of the usual reading that is farther from the print stands for both.
    usual = [float(np.median(_scored(definitions[0], set_up, kind, tank, USUAL))) for tank in tanks]
    median = max(usual, key=lambda each: abs(each - line.value))
    farther = tanks[usual.index(median)] if len(tanks) == 2 else None
    words = _words(kind, set_up, score, farther)
    if all(reach.holds for both in reached.values() for reach in both):
        enough = f"Of {SEEDS} runs at least {ENOUGH} lie on either side of it in every reading."
        line = replace(line, note=joined(words, enough))
        return line.compared(median, tolerance=abs(median - line.value) / median)
    out = [_out_of_reach(reached, reading, definitions, tanks) for reading in readings]
    if all(out):
        always = sorted(set.intersection(*out))
        of_tank = f" of tank {' and of tank '.join(map(str, always))}" if len(tanks) == 2 else ""
        beyond = (
            f"In every reading all {SEEDS} runs{of_tank} lie on one side of it: "
            f"{_spreads(kind, set_up, score, tanks)}."
        )
        return line.compared(median, unprinted=joined(beyond, words))
    row = line.compared(median, unprinted=words)
    hangs_on = _hangs_on(score, reached, _spreads(kind, set_up, score, tanks))
    return replace(row, verdict="remark", reason=joined(hangs_on, words))


_Reached = dict[tuple[Reading, Definition], list[Reach]]


def _out_of_reach(
    reached: _Reached, reading: Reading, definitions: tuple[Definition, ...], tanks: tuple[int, ...]
) -> set[int]:
    """Return the tanks of which all runs lie on one side, whatever the score is."""
    by_tank = zip(*(reached[reading, definition] for definition in definitions), strict=True)
    return {
        tank
        for tank, of_tank in zip(tanks, by_tank, strict=True)
        if all(of_tank[0].fails_like(each) for each in of_tank)
    }


def _hangs_on(score: str, reached: _Reached, spreads: str) -> str:
    """Tell with which reading most runs reach a number, and with which fewest."""
    definitions = SCORES[score]
    counts = {key: min(reach.runs for reach in both) for key, both in reached.items()}
    most, fewest = (pick(counts, key=lambda key: counts[key]) for pick in (max, min))
    if counts[most] == counts[fewest] == 0:
        of_both = " of both tanks" if len(reached[most]) == 2 else ""
        return (
            f"In no reading does it have runs{of_both} on either side, but not in all on the same "
            "one: "
            f"{spreads}."
        )
    with_most, with_fewest = (
        f"{reading}, taken {_briefly(definition)}" if len(definitions) > 1 else f"{reading}"
        for reading, definition in (most, fewest)
    )
    return (
        f"The side of it where fewer runs lie has {counts[most]} of {SEEDS} with {with_most}, "
        f"and {counts[fewest] or 'none'} with {with_fewest}; {ENOUGH} or more in "
        "every reading would reproduce it, and none in any would speak against it. All runs: "
        f"{spreads}."
    )


def _briefly(definition: Definition) -> str:
    """Return a definition without what it shares with its other one."""
    return definition.words.removeprefix("until back ").partition(" for good")[0]


def _spreads(kind: Kind, set_up: SetUp, score: str, tanks: tuple[int, ...]) -> str:
    """Tell between what the runs of all readings lie, for each tank and definition."""
    told = []
    for tank in tanks:
        of_tank = [
            _spread(
                [
                    _scored(definition, set_up, kind, tank, reading)
                    for reading in readings_of(set_up, kind)
                ],
                UNITS[score],
            )
            + (f" {_briefly(definition)}" if len(SCORES[score]) > 1 else "")
            for definition in SCORES[score]
        ]
        told.append(f"{f'tank {tank} ' if len(tanks) == 2 else ''}{' and '.join(of_tank)}")
    return "; ".join(told)


def _spread(values: list[np.ndarray], unit: str) -> str:
    low, high = (float(pick([pick(each) for each in values])) for pick in (np.min, np.max))
    # A level may be outside its band when the next pour comes.
    if math.isfinite(high):
        return f"{low:.3g} to {high:.3g} {unit}"
    return f"{low:.3g} {unit} to beyond the next pour"


def _words(kind: Kind, set_up: SetUp, score: str, farther: int | None) -> str:
    """Tell where the number of a row comes from."""
    of_both = f" of tank {farther}, which is farther off," if farther else ""
    first = f" {_briefly(SCORES[score][0])}," if len(SCORES[score]) > 1 else ""
    usual, *further = SCORES[score]
    definitions = ", or ".join([usual.words, *map(_briefly, further)])
    lag = kind == "robust" and set_up is not MINIMUM
    readings = readings_in_words(holes=set_up is MINIMUM, lag=lag)
    poured = f" after {POURED_LEVEL:g} cm within a second" if score == "recovery" else ""
    return (
        f"{score.capitalize()}{poured} {definitions}; shown is the median of {SEEDS} runs"
        f"{of_both}{first} with {USUAL}. Readings: {readings}. "
        f"{loops((set_up,), (kind,))}"
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
