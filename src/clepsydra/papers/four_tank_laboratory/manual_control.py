"""Exercises 2.2.1 to 2.2.4: levels at constant voltages, how they come there, and coupling."""

from __future__ import annotations

import dataclasses

import numpy as np

from clepsydra.base.words import listed
from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import zeros
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.readings import (
    HOLES_IN_WORDS,
    USUAL,
    Reading,
    claimed_in_all,
    readings_of,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    FULL_LEVEL,
    FULL_VOLTAGE,
    MINIMUM,
    NON_MINIMUM,
    SET_UPS,
    Holes,
    SetUp,
    course_model,
)
from clepsydra.papers.four_tank_laboratory.simulator import SEEDS_BY_HAND, Runs, by_hand
from clepsydra.papers.four_tank_laboratory.words import (
    GIVEN,
    SIMULATOR,
    TO_TRY,
    fitted_holes,
    levels_of,
    readings_in_words,
)
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row, Rows, joined
from clepsydra.papers.settling_bands import BANDS

_TABLES = {MINIMUM: "Table 3", NON_MINIMUM: "Table 4"}
#: Voltages with which the report keeps both lower levels at 15 cm, and where it shows that.
_HELD = {
    set_up: (PRINTED.numbers(f"Exercise 2.2.3, {figure}", "input1", "input2"), figure)
    for set_up, figure in ((MINIMUM, "Fig. 5"), (NON_MINIMUM, "Fig. 6"))
}
#: What it says of the levels.
_AT_15 = {MINIMUM: "stable at about 15 cm", NON_MINIMUM: "at 15cm water level"}
#: Which levels one pump moves, as the report reads Figs. 1 to 4.
_COUPLED = (
    (MINIMUM, 1, (1, 4), "Fig. 1"),
    (MINIMUM, 2, (2, 3), "Fig. 2"),
    (NON_MINIMUM, 1, (2, 4), "Fig. 3"),
    (NON_MINIMUM, 2, (1, 3), "Fig. 4"),
)
#: A level that is read once is one of the simulator's within so many standard deviations of its
#: noise, beyond which one in nine lies, and none of its beyond so many, beyond which one in 370
#: does; what is between is left open.
_NEAR, _FAR = 1.6, 3.0
#: What lower holes that are smaller do to the upper levels of Table 3.
_CUT_OFF = (
    "With a1 and a2 fitted, or all holes smaller, level 2 reaches 27.5 cm, and both pumps stand "
    "still for a part of the time, so that less flows into tanks 3 and 4"
)


def run() -> Found:
    """Run the simulator by hand, as the report does; rows on a run say that a reader can too."""
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
        line = PRINTED[table, f"h{tank}, simulation"]
        where = f"At 7.5 V {_in_words(levels)}"
        if set_up is MINIMUM and tank > 2:
            where = f"{where}. {_CUT_OFF}"
        yield _left_open(line, levels, where, set_up)
    again = (
        f"{set_up.level_table} prints it too, as the level that the hole was found from: the same "
        "number twice, and no forecast."
    )
    for tank, level in enumerate(set_up.levels, start=1):
        yield PRINTED[table, f"h{tank}, calculated"].compared(level.value).circular(again)


def _level(runs: Runs, tank: int) -> tuple[float, float]:
    """Return a level at rest, and its standard deviation [cm]."""
    return float(runs.at_last[tank - 1]), float(runs.last[tank - 1].std())


