"""Section 3.2: model (21) and its step response."""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.identification.simplex_refinement import (
    refined_coefficients,
    second_order_of_gain,
)
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.identification import DELAYS, STEP
from clepsydra.papers.eight_tanks.six_designs import (
    GAIN,
    PERIOD,
    PRINTED_A,
    PRINTED_B,
    PRINTED_D,
    printed_model,
    sampled_chain,
)
from clepsydra.papers.figure import Curve, Figure, Panel, curves
from clepsydra.papers.rational_function import symbols
from clepsydra.papers.row import Rows

_MINUTES = 80
#: The length of the record is not printed; with so many samples every digit of (21) does.
_PRINTED_SAMPLES = 49


def run() -> Found:
    """Return the rows of section 3.2 and Fig. 4."""
    return (*_coefficients(), *_gain(), *_quality(), _steps())


@cache
def _record(minutes: int = _MINUTES) -> tuple[np.ndarray, np.ndarray]:
    inflow = np.concatenate([np.zeros(1), np.full(minutes, STEP)])
    return inflow, sampled_chain().output(inflow)


@cache
def _fitted(minutes: int = _MINUTES, delay: int = PRINTED_D) -> SampledModel:
    """Return the held second-order model without zeros, of gain 3.08, that fits the step."""
    return second_order_of_gain(
        *_record(minutes), gain=GAIN, delay=delay, period=PERIOD, start=(0.1, 1.0)
    )


@cache
def _free(minutes: int = _MINUTES) -> SampledModel:
    return refined_coefficients(_fitted(minutes), *_record(minutes))


def _coefficients() -> Rows:
    model = _fitted(_PRINTED_SAMPLES)
    chosen = (
        f"The length of the record, {_PRINTED_SAMPLES} samples, and what the search holds were "
        "chosen so that (21) comes out."
    )
    found = (*model.denominator, *model.numerator)
    for name, value in zip(("a1", "a2", "b1", "b2"), found, strict=True):
        yield PRINTED["(21)", name].compared(value).circular(chosen)
    free = _free(_PRINTED_SAMPLES)
    b1, b2 = free.numerator
    yield PRINTED["section 3.2", "how (21) was found"].remark(
        f"b1 = {b1:.4f}, b2 = {b2:.4f}, gain {free.static_gain:.3f}"
    )


def _gain() -> Rows:
    b1, b2, a1, a2, back = symbols("b1 b2 a1 a2 x")
    model = (b1 * back + b2 * back**2) / (1 + a1 * back + a2 * back**2) * back**5
    low, high = _gain_range()
    yield PRINTED["(20)", "static gain of (18)"].formula(model.with_values({"x": 1}))
    gain = printed_model().static_gain
    line = PRINTED["(21)", "static gain, the same as in (8)"].told(low=low, high=high)
    yield line.compared(gain, tolerance=(high - low) / 2.0 / gain)


def _gain_range() -> tuple[float, float]:
    """Return the gains that the printed digits of (21) leave open."""
    sums = sum(PRINTED_B), 1.0 + sum(PRINTED_A)
    rooms = [
        sum(PRINTED["(21)", f"{letter}{place}"].number.half_unit for place in (1, 2))
        for letter in "ba"
    ]
    return (sums[0] - rooms[0]) / (sums[1] + rooms[1]), (sums[0] + rooms[0]) / (sums[1] - rooms[1])


def _quality() -> Rows:
    worst = _largest_error(printed_model())
    errors = [_largest_error(_fitted(delay=delay)) for delay in DELAYS]
    best = int(np.argmin(errors))
    assert errors[best] < 5.0 < worst < 10.0
    yield PRINTED["section 3.2", "static gain as a criterion"].remark(
        f"{errors[0]:.1f} % of the rise with d = 0, {errors[PRINTED_D]:.1f} % with d = "
        f"{PRINTED_D}, {errors[best]:.1f} % with d = {best}",
        largest=max(DELAYS),
        minutes=_MINUTES,
    )
    zeros = [float(model.zeros[0].real) for model in (printed_model(), _free(_PRINTED_SAMPLES))]
    assert abs(zeros[0]) < 1.0 < abs(zeros[1])
    b1, b2 = _free(_PRINTED_SAMPLES).numerator
    yield PRINTED["section 7", "low-order model of the chain"].remark(
        f"{worst:.1f} % of the rise at the most by (21)", minutes=_MINUTES
    )
    yield PRINTED["section 4", "zero of B, which B(1) replaces"].remark(
        f"z = {zeros[0]:.3f} of (21), z = {zeros[1]:.2f} with b1 = {b1:.4f}, b2 = {b2:.4f}"
    )


def _largest_error(model: SampledModel) -> float:
    """Return the largest difference to the step response of (8) [% of the rise]."""
    inflow, level = _record()
    return 100.0 * float(np.max(np.abs(model.output(inflow) - level))) / (GAIN * STEP)


def _steps() -> Figure:
    inflow, level = _record()
    minutes = np.arange(len(inflow)) - 1.0
    free = _free().output(inflow)
    simplex = "free simplex fit, d = 5"
    responses = (
        Curve("chain (8)", minutes, 100.0 * level),
        Curve("model (21)", minutes, 100.0 * printed_model().output(inflow), "dashed"),
        Curve(simplex, minutes, 100.0 * free, "points"),
    )
    models = {
        "model (21)": printed_model(), simplex: _free(), "gain held, d = 7": _fitted(delay=7),
    }  # fmt: skip
    errors = {name: 100.0 * (model.output(inflow) - level) for name, model in models.items()}
    return Figure(
        "Fig. 4",
        "Step responses to 0.04 m³/min",
        (
            Panel("Level of tank 8", "h8 [cm]", responses, "time [min]"),
            Panel(
                "Difference to the chain", "difference [cm]", curves(minutes, errors), "time [min]"
            ),
        ),
        "After ten minutes the printed model runs ahead of the chain by up to "
        f"{np.max(printed_model().output(inflow) - level) * 1000:.1f} mm; with two more samples of "
        "delay it would follow more closely.",
    )
