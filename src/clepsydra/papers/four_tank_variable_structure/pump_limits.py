"""Pump limits from 4 to 20 V: where variable-structure PID wins, and where it loses.

The document prints no limit and compares with conventional PID alone, so that the figures show
more than section 4, feature (3) claims.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, curves
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.readings import (
    COMPARED,
    LANE,
    LIMITS,
    SATURATED,
    both,
    decoupled,
    shares_at_limit,
)
from clepsydra.papers.four_tank_variable_structure.rig import (
    IN_WORDS,
    WAYS,
    Filling,
    fill,
    in_volts,
)
from clepsydra.papers.row import Row

#: More than no time at a limit [s].
_SHORTEST = 1e-3
_WITHOUT, _AFTER = "without decoupling", "after decoupling"
_NOTES = {
    _WITHOUT: "The tanks level off by themselves: with integrals that start at zero conditional "
    "integration, which only stops them, settles sooner at nearly every limit.",
    _AFTER: "The decoupled tanks do not level off by themselves, and every PI controller "
    "overshoots: here what is taken back pays.",
}


def run() -> Found:
    """Fill the tanks with every way against windup and every limit."""
    runs = {
        _WITHOUT: {way: fill(in_volts(way), LIMITS) for way in WAYS},
        _AFTER: {way: decoupled(way) for way in WAYS},
    }
    figures = tuple(_figure(reading, found) for reading, found in runs.items())
    return (_returns(runs), _conventional(runs), _coupled(runs[_WITHOUT]), *figures)


def _shares(runs: dict[str, Filling], least: float = SATURATED) -> np.ndarray:
    return shares_at_limit([runs[way] for way in COMPARED], least)


def _returns(runs: dict[str, dict[str, Filling]]) -> Row:
    shares = {reading: _shares(found) for reading, found in runs.items()}
    return PRINTED[
        "section 4, feature (3)", "time of the pumps at a limit, from 4 to 20 V"
    ].claimed(
        all(each.max() < 1.0 for each in shares.values())
        and all(_shares(found, _SHORTEST).max() <= 1.0 for found in runs.values()),
        "; ".join(
            f"{reading} {min(each):.2f} to {max(each):.2f} times as long"
            for reading, each in shares.items()
        ),
    )


def _conventional(runs: dict[str, dict[str, Filling]]) -> Row:
    told = (
        f"{reading} "
        + ", ".join(
            f"{WAYS[way]}: {run.overshoot(1)[LANE]:.1f} % and {run.settling(1)[LANE]:.0f} s"
            for way, run in found.items()
        )
        for reading, found in runs.items()
    )
    return PRINTED["section 1", "conventional PID and the constraint"].remark("; ".join(told))


def _coupled(runs: dict[str, Filling]) -> Row:
    run = runs["variable_structure"]
    line = PRINTED["section 1", "one input and one output"].told(settings=IN_WORDS)
    return line.remark(
        f"overshoot {both(run, 'overshoot')} %, settled in {both(run, 'settling', '.0f')} s"
    )


def _figure(reading: str, runs: dict[str, Filling]) -> Figure:
    def panel(title: str, label: str, of: Callable[[Filling, int], np.ndarray], part: int) -> Panel:
        found = {WAYS[way]: of(run, part) for way, run in runs.items()}
        return Panel(title, label, curves(LIMITS, found), "upper limit of the pumps [V]")

    return Figure(
        "",
        f"Five ways against windup over the limit of the pumps, {reading}",
        (
            panel("Overshoot of h1", "[%]", Filling.overshoot, 1),
            panel("Rise time of h1", "[s]", Filling.rise, 1),
            panel("Settling time of h1, 2 %", "[s]", Filling.settling, 1),
            panel("Settling time of h2, 2 %", "[s]", Filling.settling, 2),
            panel("Time of v1 at a limit", "[s]", Filling.saturated, 1),
        ),
        "From empty to 12.4 and 12.7 cm. The target needs 3 V: below 5 V there is hardly room, "
        "above 18 V nothing saturates. Variable structure takes its integral back while a pump "
        "saturates, so that the pump leaves its limit early and the level creeps up. "
        + _NOTES[reading],
    )
