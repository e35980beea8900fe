"""Pump limits from 4 to 20 V: where variable-structure PID wins, and where it loses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.papers.comparison import claimed
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.filling import ALMOST_NONE
from clepsydra.papers.four_tank_variable_structure.rig import WAYS, Filling, fill, in_nu, in_volts
from clepsydra.papers.row import Row

#: Of both pumps [V].
LIMITS = np.linspace(4.0, 20.0, 33)
SHOWN = (4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0)
_NOTES = {
    "in volts": "The tanks level off by themselves: conditional integration, which only stops the "
    "integral, settles sooner at nearly every limit.",
    "in ν": "The linearised tanks do not level off by themselves, and every PI controller "
    "overshoots: here what is taken back pays.",
}
_READINGS: dict[str, Callable[..., Controller]] = {"in volts": in_volts, "in ν": in_nu}


def pump_limits() -> Findings:
    """Fill the tanks with every way against windup and every limit."""
    runs = {
        reading: {way: fill(controller(way), LIMITS) for way in WAYS}
        for reading, controller in _READINGS.items()
    }
    rows = [row for limit in SHOWN for row in _at(limit, runs["in volts"])]
    for reading, found in runs.items():
        rows += [_against(way, found, reading) for way in WAYS if way != "variable_structure"]
    figures = tuple(_figure(reading, found) for reading, found in runs.items())
    return Findings(tuple(rows), figures)


def _at(limit: float, runs: dict[str, Filling]) -> list[Row]:
    lane = int(np.argmin(np.abs(LIMITS - limit)))
    new, old = runs["variable_structure"], runs["clamping"]
    settled = [(run.settling(1, lane), run.settling(2, lane)) for run in (new, old)]
    shot = [(run.overshoot(1, lane), run.overshoot(2, lane)) for run in (new, old)]
    return [
        claimed(
            "section 5",
            f"settling with pumps up to {limit:g} V",
            "the response is faster",
            all(a < b for a, b in zip(*settled, strict=True)),
            ", ".join(
                f"h{j} {settled[0][j - 1]:.0f} against {settled[1][j - 1]:.0f}" for j in (1, 2)
            ),
            "s",
            reason="To 2 %, variable structure (α = 0.1) against clamping, PI controllers in "
            "volts.",
        ),
        claimed(
            "section 5",
            f"overshoot with pumps up to {limit:g} V",
            "almost no overshoot",
            max(shot[0]) <= ALMOST_NONE,
            ", ".join(f"h{j} {shot[0][j - 1]:.1f} against {shot[1][j - 1]:.1f}" for j in (1, 2)),
            "%",
            reason="Where nothing saturates the structure never changes, and the PI controllers "
            "overshoot by themselves."
            if limit >= 15.0
            else "Variable structure against clamping, in volts.",
        ),
    ]


def _against(way: str, runs: dict[str, Filling], reading: str) -> Row:
    new, old = runs["variable_structure"], runs[way]
    wins = np.array(
        [
            all(new.settling(j, lane) < old.settling(j, lane) for j in (1, 2))
            for lane in range(len(LIMITS))
        ]
    )
    saturating = np.array(
        [
            any(old.saturated(j, limit, lane) > 0.0 for j in (1, 2))
            for lane, limit in enumerate(LIMITS)
        ]
    )
    return claimed(
        "section 6",
        f"settling of both levels against {WAYS[way]}, {reading}",
        "the superiority of this method",
        bool(np.all(wins[saturating])),
        _ranges(wins),
        "V",
        reason="Limits from 4 to 20 V, in steps of 0.5 V, at which both levels settle to 2 % "
        "sooner; superior is sooner at every limit that a pump reaches.",
    )


def _ranges(wins: np.ndarray) -> str:
    """Return the limits at which it wins, in words."""
    if not wins.any():
        return "at no limit"
    edges = np.flatnonzero(np.diff(np.concatenate([[0], wins.astype(int), [0]])))
    parts = [
        f"{LIMITS[first]:g}" if last - 1 == first else f"{LIMITS[first]:g} to {LIMITS[last - 1]:g}"
        for first, last in zip(edges[::2], edges[1::2], strict=True)
    ]
    return ", ".join(parts)


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
