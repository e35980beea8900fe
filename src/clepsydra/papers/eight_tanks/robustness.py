"""How robust the six designs are on the true chain, beside a plain sampled PID controller."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.amigo import design_amigo
from clepsydra.designs.loops.pairing import paired_loops
from clepsydra.designs.models.reaction_curve import reaction_curve
from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.designs.simc import design_simc
from clepsydra.designs.smith_predictor import design_smith_predictor
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.six_designs import (
    MINUTE,
    SIX,
    StepRun,
    chain,
    designed,
    stepped,
    trends,
    without_limits,
)
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.row import Row
from clepsydra.papers.settling_bands import BANDS
from clepsydra.studies.warnings.loop_response import loop_response

#: The usual limits of max|S| and of the gain margin for a robust loop.
_ROBUST = 2.0
#: Bounds by which the verdict is the same.
_LENIENT_PEAK, _LENIENT_GAIN = 3.0, 1.5
_LARGEST_GAIN = 100.0
#: A PID that settles as soon as the predictor: its times as shares of AMIGO's, and its max|S|.
_TUNED = {"level_8.integral_time": 1.15, "level_8.derivative_time": 0.9}
_TUNED_PEAK = 1.6


@dataclass(frozen=True, eq=False)
class Judged:
    """One controller on the true chain: its step, max|S| and gain margin."""

    label: str
    run: StepRun
    peak: float
    gain_margin: float


def judged(label: str, controller: Controller) -> Judged:
    """Return margins and step response of a controller."""
    response = loop_response(controller, chain().model)
    channel = response.channels["level_8"]
    return Judged(
        label, stepped(controller), response.loop.maximum_sensitivity, channel.gain_margin.value
    )


@cache
def _six() -> tuple[Judged, ...]:
    return tuple(judged(choice.label, designed(choice.penalty, (choice.pole,))) for choice in SIX)


@cache
def others() -> tuple[Judged, ...]:
    """Return plain PID control, and predictors that are designed to max|S| = 2."""
    model, pairing = chain().model, chain().pairing
    controllers = {
        "PID, AMIGO": amigo(),
        "PID, SIMC": design_simc(model, pairing, form=PidForm("PID")),
        "predictor, LQ, d = 7, max|S| ≤ 2": design_smith_predictor(model, pairing),
        "predictor, PI, d = 7, max|S| ≤ 2": design_smith_predictor(model, pairing, primary="PI"),
    }
    found = tuple(judged(label, without_limits(each)) for label, each in controllers.items())
    return (*found, judged(f"PID, tuned, max|S| ≤ {_TUNED_PEAK:g}", tuned_pid()))


@cache
def amigo(setpoint_weight: float = 1.0) -> Controller:
    """Return AMIGO's PID, with a share of the setpoint in its proportional part."""
    model, pairing = chain().model, chain().pairing
    plain = without_limits(design_amigo(model, pairing, form=PidForm("PID")))
    return _set_to(plain, plain.values | {"level_8.setpoint_weight": setpoint_weight})


def tuned_pid() -> Controller:
    """Return a PID that settles soon: AMIGO's with other times, its gain by max|S|."""
    plain, model = amigo(), chain().model
    times = {name: factor * plain.values[name] for name, factor in _TUNED.items()}
    loops = SampledLoops(plain, model)

    def with_gain(share: float) -> dict[str, float]:
        gain = share * plain.values["level_8.proportional_gain"]
        return plain.values | times | {"level_8.proportional_gain": gain}

    low, high = 0.5, 2.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        robust = loops.at(with_gain(middle)).maximum_sensitivity <= _TUNED_PEAK
        low, high = (middle, high) if robust else (low, middle)
    return _set_to(plain, with_gain(low))


def _set_to(controller: Controller, values: dict[str, float]) -> Controller:
    """Return a controller with other settings, at rest with them before the step."""
    rest = state_at_rest(controller.law, values, chain().operating_point.as_dict())
    return dataclasses.replace(controller, values=values, initial_state=rest)