def _left_open(
    line: Printed, levels: dict[Reading, tuple[float, float]], where: str, set_up: SetUp
) -> Row:
    """Compare a level with every reading, of which none may decide by a hair."""
    # How many standard deviations it lies above them.
    above = {
        reading: (line.value - level) / deviation for reading, (level, deviation) in levels.items()
    }
    off = {reading: abs(each) for reading, each in above.items()}
    (level, deviation), *_ = levels.values()
    is_fitted = any(reading.holes != "report" for reading in levels)
    holes = f"; {fitted_holes()}" if is_fitted else ""
    words = (
        f"{where}. Mean and standard deviation from 750 to 1000 s, {SEEDS_BY_HAND} runs of "
        f"{SIMULATOR} from empty tanks. Readings: first the 30 % as three standard deviations, "
        f"then as one{holes}. {TO_TRY}"
    )
    is_near = max(off.values()) <= _NEAR
    within = f"Within {_NEAR:g} standard deviations in every reading."
    row = dataclasses.replace(line, note=joined(within, words)).compared(
        level,
        tolerance=_NEAR * deviation / level if is_near else 0.0,
        unprinted=joined(
            f"More than {_FAR:g} standard deviations off in every reading; the holes of the "
            "simulator are not printed.",
            words,
        ),
    )
    is_between = min(above.values()) < 0.0 < max(above.values())
    if is_near or (min(off.values()) > _FAR and not is_between):
        return row
    low, high = (pick(above, key=lambda each: above[each]) for pick in (min, max))
    if is_between:
        hangs_on = (
            f"It lies between readings, {_about(-above[low])} standard deviations below that with "
            f"{low.told(set_up)} and {_about(above[high])} above that with {high.told(set_up)}."
        )
    else:
        near, far = (pick(off, key=lambda each: off[each]) for pick in (min, max))
        hangs_on = (
            f"It is {_about(off[near])} standard deviations off with {near.told(set_up)}, and "
            f"{_about(off[far])} with {far.told(set_up)}; {_NEAR:g} or less in every reading would "
            f"reproduce it, and more than {_FAR:g} in all would speak against it."
        )
    return dataclasses.replace(row, verdict="remark", reason=joined(hangs_on, words))


def _about(deviations: float) -> str:
    """Return how many standard deviations, in the digits that those leave of it."""
    return f"{deviations:.1f}" if deviations < _FAR else f"about {deviations:.0f}"


def _in_words(levels: dict[Reading, tuple[float, float]]) -> str:
    """Return the levels of every reading, together those with the same holes."""
    by_holes: dict[Holes, list[str]] = {}
    for reading, (level, deviation) in levels.items():
        by_holes.setdefault(reading.holes, []).append(f"{level:.2f} ± {deviation:.2f}")
    told = [f"{listed(each)} cm with {HOLES_IN_WORDS[holes]}" for holes, each in by_holes.items()]
    return "; ".join(told)


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
    shown = (
        f"Shown is the mean from 450 to 600 s, {SEEDS_BY_HAND} runs of {SIMULATOR} from empty "
        f"tanks with 7.5 V on this pump alone, with {USUAL.told(set_up)}."
    )
    row = claimed_in_all(
        PRINTED[f"Exercise 2.2.2, {place}", f"{set_up.phase}, pump {pump} alone"].told(shown=shown),
        holds,
        ", ".join(f"h{tank} = {level:.1f} cm" for tank, level in enumerate(runs.at_last, start=1)),
        readings_in_words(holes=set_up is MINIMUM),
    )
    yield dataclasses.replace(row, reason=joined(row.reason, TO_TRY))
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
    runs = _in_each_reading(set_up, volts)
    for is_fitted in (False, True) if set_up is MINIMUM else (False,):
        which = "fitted holes" if is_fitted else "holes of the report"
        line = PRINTED["Exercise 2.2.3", f"level of both lower tanks, {set_up.phase}, {which}"]
        of_tank = {
            tank: {
                reading: _level(each, tank)
                for reading, each in runs.items()
                if (reading.holes != "report") == is_fitted
            }
            for tank in (1, 2)
        }
        wanted, usual = line.value, next(iter(of_tank[1]))
        far = max(of_tank, key=lambda tank: abs(of_tank[tank][usual][0] - wanted))
        told = "; ".join(
            f"tank {tank}{', which is farther off,' if tank == far and not is_fitted else ''} "
            f"{_in_words(levels)}"
            for tank, levels in of_tank.items()
        )
        where = f"Printed is “{_AT_15[set_up]}”. At {_voltages(set_up)} {told}"
        row = _left_open(line, of_tank[far], where, set_up)
        yield (row.circular("The holes were fitted to these levels.") if is_fitted else row)


