"""Table 3: linear-quadratic gains, eigenvalues, and Figs. 7, 9 and 12."""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.papers.comparison import claimed, compared, remark
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.row import Row
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop
from clepsydra.papers.three_tanks.printed_model import IN_FULL, printed_model, rounded_model
from clepsydra.papers.three_tanks.state_feedback import ROUNDED, STEP, placed_loop
from clepsydra.papers.three_tanks.state_feedback import TABLE as PLACED

WEIGHT = 10000.0
#: Table 3: R, K1, K2, K3, real pole, real and imaginary part of the pair, N, VGM as printed.
TABLE = (
    ("0.1", "0.077", "6.15", "307.3", "-2.6", "-1.2", "2.2", "316.2", "25.95"),
    ("0.01", "0.11", "13.4", "980.7", "-3.8", "-1.9", "3.3", "1000", "17.59"),
    ("0.001", "0.2", "29.1", "3120.5", "-5.5", "-2.8", "4.8", "3162.3", "7.0"),
)
_SIZES = ("0.1", "0.01", "0.001")
_EIGENVALUES = f"Riccati equation with {IN_FULL}."


def run() -> Findings:
    """Return the rows on linear-quadratic control, and its pictures."""
    return Findings((*_table(), *_claims()), (_servo_without(), _servo(), _bode()))


@cache
def quadratic_loop(weight: str, *, rounded: bool = False) -> FeedbackLoop:
    """Return the loop that minimises ∫ 10000 h3² + R q1² dt.

    Parameters
    ----------
    weight : str
        R, as printed.
    rounded : bool
        Whether (2) is taken in three decimals.

    Examples
    --------
    >>> round(quadratic_loop("0.01").setpoint_gain, 6)
    1000.0
    """
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


def _table() -> list[Row]:
    rows = []
    for weight, first, second, third, pole, real, imaginary, setpoint, margin in TABLE:
        loop = quadratic_loop(weight)
        alone, pair = _eigenvalues(loop)
        gain = quadratic_loop(weight, rounded=True).gain[0].tolist()
        rows += [
            compared("Table 3", f"K1, {loop.label}", first, gain[0], "m²/s",
                     why=ROUNDED
                     + (" Printed to one decimal, as all of its row." if first == "0.2" else "")),
            compared("Table 3", f"K2, {loop.label}", second, gain[1], "m²/s", why=ROUNDED),
            compared("Table 3", f"K3, {loop.label}", third, gain[2], "m²/s", why=ROUNDED),
            compared("Table 3", f"real eigenvalue, {loop.label}", pole, alone, "1/s",
                     why=_EIGENVALUES),
            compared("Table 3", f"real part of the pair, {loop.label}", real, pair.real, "1/s",
                     why=_EIGENVALUES),
            compared("Table 3", f"imaginary part of the pair, {loop.label}", imaginary, pair.imag,
                     "1/s", why=_EIGENVALUES),
            compared("Table 3", f"N, {loop.label}", setpoint, loop.setpoint_gain, "m²/s",
                     why="√(Q3/R + 1/g²) with the static gain g of (2), in these digits √(Q3/R)."),
            compared("Table 3", f"VGM, {loop.label}", margin, loop.vector_gain_margin, "dB",
                     unprinted=loop.words_on_its_vector_margin),
        ]  # fmt: skip
    return rows


