"""Table 3: linear-quadratic gains, eigenvalues, and Figs. 7, 9 and 12."""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure, Panel, bode_panels, curves
from clepsydra.papers.row import Rows
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop
from clepsydra.papers.three_tanks.printed_model import printed_model, rounded_model
from clepsydra.papers.three_tanks.state_feedback import DISTANCES, STEP, placed_loop

WEIGHT = PRINTED["design of the LQC", "Q33"].value
#: R of Table 3, as printed.
SIZES = ("0.1", "0.01", "0.001")


def run() -> Found:
    """Return the rows on linear-quadratic control, and its pictures."""
    return (*_table(), *_claims(), *_figures())


@cache
def quadratic_loop(weight: str, *, rounded: bool = False) -> FeedbackLoop:
    """Return the loop that minimises ∫ 10000 h3² + R q1² dt, on (2) or on its three decimals."""
    from scipy.linalg import solve_continuous_are

    model = rounded_model() if rounded else printed_model()
    R = np.array([[float(weight)]])
    cost = solve_continuous_are(model.A, model.B, np.diag([0.0, 0.0, WEIGHT]), R)
    return FeedbackLoop(f"R = {weight}", np.linalg.solve(R, model.B.T @ cost), model)


def _eigenvalues(loop: FeedbackLoop) -> tuple[float, complex]:
    """Return the real pole and the upper one of the pair."""
    values = np.linalg.eigvals(loop.closed)
    real = float(values[np.abs(values.imag) < 1e-9].real[0])
    return real, complex(values[values.imag > 1e-9][0])


def _table() -> Rows:
    for weight in SIZES:
        loop = quadratic_loop(weight)
        alone, pair = _eigenvalues(loop)
        k1, k2, k3 = quadratic_loop(weight, rounded=True).gain[0].tolist()
        found = {
            "K1": k1, "K2": k2, "K3": k3, "real eigenvalue": alone,
            "real part of the pair": pair.real, "imaginary part of the pair": pair.imag,
            "N": loop.setpoint_gain,
        }  # fmt: skip
        named = {f"{name}, {loop.label}": value for name, value in found.items()}
        yield from PRINTED.compared("Table 3", named)
        yield loop.margin_row(PRINTED["Table 3", f"VGM, {loop.label}"])


def _claims() -> Rows:
    loops = [quadratic_loop(weight) for weight in SIZES]
    slowest = [max(np.linalg.eigvals(loop.closed).real) for loop in loops]
    placed = [placed_loop(distance) for distance in DISTANCES]
    ends = {"FSFB, -25 ± j25": placed[0], "LQC, R = 0.001": loops[-1]}
    fast = {name: loop.vector_gain_margins for name, loop in ends.items()}
    third = {
        kind: ", ".join(f"{loop.vector_gain_margins[3]:.2f}" for loop in each)
        for kind, each in (("LQC", loops), ("FSFB", placed))
    }
    crossed = {
        kind: max(each.largest_crossing for each in group)
        for kind, group in (("LQC", loops), ("FSFB", placed))
    }
    efforts = [_effort(loop) for loop in loops]
    shares = [float(weight) * effort for weight, effort in zip(SIZES, efforts, strict=True)]
    yield PRINTED["Table 3", "speed"].claimed(
        slowest[0] > slowest[1] > slowest[2], ", ".join(f"{value:.2f} 1/s" for value in slowest)
    )
    by_share = "holds" if shares[0] > shares[1] > shares[2] else "fails too"
    yield PRINTED["design of the LQC", "effort"].remark(
        ", ".join(f"{effort:.3g} m⁶/s" for effort in efforts), by_share=by_share
    )
    yield PRINTED["stability analysis", "VGM of both controllers"].claimed(
        any(min(pair) >= 3.5 and max(pair) <= 9.5 for pair in zip(*fast.values(), strict=True)),
        "; ".join(
            f"{name} {', '.join(f'{each:.2f}' for each in found)} dB"
            for name, found in fast.items()
        ),
        crossed=crossed,
    )
    yield PRINTED["simulation results", "magnitude plots"].remark(
        "; ".join(
            f"{kind} "
            + ", ".join(
                f"{each.closed_gain_margin:.1f} dB and {each.closed_bandwidth:.1f} rad/s"
                for each in group
            )
            for kind, group in (("FSFB", placed), ("LQC", loops))
        )
    )
    yield PRINTED["abstract", "VGM of LQC and FSFB"].remark(
        f"level 3: LQC {third['LQC']} dB, FSFB {third['FSFB']} dB"
    )


def _effort(loop: FeedbackLoop) -> float:
    """Return ∫(u - u∞)² dt after a setpoint step [m⁶/s]."""
    from scipy.linalg import solve_continuous_lyapunov

    # The states move from 0 to their rest, and the feed to its own by -K times what is left.
    rest = np.linalg.solve(loop.closed, -loop.model.B * loop.setpoint_gain * STEP)
    weight = solve_continuous_lyapunov(loop.closed.T, -loop.gain.T @ loop.gain)
    return float((rest.T @ weight @ rest)[0, 0])


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
