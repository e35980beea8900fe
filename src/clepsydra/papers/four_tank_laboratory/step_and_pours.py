"""What Tables 5 and 6 share: their printed numbers, their rows and the figures beside them.

The controllers are not printed, so that ours are designs by the rules of the course. A number is
reproduced where runs of every reading reach it from either side, and not where it is far from all
runs of every reading, see `readings` and `reach`; all else is a remark, as is every recovery, since
the pour is not printed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from itertools import product

import numpy as np

from clepsydra.papers.figure import Curve, Figure, Panel, curves
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.controllers import Kind
from clepsydra.papers.four_tank_laboratory.pours import (
    OURS,
    POURS_IN_WORDS,
    other_pours,
    recoveries_in_words,
)
from clepsydra.papers.four_tank_laboratory.reach import (
    ENOUGH,
    FAR,
    Reach,
    far_from_all,
    median_interval,
    surely_larger,
)
from clepsydra.papers.four_tank_laboratory.readings import (
    DESIGNED,
    LAGS_IN_WORDS,
    ON_PAPER,
    READINGS,
    USUAL,
    Reading,
    claimed_in_all,
    has_lag,
    readings_of,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    FULL_LEVEL,
    MINIMUM,
    SET_UPS,
    Noise,
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
#: How a reason begins, with what all definitions of a score share.
_LEADS = {
    "rise": "Rise",
    "overshoot": "Overshoot of the step, up to the first pour",
    "recovery": (
        f"Recovery from {POURED_LEVEL:g} cm {OURS}, poured within a second, until back for good, "
        "up to the next pour"
    ),
}
_STANDS_FOR = (
    "One number stands for both tanks; whether for each or for the slower of them is not said."
)
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


def everywhere(kind: Kind, score: str, *, lag: bool) -> dict[Reading | str, np.ndarray]:
    """Return what a score lies between [2, set-up, tank]: medians in every reading, and as printed.

    A reading is one of the simulator, and of what the score is; and the designs stand there in
    volts as well, and recoveries from other pours. `lag` says whether words tell of it.
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
            words = f"{reading.in_words(lag=lag)}, taken {definition}"
            found[words] = between(definition, reading)
    if score == "recovery":
        found |= other_pours(kind)
    # In volts they are slow, and may never reach what the other definitions ask for.
    for lagged, told in LAGS_IN_WORDS.items():
        in_volts = replace(USUAL, lagged=lagged)
        words = DESIGNED if lagged == "all" else f"{DESIGNED} and {told}"
        found[words] = between(usual, in_volts, "volts")
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
    lag = kind == "robust"
    holds = {
        reading: surely_larger(*(each[:, :: int(sign)].swapaxes(0, 1)))
        for reading, each in everywhere(kind, score, lag=lag).items()
    }

    def told(reading: Reading) -> str:
        return "; ".join(
            f"{set_up.phase} {one:.3g} and {two:.3g} {UNITS[score]}"
            for set_up, (one, two) in zip(SET_UPS, medians(kind, score, reading), strict=True)
        )

    line = PRINTED[place, name].told(
        definition=SCORES[score][0], runs=SEEDS, poured=POURED_LEVEL, ours=OURS
    )
    readings, run = readings_of_scores((score,), lag=lag), loops(SET_UPS, (kind,))
    return claimed_in_all(line, holds, told(USUAL), readings, run, lag=lag, shown=told)


def readings_of_scores(scores: tuple[str, ...], *, lag: bool) -> str:
    """Return in words what claims about both set-ups are judged by."""
    taken = [
        f"{score} {' or '.join(map(_briefly, SCORES[score]))}"
        for score in scores
        if len(SCORES[score]) > 1
    ]
    poured = [POURS_IN_WORDS] if "recovery" in scores else []
    return "; ".join([readings_in_words(holes=True, lag=lag), *taken, *poured])


def table_rows(kind: Kind) -> Rows:
    """Compare the scores of a table with our controllers."""
    for set_up, score in product(SET_UPS, SCORES):
        for tanks, line in _lines(kind, set_up, score).items():
            yield _row(kind, set_up, score, tanks, line)


#: What a number can be of: (1,) of tank 1, (1, 2) of the slower of both.
_Of = tuple[int, ...]
_SLOWER: _Of = _TANKS
_Reached = dict[tuple[Reading, Definition, _Of], Reach]
#: A reading in the words of a loop.
_Told = Callable[[Reading], str]


