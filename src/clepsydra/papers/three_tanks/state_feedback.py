"""Table 2: state feedback by pole placement, its closed loop, and Figs. 6, 8, 11 and 14."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from clepsydra.papers.comparison import Evidence, claimed, compared
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.row import Row
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop
from clepsydra.papers.three_tanks.pid_design import loop_model, pid_margins
from clepsydra.papers.three_tanks.printed_model import printed_model, rounded_model

#: Table 2: distance of the dominant poles, K1, K2, K3, N and VGM as printed.
TABLE = (
    (25, "1.4", "1560", "923188", "925410", "8.5"),
    (10, "0.92", "478", "147383", "148070", "11"),
    (5, "1", "214", "36710", "37016", "12.5"),
)
#: What the gains of Tables 2 and 3 were computed from.
ROUNDED = "From (2) in three decimals, as in the closed-loop matrix, and B = 64.94 as in Qc"
#: Significant digits of a column of Table 2 whose trailing zeros mislead.
_DIGITS = {"K1": 2, "N": 5}
STEP = 0.01  # ours [m]; the document's is not printed


def run() -> Findings:
    """Return the rows on state feedback, and its pictures."""
    figures = (_servo_without(), _servo(), _magnitudes(), _nyquist())
    return Findings((*_table(), *_closed_loop(), *_claims()), figures)


@cache
def placed_loop(distance: int, *, rounded: bool = False) -> FeedbackLoop:
    """Return the loop with the poles -40 and -p ± jp by Ackermann's formula.

    Parameters
    ----------
    distance : int
        p [1/s]
    rounded : bool
        Whether (2) is taken in three decimals.

    Examples
    --------
    >>> round(float(placed_loop(5).gain[0, 0]), 3)
    0.768
    """
    model = rounded_model() if rounded else printed_model()
    reached = np.hstack([model.B, model.A @ model.B, model.A @ model.A @ model.B])
    wanted = np.poly([-40.0, -distance + 1j * distance, -distance - 1j * distance]).real
    value = sum(factor * np.linalg.matrix_power(model.A, 3 - i) for i, factor in enumerate(wanted))
    gain = np.linalg.solve(reached.T, np.array([0.0, 0.0, 1.0])) @ value
    return FeedbackLoop(f"poles -{distance} ± j{distance}", gain[None, :], model)


def _table() -> list[Row]:
    rows = []
    for distance, *texts in TABLE:
        exact, used = placed_loop(distance), placed_loop(distance, rounded=True)
        values = [*used.gain[0].tolist(), used.setpoint_gain]
        in_full = [*exact.gain[0].tolist(), exact.setpoint_gain]
        for name, text, value, full in zip(
            ("K1", "K2", "K3", "N"), texts[:4], values, in_full, strict=True
        ):
            rows.append(
                compared(
                    "Table 2", f"{name}, -{distance} ± j{distance}", text, value, "m²/s",
                    digits=_DIGITS.get(name),
                    why=f"{ROUNDED}; (2) in full gives {full:.6g}.",
                    right_if=_sum_of_poles(distance) if name == "K1" else (),
                )
            )  # fmt: skip
        rows.append(_margin_row("Table 2", exact, texts[4]))
    return rows


def _sum_of_poles(distance: int) -> list[Evidence]:
    """Return what fixes K1: the poles of the closed loop add up to the trace of A - B K."""
    trace = float(np.trace(printed_model().A))
    by_sum = (40 + 2 * distance + trace) / 64.93
    others = all(
        abs((40 + 2 * d + trace) / 64.93 - float(text)) < 0.05 for d, text, *_ in TABLE[:2]
    )
    return [
        (f"the sum of the poles alone fixes K1, to {by_sum:.3f}, as it does in the other rows",
         others and abs(by_sum - placed_loop(distance).gain[0, 0]) < 1e-3)
    ]  # fmt: skip


def _margin_row(place: str, loop: FeedbackLoop, printed: str) -> Row:
    return compared(
        place, f"VGM, {loop.label}", printed, loop.vector_gain_margin, "dB",
        unprinted="max|S| at the feed. Also |S| at the crossovers, at the level, with the "
        "precompensator inside the loop, and max|T| were tried: none gives the printed value.",
    )  # fmt: skip


def _closed_loop() -> list[Row]:
    closed = placed_loop(25, rounded=True).closed
    digits = {"-90": 2, "-101300": 4}
    printed = (("-90", "-101300", "-6E7"), ("0.03", "-0.058", "0.026"), ("0", "0.026", "-0.04"))
    place = "closed loop with precompensator"
    rows = [
        compared(
            place, f"A{i + 1}{j + 1}", printed[i][j], float(closed[i, j]),
            digits=digits.get(printed[i][j]), why=f"{ROUNDED}.",
        )
        for i in range(3)
        for j in range(3)
    ]  # fmt: skip
    gain = float(printed_model().B[0, 0])
    evidence = ("1/A, as in (2) and in Qc", abs(gain - 64.94) < 5e-3 + 1e-9)
    rows.append(compared(place, "B1", "69.94", gain, "1/m²", right_if=[evidence]))
    return rows


def _settling(time: np.ndarray, level: np.ndarray) -> float:
    outside = np.flatnonzero(np.abs(level / STEP - 1.0) > 0.02)
    return float(time[outside[-1]])


def _claims() -> list[Row]:
    time = np.linspace(0.0, 3.0, 30001)
    levels = {distance: placed_loop(distance).step(STEP, time)[0][:, 2] for distance, *_ in TABLE}
    overshoot = 100.0 * (levels[25].max() / STEP - 1.0)
    settling = {distance: _settling(time, level) for distance, level in levels.items()}
    margins = [placed_loop(distance).vector_gain_margin for distance, *_ in TABLE]
    times = ", ".join(f"{settling[distance]:.2f} s" for distance in (25, 10, 5))
    pid_peak = _pid_overshoot()
    magnitude = np.abs(placed_loop(5).frequency_response(np.logspace(-3, 3, 400)) + 1.0).min()
    return [
        claimed(
            "design of the FSFB controller", "overshoot", "below 3 %", bool(overshoot < 3.0),
            f"{overshoot:.2f} %", reason="Of the linear model, poles -40 and -25 ± j25.",
        ),
        claimed(
            "design of the FSFB controller", "settling time", "0.2 s",
            bool(settling[25] <= 0.205), f"{settling[25]:.3f} s to within 2 %",
            reason="Of the linear model, whose feed may be anything; see the runs with a pump.",
        ),
        claimed(
            "Table 2", "speed", "poles farther from the axis respond faster",
            settling[25] < settling[10] < settling[5], times,
            reason="Settling to within 2 % for -25, -10 and -5.",
        ),
        claimed(
            "conclusion", "overshoot against PID", "FSFB overshoots less than PID",
            bool(overshoot < pid_peak), f"{overshoot:.1f} % against {pid_peak:.1f} %",
            reason="Both on the linear model.",
        ),
        claimed(
            "stability analysis", "VGM of the FSFB controller",
            "with greater dominant poles within 3.5 to 9.5 dB",
            any(3.5 <= margin <= 9.5 for margin in margins),
            ", ".join(f"{margin:.2f} dB" for margin in margins),
            reason="|1 + L| never falls below one: |S| is at most 0 dB for all three.",
        ),
        claimed(
            "simulation results", "Nyquist plot", "no contour encloses -1",
            all(placed_loop(distance).margins.stable for distance, *_ in TABLE),
            f"nearest distance to -1: {magnitude:.3f}",
            reason="All closed loops are stable.",
        ),
        claimed(
            "simulation results", "magnitude plots", "greater dominant poles have less gain margin",
            len({placed_loop(d).margins.gain_margin_up for d, *_ in TABLE}) > 1,
            ", ".join(_decibels(placed_loop(d).margins.gain_margin_up) for d, *_ in TABLE),
            reason="State feedback from all three levels withstands any higher gain here.",
        ),
    ]  # fmt: skip


def _decibels(gain_margin: float | None) -> str:
    if gain_margin is None:
        return "unstable"
    return "infinite" if math.isinf(gain_margin) else f"{20.0 * math.log10(gain_margin):.2f} dB"


def _pid_overshoot() -> float:
    """Return the overshoot of the closed loop with PID, derivative on the error as printed [%]."""
    from scipy.signal import StateSpace, step

    assert pid_margins().stable
    loop = loop_model()
    closed = StateSpace(loop.A - loop.B @ loop.C, loop.B, loop.C, loop.D)
    _, level = step(closed, T=np.linspace(0.0, 2000.0, 20001))
    return float(100.0 * (level.max() - 1.0))


def _servo_without() -> Figure:
    time = np.linspace(0.0, 2.0, 1201)
    curves = []
    for distance, *_ in TABLE:
        loop = placed_loop(distance)
        level = loop.step(STEP, time)[0][:, 2] / loop.setpoint_gain
        curves.append(Curve(loop.label, time, level / STEP))
    return Figure(
        "Fig. 6", "Setpoint step with state feedback alone",
        (Panel("level 3", "level / step [1]", tuple(curves)),),
        "Without the precompensator the level moves by a millionth of the step.",
    )  # fmt: skip


def _servo() -> Figure:
    time = np.linspace(0.0, 1.5, 1201)
    runs = {placed_loop(d).label: placed_loop(d).step(STEP, time) for d, *_ in TABLE}
    return Figure(
        "Fig. 8", "Setpoint step of 1 cm with state feedback and precompensator, linear model",
        (
            Panel("level 3", "level [cm]",
                  tuple(Curve(name, time, 100 * x[:, 2]) for name, (x, _) in runs.items())),
            Panel("level 1", "level [m]",
                  tuple(Curve(name, time, x[:, 0]) for name, (x, _) in runs.items())),
        ),
        f"The feed starts at {placed_loop(25).setpoint_gain * STEP:.0f} m³/s for poles at -25.",
    )  # fmt: skip


def _magnitudes() -> Figure:
    frequencies = np.logspace(-1.0, 3.0, 300)
    curves = []
    for distance, *_ in TABLE:
        loop = placed_loop(distance)
        points = 1j * frequencies[:, None, None] * np.eye(3) - loop.closed
        level = np.linalg.solve(points, loop.model.B)[:, 2, 0] * loop.setpoint_gain
        curves.append(Curve(loop.label, frequencies, 20.0 * np.log10(np.abs(level))))
    panel = Panel(
        "setpoint to level 3", "magnitude [dB]", tuple(curves), "frequency [rad/s]",
        logarithmic_x=True,
    )  # fmt: skip
    return Figure("Fig. 11", "Closed loop with state feedback and precompensator", (panel,))


def _nyquist() -> Figure:
    frequencies = np.logspace(-1.0, 4.0, 600)
    turn = np.linspace(0.0, 2.0 * math.pi, 121)
    curves = [Curve("unit circle around -1", np.cos(turn) - 1.0, np.sin(turn), "dashed")]
    for distance, *_ in TABLE:
        value = placed_loop(distance).frequency_response(frequencies)
        near = np.where(np.abs(value) < 4.0, value, np.nan)
        curves.append(Curve(placed_loop(distance).label, near.real, near.imag))
    panel = Panel("L at the feed", "imaginary part", tuple(curves), "real part")
    return Figure(
        "Fig. 14", "Nyquist plot with state feedback", (panel,),
        "No curve enters the circle: max|S| is one.",
    )  # fmt: skip
