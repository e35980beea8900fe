"""Section 6: the six experiments on the true chain, Figs. 7 to 12, and the trends claimed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from clepsydra.papers.comparison import claimed
from clepsydra.papers.eight_tanks.six_designs import (
    PENALTIES,
    POLES,
    SIX,
    Choice,
    StepRun,
    step_run,
)
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.row import Row
from clepsydra.scores.step_response import rise_time

_HORIZON = 160  # [min], ours


def run() -> Findings:
    """Return the rows of section 6 and Figs. 7 to 12."""
    return Findings((*_trends(), _amplitude(), _prevented()), tuple(map(_figure, SIX)))


def _run(choice: Choice) -> StepRun:
    return step_run(choice.penalty, (choice.pole,))


def _rise(run: StepRun) -> float:
    return rise_time(run.minutes, run.level, 0.0, 1.0)


def _inflow_rise(run: StepRun) -> float:
    """Return how fast the inflow reaches its first maximum, as a speed [m³/min/m per min]."""
    top = int(run.inflow.argmax())
    return float(run.inflow[top]) / (top + 1.0)


def _trends() -> list[Row]:
    by_penalty = sorted((*PENALTIES, POLES[1]), key=lambda choice: choice.penalty)
    rows = []
    for section, what, choices in (
        ("section 6.1", "γ = 0.01, 0.5, 0.9 with q_u = 10", POLES),
        ("section 6.2", "q_u = 1, 5, 10, 100 with γ = 0.5", by_penalty),
    ):
        rows += [
            _trend(section, f"slower output, {what}", "y slows down", choices, _rise, "rise time",
                   "min", rises=True),
            _trend(section, f"settling, {what}", "oscillations of y are suppressed", choices,
                   lambda r: r.settling_time, "settling time to 2 %", "min"),
            _trend(section, f"overshoot, {what}", "oscillations of y are suppressed", choices,
                   lambda r: r.overshoot, "overshoot", "%"),
            _trend(section, f"swings of the inflow, {what}", "oscillations of u are suppressed",
                   choices, lambda r: float(r.swings), "swings", ""),
            _trend(section, f"variation of the inflow, {what}", "oscillations of u are suppressed",
                   choices, lambda r: r.total_variation, "total variation", "m³/min/m"),
        ]  # fmt: skip
    rows.append(
        _trend("section 6.2", "slower inflow, q_u = 1, 5, 10, 100 with γ = 0.5", "u slows down",
               by_penalty, _inflow_rise, "speed to its maximum", "m³/min/m per min")
    )  # fmt: skip
    return rows


def _trend(
    place: str,
    name: str,
    claim: str,
    choices: Sequence[Choice],
    measure: Callable[[StepRun], float],
    what: str,
    unit: str,
    *,
    rises: bool = False,
) -> Row:
    values = [measure(_run(choice)) for choice in choices]
    steps = [later - earlier for earlier, later in pairwise(values)]
    holds = all(step > 0.0 if rises else step < 0.0 for step in steps)
    return claimed(
        place, name, claim, holds, ", ".join(f"{value:.3g}" for value in values), unit,
        reason=f"{what} after a step of the setpoint, the predictor with (21) on the true chain",
    )  # fmt: skip


def _amplitude() -> Row:
    choices = sorted((*PENALTIES, POLES[1]), key=lambda choice: choice.penalty)
    peaks = [_run(choice).largest_inflow for choice in choices]
    return claimed(
        "section 5", "amplitude of the controller output", "decreases with q_u",
        all(a > b for a, b in pairwise(peaks)),
        ", ".join(f"{peak:.3f}" for peak in peaks), "m³/min/m",
        reason="largest change of the inflow per metre of setpoint, for q_u = 1, 5, 10, 100",
    )  # fmt: skip


def _prevented() -> Row:
    penalties = (100.0, 1e4, 1e6)
    runs = [step_run(penalty, (0.5,)) for penalty in penalties]
    return claimed(
        "section 7", "penalisation of the manipulated variable",
        "it prevents oscillations of the actuator", min(run.swings for run in runs) == 0,
        f"{', '.join(str(run.swings) for run in runs)} swings for q_u = 100, 10⁴, 10⁶",
        reason=(
            "With γ = 0.5. A large q_u takes two roots of D to those of the open loop and leaves "
            "the third: only a slower γ ends the oscillations."
        ),
    )  # fmt: skip


def _figure(choice: Choice) -> Figure:
    run = _run(choice)
    minutes, level, inflow = (values[:_HORIZON] for values in (run.minutes, run.level, run.inflow))
    setpoint = Curve("setpoint w", minutes, 0.0 * minutes + 1.0, "dashed")
    return Figure(
        choice.figure,
        f"Control courses for {choice.label}",
        (
            Panel(
                "Level of tank 8", "y [m/m]",
                (setpoint, Curve("level y", minutes, level)), x_label="time [min]",
            ),
            Panel(
                "Inflow", "u [m³/min/m]",
                (Curve("inflow u", minutes, inflow, "held"),), x_label="time [min]",
            ),
        ),
        "Per metre of a setpoint step: the loop is linear, and the document prints no size. "
        f"Overshoot {run.overshoot:.1f} %, settled to 2 % after {run.settling_time:.0f} min, "
        f"{run.swings} swings of the inflow.",
    )  # fmt: skip
