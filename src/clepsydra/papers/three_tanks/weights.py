"""What the document says that Q and R do, and LQC beside pole placement."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop
from clepsydra.papers.three_tanks.linear_quadratic import (
    SIZES,
    WEIGHT,
    optimal_loop,
    quadratic_loop,
)
from clepsydra.papers.three_tanks.printed_model import printed_model
from clepsydra.papers.three_tanks.state_feedback import DISTANCES, STEP, placed_loop

_PLACE = "design of the LQC"
#: Weights of level 3, ours: a tenth of the document's, its own, and ten times that.
_WEIGHTS = (0.1 * WEIGHT, WEIGHT, 10.0 * WEIGHT)


def run() -> Found:
    """Judge what is said of Q and R."""
    yield _stability()
    yield from _of_weights()


def _stability() -> Row:
    quadratic, placed = [*map(quadratic_loop, SIZES)], [*map(placed_loop, DISTANCES)]
    worst = {}
    for name, loops in (("LQC", quadratic), ("FSFB", placed)):
        worst[name] = (
            max(max(loop.vector_gain_margins) for loop in loops),
            max(float(np.linalg.eigvals(loop.closed).real.max()) for loop in loops),
            min(loop.phase_margin for loop in loops),
            min(loop.closed_gain_margin for loop in loops),
        )
    lqc, fsfb = worst["LQC"], worst["FSFB"]
    # By each of these FSFB is the more stable.
    assert lqc[0] > fsfb[0] and lqc[1] > fsfb[1] and lqc[2] < fsfb[2] and lqc[3] < fsfb[3]
    return PRINTED[_PLACE, "stability"].remark(
        "; ".join(
            f"{name}: max|S| {peak:.2f} dB, slowest pole {pole:.1f} 1/s, phase margin "
            f"{phase:.1f}°, gain margin of the closed loop {gain:.1f} dB"
            for name, (peak, pole, phase, gain) in worst.items()
        )
    )


def _of_weights() -> Rows:
    model, largest = printed_model(), float(SIZES[0])
    heavier = [optimal_loop(model, weight, largest) for weight in _WEIGHTS]
    costs = [float(_rest(loop) @ P @ _rest(loop)) for loop, P in heavier]
    yield PRINTED[_PLACE, "J"].claimed(
        costs[0] > costs[1] > costs[2], ", ".join(f"{cost:.2e}" for cost in costs)
    )
    cheaper = [optimal_loop(model, WEIGHT, float(effort)) for effort in SIZES]
    assert all(np.diff([_rest(loop) @ P @ _rest(loop) for loop, P in cheaper]) < 0.0)
    efforts = np.array([_effort(loop) for loop, _ in cheaper])
    weighed = np.array([*map(float, SIZES)]) * efforts
    assert all(np.diff(efforts) > 0.0) and all(np.diff(weighed) < 0.0)
    yield PRINTED[_PLACE, "effort"].remark(
        f"R∫(u - u∞)² dt {', '.join(f'{each:.3g}' for each in weighed)}; "
        f"∫(u - u∞)² dt {', '.join(f'{each:.3g}' for each in efforts)} m⁶/s"
    )
    groups = {
        f"Q33 = {', '.join(f'{weight:.0f}' for weight in _WEIGHTS)}": [loop for loop, _ in heavier],
        f"R = {', '.join(SIZES)}": [loop for loop, _ in cheaper],
    }
    poles = {name: [np.linalg.eigvals(loop.closed) for loop in of] for name, of in groups.items()}
    nearest = {name: [float(np.abs(each).min()) for each in of] for name, of in poles.items()}
    slowest = {name: [-float(each.real.max()) for each in of] for name, of in poles.items()}
    yield PRINTED[_PLACE, "poles"].claimed(
        all(one < other < last for one, other, last in nearest.values()), _words(nearest)
    )
    loops = [loop for of in groups.values() for loop in of]
    (damping,) = {round(-loop.poles[1].real / abs(loop.poles[1]), 2) for loop in loops}
    phases = [loop.phase_margin for loop in loops]
    assert max(phases) - min(phases) < 0.1
    line = PRINTED[_PLACE, "relative stability"].told(
        damping=damping, phase=min(phases), widest=max(phases)
    )
    yield line.remark(_words(slowest))


def _words(found: dict[str, list[float]]) -> str:
    return "; ".join(
        f"{name}: {', '.join(f'{each:.2f}' for each in values)} 1/s"
        for name, values in found.items()
    )


def _rest(loop: FeedbackLoop) -> np.ndarray:
    """Return by how much a setpoint step moves the levels [3] in the end [m]."""
    rest = np.linalg.solve(loop.closed, -loop.model.B[:, 0] * loop.setpoint_gain * STEP)
    return np.asarray(rest)


def _effort(loop: FeedbackLoop) -> float:
    """Return ∫(u - u∞)² dt after a setpoint step [m⁶/s]."""
    from scipy.linalg import solve_continuous_lyapunov

    # The feed comes to its rest by -K times what is left of the levels.
    weight = solve_continuous_lyapunov(loop.closed.T, -loop.gain.T @ loop.gain)
    return float(_rest(loop) @ weight @ _rest(loop))
