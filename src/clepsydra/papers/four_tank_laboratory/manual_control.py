"""Exercises 2.2.1 to 2.2.4: levels at constant voltages, how they come there, and coupling."""

from __future__ import annotations

import dataclasses

import numpy as np

from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import zeros
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.readings import (
    USUAL,
    Reading,
    claimed_in_all,
    readings_of,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    AREA,
    FULL_LEVEL,
    FULL_VOLTAGE,
    MINIMUM,
    NON_MINIMUM,
    OF_THE_COURSE,
    SET_UPS,
    SetUp,
    course_model,
)
from clepsydra.papers.four_tank_laboratory.simulator import SEEDS_BY_HAND, Runs, by_hand
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row, Rows, joined

_TABLES = {MINIMUM: "Table 3", NON_MINIMUM: "Table 4"}
#: Voltages with which the report keeps both lower levels at 15 cm, and where it shows that.
_HELD = {
    set_up: (PRINTED.numbers(f"Exercise 2.2.3, {figure}", "input1", "input2"), figure)
    for set_up, figure in ((MINIMUM, "Fig. 5"), (NON_MINIMUM, "Fig. 6"))
}
#: Which levels one pump moves, as the report reads Figs. 1 to 4.
_COUPLED = (
    (MINIMUM, 1, (1, 4), "Fig. 1"),
    (MINIMUM, 2, (2, 3), "Fig. 2"),
    (NON_MINIMUM, 1, (2, 4), "Fig. 3"),
    (NON_MINIMUM, 2, (1, 3), "Fig. 4"),
)
#: Where the figures of a level come from.
_SIMULATOR = (
    f"in the course's simulator, whose noise of 30 %, tanks of {AREA:.2f} cm² and pumps that stop "
    "above 27.5 cm until 27 cm are not printed: mean and standard deviation, "
    f"{SEEDS_BY_HAND} runs, 750 to 1000 s"
)
_BY_HAND = "By one's own hand: clepsydra lab --lesson four-tanks."
#: A level that is read once is one of the simulator's within so many standard deviations of its
#: noise, beyond which one in nine lies, and none of its beyond so many, beyond which one in 370
#: does; what is between is left open.
_NEAR, _FAR = 1.6, 3.0


def run() -> Found:
    """Run the simulator by hand, as the report does; each row says that a reader can too."""
    for found in _found():
        if isinstance(found, Row):
            yield dataclasses.replace(found, reason=joined(found.reason, _BY_HAND))
        else:
            yield found


def _found() -> Found:
    for set_up in SET_UPS:
        yield from _table(set_up)
    for coupled in _COUPLED:
        yield from _coupling(*coupled)
    for set_up in SET_UPS:
        yield from _held(set_up)
    array = relative_gain_array(static_gain(course_model(MINIMUM)))
    yield PRINTED["Exercise 2.2.2", "coupling of tanks 1 and 4"].claimed(
        array.shape[0] >= 4, f"an array of {array.shape[0]} outputs, the levels of tanks 1 and 2"
    )
    yield from _differences()


def _in_each_reading(
    set_up: SetUp, volts: tuple[float, ...], duration: float = 1000.0
) -> dict[Reading, Runs]:
    return {
        reading: by_hand(set_up, volts, reading.holes, duration=duration, noise=reading.noise)
        for reading in readings_of(set_up)
    }


def _table(set_up: SetUp) -> Rows:
    """Compare the levels at rest of a table with the simulator's."""
    found, table = _in_each_reading(set_up, set_up.voltages), _TABLES[set_up]
    for tank in (1, 2, 3, 4):
        levels = {reading: _level(runs, tank) for reading, runs in found.items()}
        yield _left_open(PRINTED[table, f"h{tank}, simulation"], levels, f"At 7.5 V {_SIMULATOR}")
    again = (
        f"{set_up.level_table} prints it too, as the level that the hole was found from: the same "
        "number twice, and no forecast."
    )
    for tank, level in enumerate(set_up.levels, start=1):
        yield PRINTED[table, f"h{tank}, calculated"].compared(level.value).circular(again)


