"""The choice of α: the document's 0.1 against its own rule, and what α does."""

from __future__ import annotations

import numpy as np

from clepsydra.design.sampled.setpoint_response import settling_times
from clepsydra.design.saturation_rate import times_faster
from clepsydra.design.states.measured_states import with_outputs
from clepsydra.linear.relative_degree import relative_degree
from clepsydra.papers.comparison import claimed
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.four_tank_variable_structure.rig import (
    ALPHA,
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


def alpha() -> Findings:
    """Judge α = 0.1 by the rule of section 4, and fill the tanks with many an α."""
    lanes = {f"controller.saturation_rate_{j}": RATES for j in (1, 2)}
    volts = fill(in_volts("variable_structure"), LIMIT, parameters=lanes)
    nu = fill(in_nu("variable_structure"), LIMIT, parameters=lanes)
    stopped = fill(in_volts("conditional_integration"), LIMIT)
    rows = [*_rule(), _adjusts(volts), *_limit_of_small_rates(volts, stopped)]
    return Findings(tuple(rows), (_figure(volts, nu),))


def _rule() -> list[Row]:
    model = at_target().model
    effects = np.abs(np.diag(relative_degree(model).at_point))
    rows = []
    for words, controller, rates in (
        ("PI controllers in volts", in_volts("none"), [ALPHA, ALPHA]),
        ("linearised, α in ν", in_nu("none"), [ALPHA, ALPHA]),
        (
            "linearised, α in volts",
            in_nu("none"),
            # Of a level in centimetres: 0.1 cm/s² of ν per volt of excess.
            [ALPHA / (100.0 * effect / VOLTS_PER_METRE) for effect in effects],
        ),
    ):
        settling = settling_times(controller, with_outputs(model, controller.measurements))
        for j, (name, rate) in enumerate(zip(model.outputs, rates, strict=True), start=1):
            times = times_faster(rate, settling[name])
            rows.append(
                claimed(
                    "section 4, (2)",
                    f"α = 0.1 of loop {j}, {words}",
                    "2 to 5 times faster than the closed loop",
                    2.0 <= times <= 5.0,
                    f"{times:.2f}",
                    "times",
                    reason=f"The excess dies away with {rate:.2g} 1/s, the loop settles to 2 % in "
                    f"{settling[name]:.0f} s; settling times are compared. "
                    + (
                        "Whether α acts in volts or in ν changes it twelvefold or more."
                        if "linearised" in words
                        else "Johansson's settings."
                    ),
                )
            )
    return rows


def _adjusts(volts: Filling) -> Row:
    settled = np.array([volts.settling(1, lane) for lane in range(len(RATES))])
    best = int(np.argmin(settled))
    return claimed(
        "section 4, (2)",
        "settling time of h1 over α",
        "α can easily adjust the closed-loop performance",
        float(settled.max()) > 1.2 * float(settled.min()),
        f"{settled.min():.0f} (α = {RATES[best]:.2g}) to {settled.max():.0f}",
        "s",
        reason="α from 0.001 to 10 1/s, pumps up to 10 V, in volts. The larger α, the earlier "
        "the pump leaves its limit, and the later the level comes.",
    )


def _limit_of_small_rates(volts: Filling, stopped: Filling) -> list[Row]:
    rows = []
    for j in (1, 2):
        settled, plain = volts.settling(j, len(RATES) - 1), stopped.settling(j)
        at_rule = volts.settling(j, int(np.argmin(np.abs(RATES - ALPHA))))
        rows.append(
            claimed(
                "section 4, (3)",
                f"settling of h{j} for what α adds to stopping the integral",
                "returns faster than the normal saturation method",
                at_rule < plain,
                f"{at_rule:.0f} (α = 0.1), {settled:.0f} (α = 10), {plain:.0f} (stopped)",
                "s",
                reason="With α = 0 the rule is conditional integration. The pump does return to "
                "its range sooner with α, but the level does not come sooner.",
            )
        )
    return rows


def _figure(volts: Filling, nu: Filling) -> Figure:
    def panel(title: str, label: str, what: str) -> Panel:
        curves = []
        for name, run in (("in volts", volts), ("linearised, α in ν", nu)):
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
        "A large α takes the overshoot away and makes the rise slow.",
    )