def _voltages(set_up: SetUp) -> str:
    percents, _ = _HELD[set_up]
    one, two = _volts(set_up)
    # The sentence of non-minimum phase lacks them.
    caption = ", by the caption of Fig. 6" if set_up is NON_MINIMUM else ""
    return f"{one:g} V and {two:g} V ({percents[0]:g} % and {percents[1]:g} % of 15 V{caption})"


def _settled(set_up: SetUp, reading: Reading, band: float) -> float:
    quiet = by_hand(set_up, _volts(set_up), reading.holes, noise="none", every=1)
    return max(quiet.settled(tank, band) for tank in (1, 2))


def _transient(set_up: SetUp, place: str) -> Row:
    """Compare the transient with the times to 5 % and to 2 % of the slower lower tank."""
    within = {
        reading.holes: [_settled(set_up, reading, band) for band in reversed(BANDS)]
        for reading in readings_of(set_up)
    }
    early, late = within["report"]
    line = PRINTED[f"Exercise 2.2.3, {place}", f"transient, {set_up.phase}"]
    row = line.compared(late, volts=_voltages(set_up), holes=HOLES_IN_WORDS["report"], given=GIVEN)
    between = [holes for holes, (one, two) in within.items() if one <= line.value <= two]
    if between:
        told = [
            f"{one:.0f} and {two:.0f} s with {HOLES_IN_WORDS[holes]}"
            for holes, (one, two) in within.items()
        ]
        only = f" with {HOLES_IN_WORDS[between[0]]} alone" if len(within) > 1 else ""
        said = f"To 5 % and to 2 % it takes {listed(told)}; it lies between the two{only}."
        fits = f"Holes: {fitted_holes()}." if len(within) > 1 else ""
        row = dataclasses.replace(row, verdict="remark", reason=joined(said, row.reason, fits))
    computed = f"{early:.0f} to {late:.0f}"
    reason = joined(row.reason, TO_TRY)
    return dataclasses.replace(row, computed=computed, difference=None, reason=reason)


def _differences() -> Rows:
    holes = np.array([[hole.value for hole in set_up.holes] for set_up in SET_UPS])
    ratios = holes[1] / holes[0]
    spreads, larger = abs(ratios[:2] - 1.0), ratios[2:] - 1.0
    zero = max(zero.real for zero in zeros(course_model(NON_MINIMUM)))
    place = "Exercise 2.2.4"
    first, second = 100.0 * spreads
    yield PRINTED[place, "upper holes"].claimed(
        bool(min(larger) > 2.0 * max(spreads)),
        f"{100.0 * larger[0]:.1f} % and {100.0 * larger[1]:.1f} % larger in non-minimum phase",
        first=first,
        second=second,
    )
    right = PRINTED[place, "zero in the right half-plane"]
    right = right.told(at=levels_of(NON_MINIMUM), given=GIVEN)
    yield right.claimed(zero > 0.0, f"{zero:+.4f} rad/s")
    yield _difficulty()


def _difficulty() -> Row:
    """Judge whether section 2.2.3 has anything of what is said to be found in it."""
    printed = [
        PRINTED[f"Exercise 2.2.3, {figure}", f"transient, {set_up.phase}"]
        for set_up, (_, figure) in _HELD.items()
    ]
    times, widely = (
        [
            {reading.holes: _settled(set_up, reading, band) for reading in readings_of(set_up)}
            for set_up in SET_UPS
        ]
        for band in BANDS
    )
    told = "; ".join(
        f"{set_up.phase} {listed([f'{each:.0f}' for each in found.values()])} s, printed "
        f"{line.text} s"
        for set_up, found, line in zip(SET_UPS, times, printed, strict=True)
    )
    is_longer = any(max(after.values()) > min(before.values()) for before, after in (times, widely))
    line = PRINTED["Exercise 2.2.4", "manual control"].told(
        holes=fitted_holes(),
        given=GIVEN,
        widely=" and ".join(
            f"{listed([f'{each:.0f}' for each in found.values()])} s in {set_up.phase}"
            for set_up, found in zip(SET_UPS, widely, strict=True)
        ),
    )
    return line.claimed(is_longer or printed[1].value > printed[0].value, told)