def _row(kind: Kind, set_up: SetUp, score: str, tanks: tuple[int, ...], line: Printed) -> Row:
    definitions, readings = SCORES[score], readings_of(set_up, kind)
    is_for_both = len(tanks) == 2
    each: list[_Of] = [(tank,) for tank in tanks]
    scored = {
        key: np.max([_scored(definition, set_up, kind, tank, reading) for tank in of], axis=0)
        for key in product(readings, definitions, [*each, *([_SLOWER] if is_for_both else [])])
        for reading, definition, of in [key]
    }
    reached = {key: Reach.of(values, line.value) for key, values in scored.items()}
    # The tank of the usual reading that is farther from the print stands for both.
    usual = {tank: float(np.median(scored[USUAL, definitions[0], (tank,)])) for tank in tanks}
    shown = max(tanks, key=lambda tank: abs(usual[tank] - line.value))
    words = _words(kind, set_up, score, shown if is_for_both else None)
    # Nothing speaks for or against a recovery, as it hangs on the pour.
    hangs_on_pour = score == "recovery"
    if all(reach.holds for reach in reached.values()) and not hangs_on_pour:
        enough = f"Of {SEEDS} runs at least {ENOUGH} lie on either side of it in every reading."
        line = replace(line, note=joined(_STANDS_FOR if is_for_both else "", words, enough))
        tolerance = abs(usual[shown] - line.value) / usual[shown]
        return line.compared(usual[shown], tolerance=tolerance)
    told = partial(Reading.told, set_up=set_up, lag=has_lag(kind, set_up))
    lies = _lies(scored, reached, told, score)
    far = [of for of in each if _is_far([of], reached, line.value)]
    against = _against(far[0], reached, told, score, line) if far else ""
    # Of the slower too, and on the same side, or the number hangs on which of them it is.
    is_far = far and _is_far([far[0], _SLOWER] if is_for_both else far, reached, line.value)
    if is_far and not hangs_on_pour:
        return line.compared(usual[shown], unprinted=joined(against, lies, words))
    rule = (
        f"In every reading {ENOUGH} or more on either side would reproduce it, and more than "
        f"{FAR:g} standard deviations from the mean speak against it."
    )
    row = line.compared(usual[shown], unprinted=words)
    nearest = ""
    if len({reach.off(line.value) > 0.0 for reach in reached.values()}) == 1:
        nearest = f"The nearest mean, {_nearest(reached, told, score, line)}."
    beside = told(USUAL).replace(f"noise as {USUAL.noise}", "no noise")
    pours = recoveries_in_words(set_up, kind, tanks, beside) if hangs_on_pour else ""
    hangs_on = joined(against or (_STANDS_FOR if is_for_both else ""), lies, rule, nearest, pours)
    return replace(row, verdict="remark", reason=joined(hangs_on, words))


def _is_far(of: list[_Of], reached: _Reached, printed: float) -> bool:
    return far_from_all([reach for key, reach in reached.items() if key[-1] in of], printed)


def _against(tank: _Of, reached: _Reached, told: _Told, score: str, line: Printed) -> str:
    """Tell that a number is out of reach of a tank, and where it is for both, of the slower."""
    own, slower = (
        {key: reach for key, reach in reached.items() if key[-1] == of} for of in (tank, _SLOWER)
    )
    nearest = f"The nearest mean, {_nearest(own, told, score, line)}"
    poured = f" with {POURED_LEVEL:g} cm poured" if score == "recovery" else ""
    if not slower:
        return (
            f"More than {FAR:g} standard deviations from the mean of the runs in every "
            f"reading{poured}. "
            f"{nearest}."
        )
    of_each = (
        f"{_STANDS_FOR} Of each it is out of reach{poured}: more than {FAR:g} standard deviations "
        f"from the mean of the runs of tank {tank[0]} in every reading. {nearest}."
    )
    if _is_far([tank, _SLOWER], reached, line.value):
        near = _nearest(slower, told, score, line)
        return f"{of_each} Of the slower it is so as well; there the nearest mean, {near}."
    return f"{of_each} Of the slower it is not: {_beside(slower, score)}."