def _level(runs: Runs, tank: int) -> tuple[float, float]:
    """Return a level at rest, and its standard deviation [cm]."""
    return float(runs.at_last[tank - 1]), float(runs.last[tank - 1].std())


def _left_open(line: Printed, levels: dict[Reading, tuple[float, float]], what: str) -> Row:
    """Compare a level with every reading, of which none may decide by a hair."""
    number = line.number
    # How many standard deviations it is off, beside what its digits leave open.
    off = {
        reading: max(0.0, abs(level - number.value) - number.half_unit) / deviation
        for reading, (level, deviation) in levels.items()
    }
    (reading, (level, deviation)), *_ = levels.items()
    words = f"{what}, {level:.2f} ± {deviation:.2f} cm with {reading}"
    is_near = max(off.values()) <= _NEAR
    line = dataclasses.replace(
        line, note=f"{words}; within {_NEAR:g} standard deviations in the other readings as well."
    )
    row = line.compared(
        level,
        tolerance=_NEAR * deviation / level if is_near else 0.0,
        unprinted=f"The holes of the simulator are not printed. {words}, more than {_FAR:g} "
        "standard deviations off in the other readings as well.",
    )
    if is_near or min(off.values()) > _FAR:
        return row
    near, far = (pick(off, key=lambda each: off[each]) for pick in (min, max))
    hangs_on = (
        f"It is {off[near]:.1f} standard deviations off with {near}, and {off[far]:.1f} with "
        f"{far}; {_NEAR:g} or less in every reading would reproduce it, and more than {_FAR:g} "
        "would speak against it."
    )
    return dataclasses.replace(row, verdict="remark", reason=joined(hangs_on, f"{words}."))


def _coupling(set_up: SetUp, pump: int, tanks: tuple[int, int], place: str) -> Found:
    """Judge which levels one pump moves, and draw them."""
    volts, percent = (
        tuple(value * (number == pump) for number, value in enumerate(values, start=1))
        for values in (set_up.voltages, (50, 50))
    )
    found = _in_each_reading(set_up, volts, 600.0)
    moved = np.isin((1, 2, 3, 4), tanks)
    holds: dict[Reading | str, bool] = {
        reading: each.at_last[moved].min() > each.at_last[~moved].max()
        for reading, each in found.items()
    }
    runs = found[USUAL]
    yield claimed_in_all(
        PRINTED[f"Exercise 2.2.2, {place}", f"{set_up.phase}, pump {pump} alone"],
        holds,
        ", ".join(f"h{tank} = {level:.1f} cm" for tank, level in enumerate(runs.at_last, start=1)),
    )
    yield Figure(
        place,
        f"Levels with input1 = {percent[0]} %, input2 = {percent[1]} %, {set_up.phase}",
        (_panel(runs, (1, 2, 3, 4)),),
        "One seed of the simulator's noise, from empty tanks.",
    )


def _panel(runs: Runs, tanks: tuple[int, ...]) -> Panel:
    levels = {f"tank {tank}": 100.0 * runs.levels[tank - 1, 0] / FULL_LEVEL for tank in tanks}
    return Panel("", "level [% of 25 cm]", curves(runs.time, levels))


def _held(set_up: SetUp) -> Found:
    """Judge the voltages that hold both lower levels at 15 cm, and draw the levels."""
    percents, place = _HELD[set_up]
    pair = _volts(set_up)
    if set_up is MINIMUM:
        volts = {
            f"voltage of pump {pump}, {set_up.phase}": 7.5 / 50.0 * percent
            for pump, percent in enumerate(percents, start=1)
        }
        yield from PRINTED.compared("Exercise 2.2.3", volts)
    yield from _levels_of_15(set_up, pair)
    yield _transient(set_up, place)
    yield Figure(
        place,
        f"Both lower levels near 15 cm by hand, {percents[0]:g} % and {percents[1]:g} %, "
        f"{set_up.phase}",
        (_panel(by_hand(set_up, pair, "fitted" if set_up is MINIMUM else "report"), (1, 2)),),
        "With the holes that fit these levels." if set_up is MINIMUM else "",
    )


