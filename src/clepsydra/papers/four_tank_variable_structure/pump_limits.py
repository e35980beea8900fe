"""Pump limits from 4 to 20 V: where variable-structure PID wins, and where it loses.

The document prints no limit and compares with conventional PID alone, so that nothing but its
section 4, feature (3) is judged here.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clepsydra.papers.comparison import claimed, remark
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.decoupled import (
    LIMITS,
    at_limit,
    decoupled,
    ranges,
    sooner,
)
from clepsydra.papers.four_tank_variable_structure.readings import CONVENTIONAL, SATURATED, both
from clepsydra.papers.four_tank_variable_structure.rig import (
    IN_WORDS,
    SAMPLED,
    WAYS,
    Filling,
    fill,
    in_volts,
)
from clepsydra.papers.row import Row

SHOWN = (4.0, 6.0, 10.0, 15.0, 20.0)
#: More than no time at a limit [s].
_SHORTEST = 1e-3
#: Where the five ways are told in figures [V].
USUAL = 10.0
_WITHOUT, _AFTER = "without decoupling", "after decoupling"
_NOTES = {
    _WITHOUT: "The tanks level off by themselves: with integrals that start at zero conditional "
    "integration, which only stops them, settles sooner at nearly every limit.",
    _AFTER: "The decoupled tanks do not level off by themselves, and every PI controller "
    "overshoots: here what is taken back pays.",
}
_HOW = {
    _WITHOUT: f"Johansson's PI controllers ({IN_WORDS}) in volts",
    _AFTER: f"By (9), ν from Johansson's PI controllers ({IN_WORDS}) times E",
}
#: What every row here rests on beside that.
_SETTINGS = (
    f", 0.5 V/cm, a sample every {SAMPLED:g} s, integrals that start at zero, α = 0.1 1/s with K_1 "
    "of (14) as K/Ti, from empty tanks to 12.4 and 12.7 cm."
)
#: What the other rules are; the document has none of them.
_RULES = (
    "Conditional integration is the document's rule with α = 0, clamping keeps the integral within "
    "the range of the pump, and back-calculation has Tt = Ti."
)


def pump_limits() -> Findings:
    """Fill the tanks with every way against windup and every limit."""
    runs = {
        _WITHOUT: {way: fill(in_volts(way), LIMITS) for way in WAYS},
        _AFTER: {way: decoupled(way) for way in WAYS},
    }
    rows = [_returns(runs)]
    for reading, found in runs.items():
        rows += [_conventional(reading, found[CONVENTIONAL]), _five(reading, found)]
        rows.append(_sooner(reading, found))
    figures = tuple(_figure(reading, found) for reading, found in runs.items())
    return Findings(tuple(rows), figures)


def _shares(runs: dict[str, Filling], least: float = SATURATED) -> list[float]:
    """Return the time at a limit as a share of conventional PID's, where that saturates."""
    new, old = runs["variable_structure"], runs[CONVENTIONAL]
    times = [
        (new.saturated(pump, limit, lane), old.saturated(pump, limit, lane))
        for lane, limit in enumerate(LIMITS)
        for pump in (1, 2)
    ]
    return [one / other for one, other in times if other >= least]


def _returns(runs: dict[str, dict[str, Filling]]) -> Row:
    shares = {reading: _shares(found) for reading, found in runs.items()}
    counts = " and ".join(f"{len(each)} of them {reading}" for reading, each in shares.items())
    return claimed(
        "section 4, feature (3)",
        "time of the pumps at a limit, from 4 to 20 V",
        "returns to the linear range. The speed is faster than the normal saturation method",
        all(max(each) < 1.0 for each in shares.values())
        and all(max(_shares(found, _SHORTEST)) <= 1.0 for found in runs.values()),
        "; ".join(
            f"{reading} {min(each):.2f} to {max(each):.2f} times as long"
            for reading, each in shares.items()
        ),
        reason="Time at a limit against that of conventional PID, with a limiter alone. Two pumps "
        f"at {len(LIMITS)} limits are {2 * len(LIMITS)} cases: in {counts} it stands at a limit "
        f"for {SATURATED:g} s or more; in the others it is never longer with variable structure. "
        f"{_HOW[_WITHOUT]}, or times E for ν{_SETTINGS} That the level comes "
        "sooner is not said there.",
    )