def _beside(reached: _Reached, score: str) -> str:
    """Tell on which side of a number runs lie, by definition and noise."""
    groups: dict[tuple[Definition, Noise], list[int]] = {}
    for (reading, definition, _), reach in reached.items():
        groups.setdefault((definition, reading.noise), []).append(reach.above)
    told = [
        f"{_taken(score, definition)}with noise as {noise} {min(above)} to {max(above)} of "
        f"{SEEDS} runs lie above it and the others below"
        for (definition, noise), above in groups.items()
        if {*above} not in ({0}, {SEEDS})
    ]
    sides = {above[0] for above in groups.values() if {*above} in ({0}, {SEEDS})}
    if sides:
        other = "other " if told else ""
        lie = " or ".join({0: "below", SEEDS: "above"}[side] for side in sorted(sides))
        told.append(f"in all {other}readings all lie {lie}")
    return "; ".join(told)


def _nearest(reached: _Reached, told: _Told, score: str, line: Printed) -> str:
    """Tell of the runs whose mean is nearest to a number."""
    key = min(reached, key=lambda each: abs(reached[each].off(line.value)))
    reach, (reading, definition, _) = reached[key], key
    return (
        f"{_taken(score, definition)}{reach.mean:.3g} ± {reach.deviation:.2g} {UNITS[score]} with "
        f"{told(reading)}, is {abs(reach.off(line.value)):.1f} standard deviations off"
    )


def _lies(
    scored: dict[tuple[Reading, Definition, _Of], np.ndarray],
    reached: _Reached,
    told: _Told,
    score: str,
) -> str:
    """Tell where all runs lie, and how many above a number, by tank and definition."""
    is_for_both = len({of for *_, of in reached}) > 1
    lines = []
    for definition, of in dict.fromkeys((taken, of) for _, taken, of in reached):
        counts = {
            reading: reach.above
            for (reading, taken, whose), reach in reached.items()
            if (taken, whose) == (definition, of)
        }
        spread = _spread([scored[each, definition, of] for each in counts], UNITS[score])
        above = _counts(counts, None if is_for_both else told)
        # What is taken stands before the first tank alone.
        taken_as = _taken(score, definition) if of == (1,) or not is_for_both else ""
        whose = ("the slower " if of == _SLOWER else f"tank {of[0]} ") if is_for_both else ""
        lines.append(f"{taken_as}{whose}{spread}, {above}")
    return (
        f"{_LEADS[score]}, {SEEDS} runs in each reading, and how many lie above it: "
        f"{'; '.join(lines)}."
    )


def _counts(counts: dict[Reading, int], told: _Told | None) -> str:
    """Tell the fewest runs that lie above a number, and the most, and if asked for with what."""
    few, many = (pick(counts, key=lambda key: counts[key]) for pick in (min, max))
    ends = [
        {0: "none", SEEDS: "all"}.get(counts[each], f"{counts[each]}")
        + (f" with {told(each)}" if told else "")
        for each in (few, many)
    ]
    if counts[few] == counts[many]:
        return ends[0].partition(" with")[0]
    return " to ".join(ends)


def _briefly(definition: Definition) -> str:
    """Return a definition without what it shares with its other one."""
    return definition.words.removeprefix("until back ").partition(" for good")[0]


def _taken(score: str, definition: Definition) -> str:
    """Return a definition before what comes out, where there are two."""
    return f"{_briefly(definition)} " if len(SCORES[score]) > 1 else ""


def _spread(values: list[np.ndarray], unit: str) -> str:
    low, high = (float(pick([pick(each) for each in values])) for pick in (np.min, np.max))
    # A level may be outside its band when the next pour comes.
    if math.isfinite(high):
        return f"{low:.3g} to {high:.3g} {unit}"
    return f"{low:.3g} {unit} to beyond the next pour"


def _words(kind: Kind, set_up: SetUp, score: str, farther: int | None) -> str:
    """Tell where the number of a row comes from."""
    of_both = f" of tank {farther}, which is farther off," if farther else ""
    lag = has_lag(kind, set_up)
    readings = readings_in_words(holes=set_up is MINIMUM, lag=lag)
    first = _taken(score, SCORES[score][0])
    return (
        f"Shown is the median{of_both} {first}with {USUAL.told(set_up, lag=lag)}. "
        f"Readings: {readings}. {loops((set_up,), (kind,))}"
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
