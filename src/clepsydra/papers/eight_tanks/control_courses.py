"""Section 6: the six experiments on the true chain, Figs. 7 to 12, and the trends claimed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.six_designs import (
    PENALTIES,
    POLES,
    SIX,
    Choice,
    StepRun,
    step_run,
    trends,
    turns,
)
from clepsydra.papers.figure import Curve, Figure
from clepsydra.papers.row import Row, Rows
from clepsydra.scores.step_response import rise_time

_HORIZON = 160  # [min], ours
_COUNTED = " A swing is a turn by more than 2 % of the final value, in 240 min."
_VARIED = " The variation is that after the first move."


def run() -> Found:
    """Return the rows of section 6 and Figs. 7 to 12."""
    return (*_trends(), _amplitude(), _prevented(), *map(_figure, SIX))


class _Measure(NamedTuple):
    """Something of a course that a trend is told by."""

    what: str
    unit: str
    of: Callable[[StepRun], float]


_RISE = _Measure(
    "rise time from 10 to 90 %", "min", lambda run: rise_time(run.minutes, run.level, 0.0, 1.0)
)
_SPEED = _Measure(
    "first move of the inflow",
    "% of its largest",
    lambda run: 100.0 * float(run.inflow[0]) / float(run.inflow.max()),
)
_LEVEL_SWINGS = _Measure("swings of the level", "", lambda run: float(turns(run.level, 0.02)))
_OVERSHOOT = _Measure("overshoot", "%", lambda run: run.overshoot)
_SWINGS = _Measure("swings of the inflow", "", lambda run: float(run.swings))
_VARIATION = _Measure("its total variation", "m³/min/m", lambda run: run.total_variation)


def _trends() -> Rows:
    of_y = _LEVEL_SWINGS, _OVERSHOOT
    of_u = _SWINGS, _VARIATION
    yield _trend("section 6.1", "output by γ", POLES, (_RISE,), rises=True)
    yield _trend("section 6.1", "oscillations of y by γ", POLES, of_y)
    yield _trend("section 6.1", "oscillations of u by γ", POLES, of_u)
    yield _trend("section 6.2", "output by q_u", PENALTIES, (_RISE,), rises=True)
    yield _trend("section 6.2", "inflow by q_u", PENALTIES, (_SPEED,))
    yield _trend("section 6.2", "oscillations by q_u", PENALTIES, (*of_y, *of_u))


def _trend(
    place: str,
    name: str,
    choices: Sequence[Choice],
    measures: Sequence[_Measure],
    *,
    rises: bool = False,
) -> Row:
    found, holds = [], True
    for measure in measures:
        values = [measure.of(choice.run) for choice in choices]
        steps = [later - earlier for earlier, later in pairwise(values)]
        holds &= all(step > 0.0 if rises else step < 0.0 for step in steps)
        shown = ", ".join(f"{value:.3g}" for value in values)
        found.append(f"{measure.what} {shown} {measure.unit}".strip())
    settings = "; ".join(choice.label for choice in choices)
    words = _COUNTED if any("swings" in each.what for each in measures) else ""
    if _VARIATION in measures:
        words += _VARIED
    if _RISE in measures:
        words = " From the samples, one a minute, joined by lines."
    if _SPEED in measures:
        words = " Slower is read as: its first move is a smaller share of its largest value."
    return PRINTED[place, name].claimed(
        holds, "; ".join(found), reason=f"After a step of the setpoint, on (8): {settings}.{words}"
    )


def _amplitude() -> Row:
    choices = sorted((*PENALTIES, POLES[1]), key=lambda choice: choice.penalty)
    peaks = [choice.run.largest_inflow for choice in choices]
    return PRINTED["section 5", "amplitude of the controller output"].claimed(
        all(a > b for a, b in pairwise(peaks)), ", ".join(f"{peak:.3f}" for peak in peaks)
    )


def _prevented() -> Row:
    penalties = (1.0, 10.0, 100.0, 1e4, 1e6)
    swings = {
        pole: ", ".join(str(step_run(penalty, (pole,)).swings) for penalty in penalties)
        for pole in (0.5, 0.9)
    }
    return PRINTED["section 7", "penalisation of the manipulated variable"].remark(
        "; ".join(f"γ = {pole:g}: {counts} swings" for pole, counts in swings.items()),
        reason="For q_u = 1, 10, 100, 10⁴, 10⁶, on the chain (8)."
        f"{_COUNTED} It holds with γ = 0.9, and fails with γ = 0.5, with which the document varies "
        "q_u.",
    )


def _figure(choice: Choice) -> Figure:
    run = choice.run
    level, inflow = trends({"": run}, until=_HORIZON)
    minutes = level.curves[0].x
    setpoint = Curve("setpoint w", minutes, 0.0 * minutes + 1.0, "dashed")
    return Figure(
        choice.figure,
        f"Control courses for {choice.label}",
        (
            replace(level, curves=(setpoint, replace(level.curves[0], label="level y"))),
            replace(inflow, curves=[replace(inflow.curves[0], label="inflow u")]),
        ),
        "Per metre of a setpoint step: the loop is linear, and the document prints no size. "
        f"Overshoot {run.overshoot:.1f} %, settled to 2 % after {run.settling_time:.0f} min, "
        f"{run.swings} swings of the inflow.",
    )
