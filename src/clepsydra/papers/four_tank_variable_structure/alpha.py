"""The choice of α: the document's 0.1 against its own rule, and what α does."""

from __future__ import annotations

import numpy as np

from clepsydra.designs.sampled.setpoint_response import settling_times
from clepsydra.designs.saturation_rate import times_faster
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.linear.relative_degree import relative_degree
from clepsydra.papers.comparison import claimed, remark
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.decoupled import at_limit, decoupled
from clepsydra.papers.four_tank_variable_structure.readings import READINGS, USUAL, both, filled
from clepsydra.papers.four_tank_variable_structure.rig import (
    ALPHA,
    IN_WORDS,
    VOLTS_PER_METRE,
    Filling,
    at_target,
    fill,
    in_nu,
    in_volts,
)
from clepsydra.papers.row import Row

#: [1/s]
RATES = np.geomspace(1e-3, 10.0, 41)
LIMIT = 10.0
_BIASED = USUAL._replace(bias=3.0)
_HOW = f"Johansson's PI controllers ({IN_WORDS})"


def alpha() -> Findings:
    """Judge α = 0.1 by the rule of section 4, and fill the tanks with many an α."""
    lanes = {f"controller.saturation_rate_{j}": RATES for j in (1, 2)}
    volts = fill(in_volts("variable_structure"), LIMIT, parameters=lanes)
    nu = fill(in_nu("variable_structure"), LIMIT, parameters=lanes)
    rows = [_rule(), _adjusts(volts, nu), _limit_of_small_rates(volts)]
    return Findings(tuple(rows), (_figure(volts, nu),))


def _rule() -> Row:
    model = at_target().model
    effects = np.abs(np.diag(relative_degree(model).at_point))
    found = []
    for words, controller, rates in (
        ("without decoupling", in_volts("none"), [ALPHA, ALPHA]),
        ("after decoupling, α in ν", in_nu("none"), [ALPHA, ALPHA]),
        (
            "after decoupling, α in volts",
            in_nu("none"),
            # Of a level in centimetres: 0.1 cm/s² of ν per volt of excess.
            [ALPHA / (100.0 * effect / VOLTS_PER_METRE) for effect in effects],
        ),
    ):
        settling = settling_times(controller, with_outputs(model, controller.measurements))
        times = [
            times_faster(rate, settling[name])
            for name, rate in zip(model.outputs, rates, strict=True)
        ]
        found.append(f"{words} {times[0]:.1f} and {times[1]:.1f}")
    return remark(
        "section 4, feature (2)",
        "α = 0.1 by the rule of experience",
        "2 to 5 times faster than the design of the closed-loop system; that 0.1 is so is not said",
        "; ".join(found),
        "times",
        reason=f"Loops 1 and 2 under {_HOW} at 0.5 V/cm, on the linear model with both loops "
        "closed: the time to 2 % without saturation over that in which what exceeds the range dies "
        "away to 2 %. Whether α acts in volts or in ν changes it twelvefold or more.",
    )


def _adjusts(volts: Filling, nu: Filling) -> Row:
    settled = [
        np.array([run.settling(1, lane) for lane in range(len(RATES))]) for run in (volts, nu)
    ]
    ranges = [
        f"{each.min():.3g} (α = {RATES[int(np.argmin(each))]:.2g}) to {each.max():.3g} "
        f"(α = {RATES[int(np.argmax(each))]:.2g})"
        for each in settled
    ]
    return claimed(
        "section 4, feature (2)",
        "settling time of h1 over α",
        "can easily adjust the closed-loop performance index",
        all(float(each.max()) > 2.0 * float(each.min()) for each in settled),
        f"without decoupling {ranges[0]}; after decoupling, α in ν {ranges[1]}",
        "s",
        reason=f"To 2 %, α from 0.001 to 10 1/s, pumps up to 10 V, {_HOW} in volts, or times E for "
        "ν of (9), at 0.5 V/cm, K_1 of (14) as K/Ti, from empty tanks with integrals that start at "
        "zero: the longest is more than twice the shortest, which is judged. Without decoupling a "
        "larger α comes later, after it sooner at first.",
    )


def _limit_of_small_rates(volts: Filling) -> Row:
    usual, biased, after = READINGS.index(USUAL), READINGS.index(_BIASED), at_limit(LIMIT)
    new, old = filled("variable_structure"), filled("conditional_integration")
    nu = decoupled("variable_structure"), decoupled("conditional_integration")
    found = (
        ("α = 0.1", new, usual),
        ("α = 10", volts, len(RATES) - 1),
        ("α = 0", old, usual),
    )
    return remark(
        "section 4, feature (3)",
        "settling time with α = 0.1 and without",
        "only the return of the pump is spoken of",
        "; ".join(f"{name}: {both(run, 'settling', '.0f', lane)}" for name, run, lane in found),
        "s",
        reason=f"h1 and h2 to 2 %, pumps up to 10 V, {_HOW} in volts at 0.5 V/cm without "
        "decoupling, from empty tanks with integrals that start at zero. With α = 0 the rule is "
        "conditional integration: with α = 0.1 the pump is back in its range sooner, but the level "
        "is not. It is with integrals that start at the 3 V of the target, "
        f"{both(new, 'settling', '.0f', biased)} s after {both(old, 'settling', '.0f', biased)} s, "
        f"and after decoupling by (9), {both(nu[0], 'settling', '.0f', after)} s after "
        f"{both(nu[1], 'settling', '.0f', after)} s.",
    )


def _figure(volts: Filling, nu: Filling) -> Figure:
    def panel(title: str, label: str, what: str) -> Panel:
        curves = []
        for name, run in (("without decoupling", volts), ("after decoupling", nu)):
            for j in (1, 2):
                values = [getattr(run, what)(j, lane) for lane in range(len(RATES))]
                curves.append(Curve(f"h{j}, {name}", RATES, np.array(values)))
        return Panel(title, label, tuple(curves), x_label="α [1/s]", logarithmic_x=True)

    return Figure(
        "",
        "What α does, with pumps up to 10 V",
        (
            panel("Overshoot", "[%]", "overshoot"),
            panel("Settling time, 2 %", "[s]", "settling"),
            panel("Rise time", "[s]", "rise"),
        ),
        "A large α takes the overshoot away and makes the rise slow. After decoupling α is in ν.",
    )
