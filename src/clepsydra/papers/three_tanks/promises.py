"""What the design of state feedback promises, from the rule of thumb to the precompensator."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.row import Row
from clepsydra.papers.settling_bands import BANDS
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.conclusion import OVERSHOOT, SETTLING
from clepsydra.papers.three_tanks.feedback_loop import FeedbackLoop
from clepsydra.papers.three_tanks.printed_model import LEVELS, printed_model, rounded_model
from clepsydra.papers.three_tanks.state_feedback import (
    DISTANCES,
    STEP,
    placed_loop,
    settling,
)

#: A level that falls by no more does not fall [m].
_NOTHING = 1e-12
_PLACE = "design of the FSFB controller"
#: For the fastest poles of Table 2 and the slowest [s].
_TIME = np.linspace(0.0, 3.0, 30001)


def run() -> Found:
    """Judge the promises."""
    loops = [placed_loop(distance) for distance in DISTANCES]
    yield _rule_of_thumb(loops)
    yield _robustness(loops)
    yield from (_without_offset(), _speed(loops), _specifications(loops[0]), _offset(loops))


def _rule_of_thumb(loops: list[FeedbackLoop]) -> Row:
    opened = np.sort(np.abs(np.linalg.eigvals(printed_model().A)))
    ratios = [np.sort(np.abs(np.linalg.eigvals(loop.closed))) / opened for loop in loops]
    least, largest = float(np.min(ratios)), float(np.max(ratios))
    return PRINTED[_PLACE, "ten times"].remark(f"{least:.0f} to {largest:.0f} times")


def _robustness(loops: list[FeedbackLoop]) -> Row:
    steps = np.array([_largest_steps(loop) for loop in loops])
    models = printed_model(), rounded_model()
    slowest = max(
        float(
            np.linalg.eigvals(
                model.A - model.B @ placed_loop(distance, rounded=own).gain
            ).real.max()
        )
        for model in models
        for own in (False, True)
        for distance in DISTANCES
    )
    return PRINTED[_PLACE, "robustness"].claimed(
        slowest < 0.0 and bool(np.all(steps >= STEP)),
        "; ".join(
            f"{', '.join(f'{1e6 * step:.2g}' for step in way)} µm {words}"
            for way, words in zip(steps.T, ("upward", "downward"), strict=True)
        ),
    )


def _largest_steps(loop: FeedbackLoop) -> tuple[float, float]:
    """Return the steps up and down [m] of the setpoint that just keep h1 > h2 > h3 > 0 on (2)."""
    levels, _ = loop.step(STEP, _TIME)
    drops = levels @ np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
    room = -np.diff([*LEVELS, 0.0])
    up, down = -drops.min(axis=0), drops.max(axis=0)
    return float(STEP * np.min(room / up.clip(min=_NOTHING))), float(STEP * np.min(room / down))


def _without_offset() -> Row:
    """Take K and N as Table 2 prints them."""
    model, left = rounded_model(), []
    for distance in DISTANCES:
        of = f"-{distance} ± j{distance}"
        *gain, setpoint = PRINTED.numbers(
            "Table 2", *(f"{name}, {of}" for name in ("K1", "K2", "K3", "N"))
        )
        loop = FeedbackLoop(of, np.array([gain]), model)
        left.append(100.0 * (1.0 - setpoint / loop.setpoint_gain))
    return PRINTED[_PLACE, "steady-state error with precompensator"].claimed(
        max(map(abs, left)) < 0.005, ", ".join(f"{each:.4f}" for each in left) + " %"
    )


def _speed(loops: list[FeedbackLoop]) -> Row:
    settled: dict[float, list[tuple[float, float]]] = {band: [] for band in BANDS}
    for loop in loops:
        alone = loop.step_without_precompensator(_TIME)
        alone = STEP * loop.setpoint_gain * alone
        level = loop.step(STEP, _TIME)[0][:, 2]
        for band, pairs in settled.items():
            pairs.append((settling(_TIME, alone, band), settling(_TIME, level, band)))
    assert all(
        abs(after - before) < 1.5 * _TIME[1]
        for pairs in settled.values()
        for before, after in pairs
    )
    # Never at the setpoint without N.
    assert all(loop.setpoint_gain > 1.0 + max(BANDS) for loop in loops)
    return PRINTED[_PLACE, "speed by the precompensator"].remark(
        ", ".join(f"{before:.3f} and {after:.3f} s" for before, after in settled[BANDS[0]])
    )


def _specifications(loop: FeedbackLoop) -> Row:
    _, upper = loop.poles
    swing = np.cos(upper.imag * _TIME) - upper.real / upper.imag * np.sin(upper.imag * _TIME)
    responses = {
        "pair alone": STEP * (1.0 - np.exp(upper.real * _TIME) * swing),
        "with the third pole": loop.step(STEP, _TIME)[0][:, 2],
    }
    over = {who: 100.0 * float(level.max() / STEP - 1.0) for who, level in responses.items()}
    settled = {
        who: [settling(_TIME, level, band) for band in (0.01, *BANDS)]
        for who, level in responses.items()
    }
    alone, whole = settled.values()
    assert over["pair alone"] > OVERSHOOT > over["with the third pole"]
    assert max(alone) < SETTLING and whole[0] > SETTLING > max(whole[1:])
    return PRINTED[_PLACE, "ω_d of the specifications"].remark(
        "; ".join(
            f"{who} {over[who]:.1f} %, {', '.join(f'{each:.3f}' for each in settled[who])} s"
            for who in responses
        )
    )


def _offset(loops: list[FeedbackLoop]) -> Row:
    left = [100.0 * (1.0 - 1.0 / loop.setpoint_gain) for loop in loops]
    return PRINTED[_PLACE, "steady-state error without precompensator"].claimed(
        min(left) > 50.0, ", ".join(f"{each:.4f}" for each in left) + " % of the step"
    )
