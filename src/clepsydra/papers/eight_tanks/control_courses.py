"""Section 6: the six experiments on the true chain, Figs. 7 to 12, and the trends claimed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.polynomials import controller
from clepsydra.papers.eight_tanks.predictor import closed_loop_radius
from clepsydra.papers.eight_tanks.six_designs import (
    PENALTIES,
    POLES,
    SIX,
    Choice,
    StepRun,
    printed_model,
    sampled_chain,
    step_run,
    trends,
    turns,
)
from clepsydra.papers.figure import Curve, Figure
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.settling_bands import BANDS
from clepsydra.scores.step_response import rise_time

_HORIZON = 160  # [min], ours
_GROWING = (1.0, 10.0, 100.0, 1e4, 1e6)  # q_u, ours
#: Words, unit and value of something that a trend is told by.
_Measure = tuple[str, str, Callable[[StepRun], float]]
_FIRST: _Measure = (
    "first move of the inflow",
    "% of its largest",
    lambda run: 100.0 * float(run.inflow[0]) / float(run.inflow.max()),
)
_LATER: _Measure = (
    "largest later move in a minute",
    "%",
    lambda run: 100.0 * float(np.max(np.abs(np.diff(run.inflow))) / run.inflow.max()),
)
_OF_Y: tuple[_Measure, ...] = (
    ("swings of the level", "", lambda run: turns(run.level, 0.02)),
    ("overshoot", "%", lambda run: run.overshoot),
)
_OF_U: tuple[_Measure, ...] = (
    ("swings of the inflow", "", lambda run: run.swings),
    ("its total variation", "m³/min/m", lambda run: run.total_variation),
)
#: Place and name of each trend, in which experiments, by what, and whether that rises or falls.
_TRENDS: tuple[tuple[str, str, Sequence[Choice], Sequence[_Measure], int], ...] = (
    ("section 6.1", "oscillations of y by γ", POLES, _OF_Y, -1),
    ("section 6.1", "oscillations of u by γ", POLES, _OF_U, -1),
    ("section 6.2", "inflow by q_u", PENALTIES, (_FIRST, _LATER), -1),
    ("section 6.2", "oscillations by q_u", PENALTIES, (*_OF_Y, *_OF_U), -1),
)
#: Place and name of what is said of the speed of the level, and in which experiments.
_SLOWER = (
    ("section 6.1", "output by γ", POLES),
    ("section 6.2", "output by q_u", PENALTIES),
)


def run() -> Found:
    """Return the rows of section 6 and Figs. 7 to 12."""
    rows = (*_slower(), *_trends(), _amplitude(), _damped(), _prevented(), _criterion())
    return (*rows, *map(_figure, SIX))


def _slower() -> Rows:
    """Compare the rise of the level, which is longer, and the time to settle, which is not."""
    for place, name, choices in _SLOWER:
        runs = [choice.run for choice in choices]
        rise = [rise_time(run.minutes, run.level, 0.0, 1.0) for run in runs]
        settled = [[run.settled(band) for run in runs] for band in BANDS]
        assert all(later > earlier for earlier, later in pairwise(rise))
        assert all(times[-1] < times[0] for times in settled)
        near, wide = (", ".join(f"{time:.0f}" for time in times) for times in settled)
        yield PRINTED[place, name].remark(
            f"rise time from 10 to 90 % {', '.join(f'{time:.3g}' for time in rise)} min",
            settings="; ".join(choice.label for choice in choices),
            ends=f"{choices[-1].label} than where {choices[0].label}",
            settled=near,
            widely=wide,
        )


def _trends() -> Rows:
    for place, name, choices, measures, sign in _TRENDS:
        found, holds = [], True
        for what, unit, of in measures:
            values = [of(choice.run) for choice in choices]
            holds &= all(sign * later > sign * earlier for earlier, later in pairwise(values))
            shown = ", ".join(f"{value:.3g}" for value in values)
            found.append(f"{what} {shown} {unit}".strip())
        settings = "; ".join(choice.label for choice in choices)
        yield PRINTED[place, name].claimed(holds, "; ".join(found), settings=settings)


def _amplitude() -> Row:
    choices = sorted((*PENALTIES, POLES[1]), key=lambda choice: choice.penalty)
    peaks = [choice.run.largest_inflow for choice in choices]
    return PRINTED["section 5", "amplitude of the controller output"].claimed(
        all(a > b for a, b in pairwise(peaks)), ", ".join(f"{peak:.3f}" for peak in peaks)
    )


def _damped() -> Row:
    """Ask whether oscillations and instability are less with a larger penalty."""
    holds, found = True, []
    for pole in (choice.pole for choice in POLES):
        radii = [
            closed_loop_radius(
                controller(penalty, (pole,), full=False), printed_model(), sampled_chain()
            )
            for penalty in (0.01, 1.0)
        ]
        runs = [step_run(penalty, (pole,)) for penalty in _GROWING]
        swings = [[turns(run.level, 0.02) for run in runs], [run.swings for run in runs]]
        holds &= radii[0] > 1.0 > radii[1]
        holds &= all(a >= b for each in swings for a, b in pairwise(each))
        level, inflow = (", ".join(map(str, each)) for each in swings)
        found.append(
            f"γ = {pole:g}: root {radii[0]:.3f}, {radii[1]:.3f}; level {level}; inflow {inflow}"
        )
    line = PRINTED["section 5", "oscillations and instability by q_u"]
    return line.claimed(holds, "; ".join(found))


def _criterion() -> Row:
    """What (26) grows by in each of the last samples of the experiments."""
    shares = [choice.penalty * float(np.mean(choice.run.inflow[-60:] ** 2)) for choice in SIX]
    line = PRINTED["(26)", "criterion that the method minimises"]
    return line.remark(", ".join(f"{share:.3g}" for share in shares))


def _prevented() -> Row:
    swings = {
        pole: [step_run(penalty, (pole,)).swings for penalty in _GROWING] for pole in (0.5, 0.9)
    }
    told = (f"γ = {pole:g}: {', '.join(map(str, each))} swings" for pole, each in swings.items())
    line = PRINTED["section 7", "penalisation of the manipulated variable"]
    return line.claimed(any(0 in each for each in swings.values()), "; ".join(told))


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
