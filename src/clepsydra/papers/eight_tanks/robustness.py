"""How robust the six designs are on the true chain, beside a plain sampled PID controller."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.design.amigo import design_amigo
from clepsydra.design.simc import design_simc
from clepsydra.design.smith_predictor import design_smith_predictor
from clepsydra.papers.comparison import claimed
from clepsydra.papers.eight_tanks.polynomials import controller as primary
from clepsydra.papers.eight_tanks.predictor_structure import closed_loop_radius
from clepsydra.papers.eight_tanks.six_designs import (
    MINUTE,
    SIX,
    StepRun,
    chain,
    designed,
    printed_model,
    sampled_chain,
    stepped,
    without_limits,
)
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.row import Row
from clepsydra.study.warnings.loop_response import loop_response

#: The usual limit of max|S| for a robust loop.
_ROBUST = 2.0
_LARGEST_GAIN = 100.0


@dataclass(frozen=True, eq=False)
class Judged:
    """One controller on the true chain.

    Parameters
    ----------
    label : str
    run : StepRun
    peak : float
        max|S|
    gain_margin : float
    dead_time_margin : float
        How much more dead time the loop bears [min].
    """

    label: str
    run: StepRun
    peak: float
    gain_margin: float
    dead_time_margin: float

    def in_words(self) -> str:
        """Return it in short."""
        return (
            f"max|S| {self.peak:.2f}, gain margin {self.gain_margin:.2f}, dead time "
            f"+{self.dead_time_margin:.1f} min"
        )


def judged(label: str, controller: Controller) -> Judged:
    """Return margins and step response of a controller."""
    response = loop_response(controller, chain().model)
    channel = response.channels["level_8"]
    phase = channel.phase_margin
    return Judged(
        label,
        stepped(controller),
        response.loop.maximum_sensitivity,
        channel.gain_margin.value,
        phase.value / phase.frequency / MINUTE,
    )


@cache
def _six() -> tuple[Judged, ...]:
    return tuple(judged(choice.label, designed(choice.penalty, (choice.pole,))) for choice in SIX)


@cache
def _others() -> tuple[Judged, ...]:
    """Return plain PID control, and predictors that are designed to max|S| = 2."""
    model, pairing = chain().model, chain().pairing
    controllers = {
        "PID, AMIGO": design_amigo(model, pairing, form=PidForm("PID")),
        "PID, SIMC": design_simc(model, pairing, form=PidForm("PID")),
        "predictor, LQ, d = 7, max|S| ≤ 2": design_smith_predictor(model, pairing),
        "predictor, PI, d = 7, max|S| ≤ 2": design_smith_predictor(model, pairing, primary="PI"),
    }
    return tuple(judged(label, without_limits(each)) for label, each in controllers.items())


def largest_gain(choice_penalty: float, pole: float) -> float:
    """Return the largest gain of the chain, as a share of its own, that a design bears.

    By the roots of the characteristic polynomial, without a frequency response.
    """
    found = primary(choice_penalty, (pole,), full=False)

    def stable(factor: float) -> bool:
        model = printed_model()
        return closed_loop_radius(found, model, sampled_chain(3.08 * factor)) < 1.0

    low, high = 1.0, 1.05
    while stable(high) and high < _LARGEST_GAIN:
        low, high = high, 1.05 * high
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def run() -> Findings:
    """Return the rows on robustness and quality, with two pictures."""
    return Findings((*_robust(), *_quality()), (_margins(), _beside_pid()))


def _robust() -> list[Row]:
    rows = []
    for choice, design in zip(SIX, _six(), strict=True):
        bears = largest_gain(choice.penalty, choice.pole)
        rows.append(
            claimed(
                "section 7", f"robustness of {choice.figure}, {choice.label}",
                "very good robustness", design.peak <= _ROBUST, design.in_words(),
                reason=(
                    f"On the true chain; a robust loop has max|S| up to {_ROBUST:g}. This one "
                    f"becomes unstable when the chain's gain is {100 * (bears - 1):.0f} % larger "
                    "than in (8)."
                ),
            )
        )  # fmt: skip
    pid = _others()[0]
    better = sum(design.peak < pid.peak for design in _six())
    rows.append(
        claimed(
            "section 7", "robustness beside a plain PID",
            "very good robustness of the LQ algorithm",
            better == len(SIX), f"{better} of {len(SIX)} have a smaller max|S| than PID by AMIGO",
            reason=f"plain sampled PID on the same chain: {pid.in_words()}",
        )
    )  # fmt: skip
    return rows


def _quality() -> list[Row]:
    rows = []
    pid, _, tuned, with_pi = _others()
    sooner = [design for design in _six() if design.run.settling_time < pid.run.settling_time]
    rows.append(
        claimed(
            "section 7", "control quality beside a plain PID", "very good control quality",
            len(sooner) == len(SIX),
            f"{len(sooner)} of {len(SIX)} settle sooner than PID by AMIGO",
            reason=(
                f"Settled to 2 % after {', '.join(_minutes(design) for design in _six())} min in "
                f"Figs. 7 to 12, and {_minutes(pid)} min with the PID, which overshoots by "
                f"{pid.run.overshoot:.0f} %."
            ),
        )
    )  # fmt: skip
    best = min(_six(), key=lambda design: design.run.settling_time)
    rows.append(
        claimed(
            "section 7", "dead-time compensation beside a plain PID",
            "the digital predictor is good for such chains",
            tuned.run.settling_time < pid.run.settling_time and tuned.peak <= 2.001,
            f"{_minutes(tuned)} min at {tuned.in_words()}",
            reason=(
                "The same method with 7 samples of delay, by moments, and q_u and γ slowed down "
                f"until max|S| is 2; a PI controller in the predictor takes {_minutes(with_pi)} "
                f"min. The best of the six, {best.label}, takes {_minutes(best)} min."
            ),
        )
    )  # fmt: skip
    return rows


def _minutes(design: Judged) -> str:
    value = design.run.settling_time
    return f"{value:.0f}" if math.isfinite(value) else "more than 240"


def _margins() -> Figure:
    every = (*_six(), *_others())
    places = np.arange(len(every), dtype=float)
    six = slice(0, len(SIX))
    others = slice(len(SIX), len(every))

    def curves(values: list[float]) -> tuple[Curve, ...]:
        found = np.array(values)
        return (
            Curve("six designs", places[six] + 1.0, found[six], "points"),
            Curve("others", places[others] + 1.0, found[others], "points"),
        )

    names = "; ".join(f"{place}: {design.label}" for place, design in enumerate(every, start=1))
    limit = Curve("usual limit", places + 1.0, 0.0 * places + _ROBUST, "dashed")
    return Figure(
        "",
        "Robustness of the six designs on the true chain, and of other controllers",
        (
            Panel(
                "Sensitivity peak", "max|S| [1]",
                (*curves([design.peak for design in every]), limit), x_label="controller",
            ),
            Panel(
                "Largest stable error of the gain", "error [%]",
                curves([100.0 * (design.gain_margin - 1.0) for design in every]),
                x_label="controller",
            ),
            Panel(
                "Time to settle to 2 %", "time [min]",
                curves([design.run.settling_time for design in every]), x_label="controller",
            ),
        ),
        names + ".",
    )  # fmt: skip


def _beside_pid() -> Figure:
    best = min(_six(), key=lambda design: design.run.settling_time)
    pid, _, tuned, _ = _others()
    shown = (best, tuned, pid)
    until = 120
    return Figure(
        "",
        "A plain PID on the same chain",
        (
            Panel(
                "Level of tank 8", "y [m/m]",
                tuple(
                    Curve(each.label, each.run.minutes[:until], each.run.level[:until])
                    for each in shown
                ),
                x_label="time [min]",
            ),
            Panel(
                "Inflow", "u [m³/min/m]",
                tuple(
                    Curve(each.label, each.run.minutes[:until], each.run.inflow[:until], "held")
                    for each in shown
                ),
                x_label="time [min]",
            ),
        ),
        "Per metre of a setpoint step.",
    )  # fmt: skip
