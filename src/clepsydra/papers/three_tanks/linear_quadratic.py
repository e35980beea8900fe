"""Table 3: linear-quadratic gains, eigenvalues, and Figs. 7, 9 and 12."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, bode_panels, curves
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.settling_bands import BANDS
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop
from clepsydra.papers.three_tanks.printed_model import printed_model, rounded_model
from clepsydra.papers.three_tanks.state_feedback import (
    DISTANCES,
    STEP,
    placed_loop,
    settling,
)

WEIGHT = PRINTED["design of the LQC", "Q33"].value
#: R of Table 3, as printed.
SIZES = tuple(PRINTED["Table 3", f"R{row}"].text for row in ("", ", second row", ", third row"))


def run() -> Found:
    """Return the rows on linear-quadratic control, and its pictures."""
    return (*_table(), *_claims(), *_figures())


@cache
def quadratic_loop(weight: str, *, rounded: bool = False) -> FeedbackLoop:
    """Return the loop that minimises ∫ 10000 h3² + R q1² dt, on (2) or on its three decimals."""
    model = rounded_model() if rounded else printed_model()
    return replace(optimal_loop(model, WEIGHT, float(weight))[0], label=f"R = {weight}")


def optimal_loop(
    model: LinearModel, weight: float, effort: float
) -> tuple[FeedbackLoop, np.ndarray]:
    """Return the loop with the least ∫ weight h3² + effort q1² dt, and P [3, 3] of that."""
    from scipy.linalg import solve_continuous_are

    R = np.array([[effort]])
    P = solve_continuous_are(model.A, model.B, np.diag([0.0, 0.0, weight]), R)
    return FeedbackLoop("LQC", np.linalg.solve(R, model.B.T @ P), model), P


def _table() -> Rows:
    for weight in SIZES:
        exact, loop = quadratic_loop(weight), quadratic_loop(weight, rounded=True)
        alone, pair = loop.poles
        found = {
            "real eigenvalue": alone,
            "real part of the pair": pair.real,
            "imaginary part of the pair": pair.imag,
            "N": loop.setpoint_gain,
        }
        named = {f"{name}, {loop.label}": value for name, value in found.items()}
        real, *parts = (PRINTED["Table 3", name].value for name in list(named)[:3])
        yield from loop.gain_rows("Table 3", exact, real, complex(*parts))
        yield from PRINTED.compared("Table 3", named)
        yield exact.margin_row(PRINTED["Table 3", f"VGM, {loop.label}"])


def _claims() -> Rows:
    loops = [quadratic_loop(weight) for weight in SIZES]
    slowest = [max(np.linalg.eigvals(loop.closed).real) for loop in loops]
    placed = [placed_loop(distance) for distance in DISTANCES]
    ends = {"FSFB, -25 ± j25": placed[0], "LQC, R = 0.001": loops[-1]}
    fast = {name: loop.vector_gain_margins for name, loop in ends.items()}
    crossed = {
        kind: max(each.largest_crossing for each in group)
        for kind, group in (("LQC", loops), ("FSFB", placed))
    }
    time = np.linspace(0.0, 12.0, 12001)
    levels = [loop.step(STEP, time)[0][:, 2] for loop in loops]
    near, wide = ([settling(time, level, band) for level in levels] for band in BANDS)
    yield PRINTED["Table 3", "speed"].claimed(
        all(first > second > third for first, second, third in (slowest, near, wide)),
        ", ".join(
            f"{pole:.2f} 1/s, {late:.2f} s and {soon:.2f} s"
            for pole, late, soon in zip(slowest, near, wide, strict=True)
        ),
    )
    low, high = PRINTED.numbers("second equation (6)", "least VGM", "greatest VGM")
    yield PRINTED["stability analysis", "VGM of both controllers"].claimed(
        any(min(pair) >= low and max(pair) <= high for pair in zip(*fast.values(), strict=True)),
        "; ".join(
            f"{name} {', '.join(f'{each:.2f}' for each in found)} dB"
            for name, found in fast.items()
        ),
        crossed=crossed,
    )
    margins = [loop.closed_gain_margin for loop in loops]
    yield PRINTED["simulation results", "magnitude plots"].remark(
        "; ".join(
            f"{kind} "
            + ", ".join(
                f"{each.closed_gain_margin:.1f} dB and {each.closed_bandwidth:.1f} rad/s"
                for each in group
            )
            for kind, group in (("FSFB", placed), ("LQC", loops))
        ),
        fallen=margins[0] - margins[-1],
    )
    yield _range_of_the_abstract(loops, placed)


def _range_of_the_abstract(quadratic: list[FeedbackLoop], placed: list[FeedbackLoop]) -> Row:
    low, high = PRINTED.numbers("second equation (6)", "least VGM", "greatest VGM")
    within = [
        [
            sum(low <= loop.vector_gain_margins[place] <= high for loop in group)
            for place in range(4)
        ]
        for group in (quadratic, placed)
    ]
    # At the feed and at levels 1 to 3.
    assert within == [[0, 0, 0, len(quadratic)], [0, 0, 0, 0]]
    of_third = (
        f"{kind} {', '.join(f'{loop.vector_gain_margins[3]:.2f}' for loop in group)} dB"
        for kind, group in (("LQC", quadratic), ("FSFB", placed))
    )
    line = PRINTED["abstract", "VGM of LQC and FSFB"]
    return line.remark(f"level 3: {', '.join(of_third)}")


def _figures() -> Found:
    """Draw Figs. 7, 9 and 12."""
    time, frequencies = np.linspace(0.0, 6.0, 1201), np.logspace(-2.0, 2.0, 300)
    loops = [quadratic_loop(weight) for weight in SIZES]
    alone = {loop.label: loop.step_without_precompensator(time) for loop in loops}
    yield Figure(
        "Fig. 7", "Setpoint step with linear-quadratic feedback alone",
        (Panel("level 3", "level / step [1]", curves(time, alone)),),
    )  # fmt: skip
    runs = {loop.label: loop.step(STEP, time) for loop in loops}
    yield Figure(
        "Fig. 9", "Setpoint step of 1 cm with LQC and precompensator, linear model",
        (
            Panel("level 3", "level [cm]",
                  curves(time, {name: 100.0 * x[:, 2] for name, (x, _) in runs.items()})),
            Panel("feed", "feed [m³/s]", curves(time, {name: u for name, (_, u) in runs.items()})),
        ),
        "A pump of 100 cm³/s gives a ten-thousandth of the feed that these loops ask for.",
    )  # fmt: skip
    shown = {loop.label: loop.closed_response(frequencies) for loop in loops}
    title = "Closed loop with LQC and precompensator"
    yield Figure("Fig. 12", title, bode_panels(frequencies, shown))
