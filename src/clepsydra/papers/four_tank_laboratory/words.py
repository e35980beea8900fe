"""How the reasons tell what the report does not print: controllers, simulator, readings."""

from __future__ import annotations

import math

from clepsydra.base.words import listed
from clepsydra.papers.four_tank_laboratory.controllers import FILTER, Kind
from clepsydra.papers.four_tank_laboratory.set_ups import (
    AREA,
    FULL_LEVEL,
    FULL_VOLTAGE,
    GRAVITY,
    MINIMUM,
    NON_MINIMUM,
    PHASE_MARGIN,
    SENSOR_GAIN,
    SetUp,
    plant,
)
from clepsydra.papers.four_tank_laboratory.simulator import stretch_of

GLOVER = "Glover-McFarlane (γ = 1.1 γ_min)"
#: What of the process is the course's alone.
GIVEN = f"{AREA:.2f} cm² per tank and {GRAVITY:g} cm/s² (not printed)"
#: And of its simulator.
SIMULATOR = (
    f"the course's simulator ({AREA:.2f} cm² per tank, {GRAVITY:g} cm/s², both pumps off from "
    "27.5 cm in any tank until 27 cm, noise of 30 % of their flow every 0.05 s)"
)
#: The decoupling of the robust control in non-minimum phase.
DECOUPLING = (
    "W = [[−g22/g21, 1], [1, −g11/g12]]·a/(s + a) with "
    f"a = {FILTER * NON_MINIMUM.crossover:g} rad/s"
)
#: How what shapes the loop of the robust control runs from sample to sample.
_SAMPLED = {
    MINIMUM.phase: "on PI as it runs, with a sum over the samples for its integral",
    NON_MINIMUM.phase: "on PI and W sampled by Tustin's rule",
}
#: What the simulator's units make of a gain.
AS_RUN = (
    f"Designed in volts ({SENSOR_GAIN:g} V/cm), they run with the same numbers in percent of "
    f"{FULL_LEVEL:g} cm and {FULL_VOLTAGE:g} V (60 % is 15 cm; "
    f"{FULL_VOLTAGE / (SENSOR_GAIN * FULL_LEVEL):g} times the loop gain)"
)
TO_TRY = "To try it by hand: clepsydra lab --lesson four-tanks."


def levels_of(set_up: SetUp) -> str:
    """Return the levels of tanks 1 to 4 around which the course's model is linear."""
    return f"{listed([f'{level:g}' for level in set_up.course_levels])} cm"


def fitted_holes() -> str:
    """Return which holes of the minimum phase are fitted, and what becomes of the others.

    Examples
    --------
    >>> fitted_holes().partition(", which")[0]
    'a1 and a2 fitted to 15 cm in exercise 2.2.3 (0.1333 and 0.1114 cm²)'
    """
    (one, two), upper = _areas()
    shares = [
        float(area) / hole.value for area, hole in zip((one, two), MINIMUM.holes[:2], strict=True)
    ]
    return (
        f"a1 and a2 fitted to 15 cm in exercise 2.2.3 ({one} and {two} cm²), which does not fix a3 "
        "and a4; all smaller, these two by the mean share of a1 and a2, "
        f"{0.5 * sum(shares):.2f} ({' and '.join(upper)} cm², ours)"
    )


def _areas() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the holes of the lower and of the upper tanks when all are smaller [cm²]."""
    process = plant(MINIMUM, "volts", "fitted")
    areas = [1e4 * process.signal(f"outlet_{tank}.area").initial for tank in (1, 2, 3, 4)]
    words = tuple(f"{area:.4f}" for area in areas)
    return words[:2], words[2:]


def readings_in_words(*, holes: bool, lag: bool = False) -> str:
    """Return what is read in several ways: the noise, the holes and the lag of the decoupling."""
    parts = ["30 % of noise as three standard deviations or one"]
    if lag:
        parts.append("a lag of all of W or of its diagonal alone")
    if holes:
        lower, upper = map(" and ".join, _areas())
        parts.append(
            f"the report's holes; a1 and a2 fitted to 15 cm in exercise 2.2.3 ({lower} cm²); all "
            f"smaller (a3 and a4 {upper} cm², ours)"
        )
    return "; ".join(parts)


def loops(set_ups: tuple[SetUp, ...], kinds: tuple[Kind, ...]) -> str:
    """Return what our controllers are, and how they are run."""
    stretch = " and ".join(
        f"{stretch_of(each):g} s{f' in {each.phase}' if len(set_ups) > 1 else ''}"
        for each in set_ups
    )
    return (
        f"{controllers(set_ups, kinds)} {AS_RUN} every 0.05 s, without anti-windup, from empty "
        f"tanks of {SIMULATOR}; {stretch} for the step and each pour."
    )


def controllers(set_ups: tuple[SetUp, ...], kinds: tuple[Kind, ...]) -> str:
    """Return what our controllers are, in one set-up or in both."""
    several = len(set_ups) > 1
    told = [
        f"in {set_up.phase} {_controller(set_up, kinds)}" if several else _controller(set_up, kinds)
        for set_up in set_ups
    ]
    ours = f"The report prints no controllers; ours, by the course's exercise: {'; '.join(told)}."
    if "robust" not in kinds:
        return ours
    shapings = [
        f"{_SAMPLED[each.phase]}{f' in {each.phase}' if several else ''}" for each in set_ups
    ]
    return (
        f"{ours} Glover-McFarlane is designed in discrete time (0.05 s, pumps held in between) "
        f"{' and '.join(shapings)}."
    )


def _controller(set_up: SetUp, kinds: tuple[Kind, ...]) -> str:
    margin = (
        f"{math.degrees(PHASE_MARGIN):.0f}° of phase margin at {set_up.crossover:g} rad/s (linear "
        f"model, the report's holes, {levels_of(set_up)})"
    )
    pairs = listed([f"tank {y[-1]} by pump {u[-1]}" for y, u in set_up.pairing])
    plain, around = f"PI of {pairs}, {margin}", f"{GLOVER} around"
    if kinds == ("decentralised",):
        return plain
    if set_up is MINIMUM:
        return f"{plain}, and {around} it" if len(kinds) > 1 else f"{around} {plain}"
    through = f"PI through {DECOUPLING},"
    if len(kinds) > 1:
        return f"{plain}, and {around} {through} with the same margin in each element of G W"
    return f"{around} {through} {margin} in each element of G W"
