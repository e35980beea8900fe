"""Table 2: state feedback by pole placement, its closed loop, and Figs. 6, 8, 11 and 14."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.figure import Curve, Figure, Panel, bode_panels, curves
from clepsydra.papers.printed_table import entries
from clepsydra.papers.row import Rows
from clepsydra.papers.settling_bands import BANDS
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import (
    NEAR,
    FeedbackLoop,
    in_words,
    pole_distance,
    poles_of,
)
from clepsydra.papers.three_tanks.printed_model import printed_model, rounded_model

#: Table 2: distances of the dominant poles [1/s].
DISTANCES = tuple(
    -int(PRINTED["Table 2", f"real part of the pair{row}"].value)
    for row in ("", ", second row", ", third row")
)
_THIRD = PRINTED["design of the FSFB controller", "third pole"].value  # [1/s]
STEP = 0.01  # ours [m]; the document's is not printed


def run() -> Found:
    """Return the rows on state feedback, and its pictures."""
    return (*_table(), *_closed_loop(), *_claims(), *_figures())


@cache
def placed_loop(distance: int, *, rounded: bool = False) -> FeedbackLoop:
    """Return the loop with the poles -40 and -p ± jp by Ackermann's formula."""
    from control import acker

    model = rounded_model() if rounded else printed_model()
    poles = [_THIRD, -distance + 1j * distance, -distance - 1j * distance]
    gain = acker(model.A, model.B, poles)
    return FeedbackLoop(f"poles -{distance} ± j{distance}", np.reshape(gain, (1, 3)), model)


def _table() -> Rows:
    """Compare gains from (2) in three decimals, and margins from (2) before rounding."""
    for distance in DISTANCES:
        exact, used = placed_loop(distance), placed_loop(distance, rounded=True)
        yield from used.gain_rows("Table 2", exact, _THIRD, complex(-distance, distance))
        name = f"N, -{distance} ± j{distance}"
        yield PRINTED["Table 2", name].compared(used.setpoint_gain, exact=exact.setpoint_gain)
        yield exact.margin_row(PRINTED["Table 2", f"VGM, {exact.label}"])


def _closed_loop() -> Rows:
    place, gain = "closed loop with precompensator", float(printed_model().B[0, 0])
    in_qc = PRINTED["controllability", "Qc11"].number
    same = abs(gain - in_qc.value) < in_qc.half_unit + 1e-9
    words = "1/A, as in Qc and cut to 64.93 in (2); u is r N here, as A - B K has the feedback"
    evidence = (words, same)
    closed = np.vstack([placed_loop(25, rounded=True).closed[:1], printed_model().A[1:]])
    found = entries("A", closed)
    printed = np.reshape([PRINTED[place, name].value for name in found], (3, 3))
    mended = printed.copy()
    mended[1, 0] = closed[1, 0]
    wanted = (_THIRD, complex(-DISTANCES[0], DISTANCES[0]))
    off, near = (pole_distance(poles_of(each), wanted) for each in (printed, mended))
    right, wrong = (in_words(poles_of(each)) for each in (mended, printed))
    of_poles = (
        "A21 of (2) before rounding, with which the other printed entries make the poles "
        f"{right}, within {100.0 * near:.1f} % of −40 and −25 ± j25, for which they are printed; "
        f"0.03 makes {wrong}, up to {100.0 * off:.0f} % off. It rounds to 0.03, but in fewer "
        "digits than -0.058 and 0.026 beside it",
        near < NEAR < off,
    )
    for name, value in found.items():
        yield (
            PRINTED[place, name]
            .told(off=100.0 * near)
            .compared(value, right_if=[of_poles] if name == "A21" else ())
        )
    yield PRINTED[place, "B1"].compared(gain, right_if=[evidence])


def settling(time: np.ndarray, level: np.ndarray, band: float = BANDS[0]) -> float:
    """Return when a level [n] is within a band around its setpoint step for good [s]."""
    outside = np.flatnonzero(np.abs(level / STEP - 1.0) > band)
    return float(time[outside[-1]])


def _claims() -> Rows:
    time = np.linspace(0.0, 3.0, 30001)
    loops = [placed_loop(distance) for distance in DISTANCES]
    levels = [loop.step(STEP, time)[0][:, 2] for loop in loops]
    settled = [[settling(time, level, band) for level in levels] for band in BANDS]
    nearest = min(1.0 / loop.sensitivity_peaks[0] for loop in loops)
    yield PRINTED["Table 2", "speed"].claimed(
        all(first < second < third for first, second, third in settled),
        "; ".join(", ".join(f"{each:.2f} s" for each in within) for within in settled),
    )
    yield PRINTED["simulation results", "Nyquist plot"].claimed(
        all(np.linalg.eigvals(loop.closed).real.max() < 0.0 for loop in loops),
        f"nearest distance to -1: {nearest:.3f}",
    )


def _figures() -> Found:
    """Draw Figs. 6, 8, 11 and 14."""
    loops = [placed_loop(distance) for distance in DISTANCES]
    time = np.linspace(0.0, 2.0, 1201)
    alone = {loop.label: loop.step_without_precompensator(time) for loop in loops}
    yield Figure(
        "Fig. 6", "Setpoint step with state feedback alone",
        (Panel("level 3", "level / step [1]", curves(time, alone)),),
        "Without the precompensator the level moves by a millionth of the step.",
    )  # fmt: skip
    time = np.linspace(0.0, 1.5, 1201)
    levels = {loop.label: loop.step(STEP, time)[0] for loop in loops}
    yield Figure(
        "Fig. 8", "Setpoint step of 1 cm with state feedback and precompensator, linear model",
        (
            Panel("level 3", "level [cm]",
                  curves(time, {name: 100.0 * x[:, 2] for name, x in levels.items()})),
            Panel("level 1", "level [m]",
                  curves(time, {name: x[:, 0] for name, x in levels.items()})),
        ),
        f"The feed starts at {loops[0].setpoint_gain * STEP:.0f} m³/s for poles at -25.",
    )  # fmt: skip
    frequencies = np.logspace(-1.0, 3.0, 300)
    magnitude, _ = bode_panels(
        frequencies, {k.label: k.closed_response(frequencies) for k in loops}
    )
    panel = replace(magnitude, title="setpoint to level 3")
    yield Figure("Fig. 11", "Closed loop with state feedback and precompensator", (panel,))
    frequencies, turn = np.logspace(-1.0, 4.0, 600), np.linspace(0.0, 2.0 * math.pi, 121)
    shown = [Curve("unit circle around -1", np.cos(turn) - 1.0, np.sin(turn), "dashed")]
    for loop in loops:
        value = loop.frequency_response(frequencies)
        near = np.where(np.abs(value) < 4.0, value, np.nan)
        shown.append(Curve(loop.label, near.real, near.imag))
    yield Figure(
        "Fig. 14", "Nyquist plot with state feedback",
        (Panel("L at the feed", "imaginary part", shown, "real part"),),
        "No curve enters the circle: max|S| is one.",
    )  # fmt: skip