def _claims() -> list[Row]:
    loops = [quadratic_loop(weight) for weight in _SIZES]
    slowest = [max(np.linalg.eigvals(loop.closed).real) for loop in loops]
    placed = [placed_loop(distance) for distance, *_ in PLACED]
    fast = {"FSFB, -25 ± j25": _everywhere(placed[0]), "LQC, R = 0.001": _everywhere(loops[-1])}
    third = {
        kind: ", ".join(f"{loop.vector_gain_margins_at_levels[2]:.2f}" for loop in each)
        for kind, each in (("LQC", loops), ("FSFB", placed))
    }
    crossed = {
        kind: max(map(max, (each.sensitivity_at_phase_crossings_of_levels for each in group)))
        for kind, group in (("LQC", loops), ("FSFB", placed))
    }
    efforts = [_effort(loop) for loop in loops]
    shares = [float(weight) * effort for weight, effort in zip(_SIZES, efforts, strict=True)]
    return [
        claimed(
            "Table 3", "speed",
            "small values of 'R' moves the Eigen values farther from imaginary axis",
            slowest[0] > slowest[1] > slowest[2],
            ", ".join(f"{value:.2f} 1/s" for value in slowest),
            reason="Real part of the slowest eigenvalue for R = 0.1, 0.01 and 0.001.",
        ),
        remark(
            "design of the LQC", "effort", "Small values of 'R' make the control effort less",
            ", ".join(f"{effort:.3g} m⁶/s" for effort in efforts),
            reason="∫(u - u∞)² dt after a setpoint step of 1 cm for R = 0.1, 0.01 and 0.001. Which "
            "measure is meant is not said: of this it fails, of the share of J, R times this, it "
            f"{'holds' if shares[0] > shares[1] > shares[2] else 'fails too'}.",
        ),
        claimed(
            "stability analysis", "VGM of both controllers",
            "the FSFB controller with greater dominant pole value and linear quadratic controller "
            "with very small 'R' value yields VGM value which is well within the tolerance",
            any(min(pair) >= 3.5 and max(pair) <= 9.5 for pair in zip(*fast.values(), strict=True)),
            "; ".join(
                f"{name} {', '.join(f'{each:.2f}' for each in found)} dB"
                for name, found in fast.items()
            ),
            reason="20 log10 max|S| at the feed and at levels 1 to 3: wherever the loop is opened, "
            "FSFB is below 3.5 to 9.5 dB. Where the phase is -180°, as (6) of the vector gain "
            f"margin takes |S|, both are, at most {crossed['FSFB']:.2f} and "
            f"{crossed['LQC']:.2f} dB.",
        ),
        remark(
            "simulation results", "magnitude plots",
            "the greater dominant pole value yields a lesser gain margin (GM). The lesser GM "
            "results in greater bandwidth",
            "; ".join(
                f"{kind} "
                + ", ".join(
                    f"{each.closed_gain_margin:.1f} dB and {each.closed_bandwidth:.1f} rad/s"
                    for each in group
                )
                for kind, group in (("FSFB", placed), ("LQC", loops))
            ),
            reason="Of the closed loop from setpoint to level 3, as in Figs. 11 and 12; bandwidth "
            "to -3 dB; -25, -10, -5 and R = 0.1, 0.01, 0.001. For which controllers is not said: "
            "it holds for FSFB, and fails for LQC, whose gain margin stays.",
        ),
        remark(
            "abstract", "VGM of LQC and FSFB",
            "VGM lies well within the range for LQC than FSFB",
            f"level 3: LQC {third['LQC']} dB, FSFB {third['FSFB']} dB",
            reason="Where the loop is opened is not said. Of 20 log10 max|S| it holds at level 3, "
            "as here, where all of LQC and none of FSFB are within 3.5 to 9.5 dB, and fails at the "
            "feed, where all are 0 dB.",
        ),
    ]  # fmt: skip


def _everywhere(loop: FeedbackLoop) -> list[float]:
    """Return 20 log10 max\\|S\\| at the feed and at each level [dB]."""
    return [loop.vector_gain_margin, *loop.vector_gain_margins_at_levels]


def _effort(loop: FeedbackLoop) -> float:
    """Return ∫(u - u∞)² dt after a setpoint step [m⁶/s]."""
    from scipy.linalg import solve_continuous_lyapunov

    # The states move from 0 to their rest, and the feed to its own by -K times what is left.
    rest = np.linalg.solve(loop.closed, -loop.model.B * loop.setpoint_gain * STEP)
    weight = solve_continuous_lyapunov(loop.closed.T, -loop.gain.T @ loop.gain)
    return float((rest.T @ weight @ rest)[0, 0])


def _servo_without() -> Figure:
    time = np.linspace(0.0, 6.0, 1201)
    curves = []
    for weight in _SIZES:
        loop = quadratic_loop(weight)
        level = loop.step(STEP, time)[0][:, 2] / (loop.setpoint_gain * STEP)
        curves.append(Curve(loop.label, time, level))
    return Figure(
        "Fig. 7", "Setpoint step with linear-quadratic feedback alone",
        (Panel("level 3", "level / step [1]", tuple(curves)),),
    )  # fmt: skip


def _servo() -> Figure:
    time = np.linspace(0.0, 6.0, 1201)
    runs = {w: quadratic_loop(w).step(STEP, time) for w in _SIZES}
    return Figure(
        "Fig. 9", "Setpoint step of 1 cm with LQC and precompensator, linear model",
        (
            Panel("level 3", "level [cm]",
                  tuple(Curve(f"R = {w}", time, 100 * x[:, 2]) for w, (x, _) in runs.items())),
            Panel("feed", "feed [m³/s]",
                  tuple(Curve(f"R = {w}", time, u) for w, (_, u) in runs.items())),
        ),
        "A pump of 100 cm³/s gives a ten-thousandth of the feed that these loops ask for.",
    )  # fmt: skip


def _bode() -> Figure:
    frequencies = np.logspace(-2.0, 2.0, 300)
    size, phase = [], []
    for weight in _SIZES:
        loop = quadratic_loop(weight)
        points = 1j * frequencies[:, None, None] * np.eye(3) - loop.closed
        level = np.linalg.solve(points, loop.model.B)[:, 2, 0] * loop.setpoint_gain
        size.append(Curve(loop.label, frequencies, 20.0 * np.log10(np.abs(level))))
        phase.append(Curve(loop.label, frequencies, np.degrees(np.unwrap(np.angle(level)))))
    label = "frequency [rad/s]"
    return Figure(
        "Fig. 12", "Closed loop with LQC and precompensator",
        (
            Panel("magnitude", "magnitude [dB]", tuple(size), label, logarithmic_x=True),
            Panel("phase", "phase [°]", tuple(phase), label, logarithmic_x=True),
        ),
    )  # fmt: skip