def _volts(set_up: SetUp) -> tuple[float, float]:
    one, two = _HELD[set_up][0]
    return 0.01 * FULL_VOLTAGE * one, 0.01 * FULL_VOLTAGE * two


def _levels_of_15(set_up: SetUp, volts: tuple[float, float]) -> Rows:
    """Compare the one number for both lower levels with the level that is farther from it."""
    percents, *_ = _HELD[set_up]
    voltages = (
        "6.6 and 3.6 V" if set_up is MINIMUM else f"{percents[0]:g} % and {percents[1]:g} % of 15 V"
    )
    runs = _in_each_reading(set_up, volts)
    for holes in dict.fromkeys(reading.holes for reading in runs):
        which = "fitted holes" if holes == "fitted" else "holes of the report"
        line = PRINTED["Exercise 2.2.3", f"level of both lower tanks, {set_up.phase}, {which}"]
        wanted = line.value
        levels = {
            reading: max(
                (_level(each, tank) for tank in (1, 2)), key=lambda level: abs(level[0] - wanted)
            )
            for reading, each in runs.items()
            if reading.holes == holes
        }
        words = f"At {voltages}, of the one that is farther off, {_SIMULATOR}"
        row = _left_open(line, levels, words)
        is_fitted = holes == "fitted"
        yield (row.circular("The holes were fitted to these levels.") if is_fitted else row)


def _settled(set_up: SetUp, reading: Reading, band: float) -> float:
    quiet = by_hand(set_up, _volts(set_up), reading.holes, noise="none", every=1)
    return max(quiet.settled(tank, band) for tank in (1, 2))


def _transient(set_up: SetUp, place: str) -> Row:
    """Compare the transient with the times to 5 % and to 2 % of the slower lower tank."""
    within = {
        reading.holes: [_settled(set_up, reading, band) for band in (0.05, 0.02)]
        for reading in readings_of(set_up)
    }
    early, late = within["report"]
    line = PRINTED[f"Exercise 2.2.3, {place}", f"transient, {set_up.phase}"]
    row = line.compared(late, course=OF_THE_COURSE)
    between = [holes for holes, (one, two) in within.items() if one <= line.value <= two]
    if between:
        with_holes = "fitted holes" if between[0] == "fitted" else "the holes of the report"
        said = f"With {with_holes} it lies between the times to 5 % and to 2 %."
        row = dataclasses.replace(row, verdict="remark", reason=joined(said, row.reason))
    return dataclasses.replace(row, computed=f"{early:.0f} to {late:.0f}", difference=None)


def _differences() -> Rows:
    holes = np.array([[hole.value for hole in set_up.holes] for set_up in SET_UPS])
    ratios = holes[1] / holes[0]
    spreads, larger = abs(ratios[:2] - 1.0), ratios[2:] - 1.0
    zero = max(zero.real for zero in zeros(course_model(NON_MINIMUM)))
    times = [f"{each.phase} {_settled(each, USUAL, 0.02):.0f} s" for each in SET_UPS]
    place = "Exercise 2.2.4"
    first, second = 100.0 * spreads
    yield PRINTED[place, "upper holes"].claimed(
        bool(min(larger) > 2.0 * max(spreads)),
        f"{100.0 * larger[0]:.1f} % and {100.0 * larger[1]:.1f} % larger",
        first=first,
        second=second,
    )
    right = PRINTED[place, "zero in the right half-plane"].told(course=OF_THE_COURSE)
    yield right.claimed(zero > 0.0, f"{zero:+.4f} rad/s")
    yield PRINTED[place, "manual control"].remark("; ".join(times), course=OF_THE_COURSE)