def _conventional(reading: str, run: Filling) -> Row:
    shown = "; ".join(
        f"{limit:g} V {both(run, 'overshoot', lane=at_limit(limit))}" for limit in SHOWN
    )
    return remark(
        "section 5",
        f"overshoot of conventional PID over the limit of the pumps, {reading}",
        "no limit is printed",
        shown,
        "%",
        reason="h1 and h2, with a limiter at the output and nothing against windup. "
        f"{_HOW[reading]}{_SETTINGS}",
    )


def _five(reading: str, runs: dict[str, Filling]) -> Row:
    lane = at_limit(USUAL)
    return remark(
        "section 5",
        f"five ways against windup with pumps up to {USUAL:g} V, {reading}",
        "only conventional PID is compared with",
        "; ".join(
            f"{WAYS[way]}: overshoot {both(run, 'overshoot', lane=lane)} %, rise "
            f"{both(run, 'rise', lane=lane)} s, settling {both(run, 'settling', '.0f', lane)} s, "
            "at a limit "
            f"{run.saturated(1, USUAL, lane):.1f} and {run.saturated(2, USUAL, lane):.1f} s"
            for way, run in runs.items()
        ),
        reason="Of h1 and h2, rise from 10 to 90 %, settling to 2 %, and of pumps 1 and 2. "
        f"{_HOW[reading]}{_SETTINGS} {_RULES}",
    )


def _sooner(reading: str, runs: dict[str, Filling]) -> Row:
    new = runs["variable_structure"]
    found = []
    for way, old in runs.items():
        if way == "variable_structure":
            continue
        wins = np.array(
            [
                all(sooner(new.settling(j, lane), old.settling(j, lane)) for j in (1, 2))
                for lane in range(len(LIMITS))
            ]
        )
        found.append(f"{WAYS[way]}: {ranges(wins)}")
    return remark(
        "section 5",
        f"limits at which both levels settle sooner with variable structure, {reading}",
        "no limit is printed",
        "; ".join(found),
        "V",
        reason=f"To 2 %. {_HOW[reading]}{_SETTINGS} {_RULES} Limits from 4 to 20 V in steps of 0.5 "
        f"V, sooner by a sampling period or more; from {_free(runs[CONVENTIONAL]):g} V on no pump "
        "saturates, and all are alike.",
    )


def _free(run: Filling) -> float:
    """Return the lowest limit at which no pump stands at it [V]."""
    free = [
        all(run.saturated(pump, limit, lane) < _SHORTEST for pump in (1, 2))
        for lane, limit in enumerate(map(float, LIMITS))
    ]
    return float(LIMITS[free.index(True)])


def _figure(reading: str, runs: dict[str, Filling]) -> Figure:
    def panel(title: str, label: str, value: Callable[[Filling, int], float]) -> Panel:
        curves = [
            Curve(WAYS[way], LIMITS, np.array([value(run, lane) for lane in range(len(LIMITS))]))
            for way, run in runs.items()
        ]
        return Panel(title, label, tuple(curves), x_label="upper limit of the pumps [V]")

    return Figure(
        "",
        f"Five ways against windup over the limit of the pumps, {reading}",
        (
            panel("Overshoot of h1", "[%]", lambda run, lane: run.overshoot(1, lane)),
            panel("Rise time of h1", "[s]", lambda run, lane: run.rise(1, lane)),
            panel("Settling time of h1, 2 %", "[s]", lambda run, lane: run.settling(1, lane)),
            panel("Settling time of h2, 2 %", "[s]", lambda run, lane: run.settling(2, lane)),
            panel(
                "Time of v1 at a limit",
                "[s]",
                lambda run, lane: run.saturated(1, float(LIMITS[lane]), lane),
            ),
        ),
        "From empty to 12.4 and 12.7 cm. The target needs 3 V: below 5 V there is hardly room, "
        "above 18 V nothing saturates. Variable structure takes its integral back while a pump "
        "saturates, so that the pump leaves its limit early and the level creeps up. "
        + _NOTES[reading],
    )