def run() -> Found:
    """Return the rows on robustness and quality, with two pictures."""
    return (_robust(), _quality(), _margins(), _beside_pid())


def _robust() -> Row:
    weak = [design for design in _six() if design.peak > _ROBUST and design.gain_margin < _ROBUST]
    assert all(
        design.peak > _LENIENT_PEAK and design.gain_margin < _LENIENT_GAIN for design in weak
    )
    line = PRINTED["section 7", "robustness of Figs. 7 to 12"]
    return line.claimed(
        not weak,
        f"max|S| {', '.join(f'{design.peak:.2f}' for design in _six())}; gain margin "
        + ", ".join(f"{design.gain_margin:.2f}" for design in _six()),
        robust=_ROBUST,
        weak=len(weak),
        designs=len(SIX),
        peak=_LENIENT_PEAK,
        margin=_LENIENT_GAIN,
    )


def _quality() -> Row:
    (loop,) = paired_loops(chain().model, chain().pairing)
    curve = reaction_curve(
        loop.element, 0.5 * chain().operating_point.process.sampling_period
    ).model
    pid, unweighted = others()[0], judged("setpoint weight 0", amigo(0.0))
    later, slow = (
        sum(each.run.settling_time > one.run.settling_time for each in _six())
        for one in (pid, unweighted)
    )
    wide = BANDS[1]
    soonest = min(each.run.settled(wide) for each in _six())
    assert soonest > max(each.run.settled(wide) for each in (pid, unweighted))
    return PRINTED["section 7", "control quality"].remark(
        f"settled to 2 % after {', '.join(map(_minutes, _six()))} min in Figs. 7 to 12; overshoot "
        f"{', '.join(f'{each.run.overshoot:.1f}' for each in _six())} %",
        later=later,
        slow=slow,
        pid=_minutes(pid),
        unweighted=_minutes(unweighted),
        widely=", ".join(_minutes(each, wide) for each in _six()),
        pid_widely=_minutes(pid, wide),
        unweighted_widely=_minutes(unweighted, wide),
        lag=curve.time_constant / MINUTE,
        delay=curve.delay / MINUTE,
    )


def _minutes(design: Judged, band: float = BANDS[0]) -> str:
    value = design.run.settled(band)
    return f"{value:.0f}" if math.isfinite(value) else "more than 240"


def _margins() -> Figure:
    every = (*_six(), *others())
    places = np.arange(len(every)) + 1.0

    def panel(title: str, label: str, values: list[float], *more: Curve) -> Panel:
        six, others = (slice(0, len(SIX)), slice(len(SIX), len(every)))
        found = np.array(values)
        points = (
            Curve("six designs", places[six], found[six], "points"),
            Curve("others", places[others], found[others], "points"),
        )
        return Panel(title, label, (*points, *more), "controller")

    names = "; ".join(f"{place}: {design.label}" for place, design in enumerate(every, start=1))
    limit = Curve("usual limit", places, 0.0 * places + _ROBUST, "dashed")
    errors = [100.0 * (design.gain_margin - 1.0) for design in every]
    times = [design.run.settling_time for design in every]
    return Figure(
        "",
        "Robustness of the six designs on the true chain, and of other controllers",
        (
            panel("Sensitivity peak", "max|S| [1]", [design.peak for design in every], limit),
            panel("Largest stable error of the gain", "error [%]", errors),
            panel("Time to settle to 2 %", "time [min]", times),
        ),
        names + ".",
    )  # fmt: skip


def _beside_pid() -> Figure:
    best = min(_six(), key=lambda design: design.run.settling_time)
    pid, _, tuned, _, other = others()
    panels = trends({each.label: each.run for each in (best, tuned, pid, other)}, until=120)
    return Figure("", "A plain PID on the same chain", panels, "Per metre of a setpoint step.")
