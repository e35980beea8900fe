"""Section 3.1: least squares, and the number of delay steps by J(d)."""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.identification.arx import ArxFit, fits_by_delay, regressors
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
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
from clepsydra.papers.row import Row, Rows

#: The step of section 3.2 [m³/min].
STEP = PRINTED["section 3.2", "input step Δq"].value
#: The document prints neither.
_SAMPLES, _DEVIATION = 500, STEP
#: Those of Fig. 3.
DELAYS = range(int(PRINTED["Fig. 3", "largest d"].value) + 1)
_RECORDS = 400
#: As (14) lists them.
_ESTIMATES = ("a1", "a2", "b1", "b2")
#: Values of the noise generator in a sampling period.
_FASTER = (1, 2, 5, 10)
#: A delay that so many records choose is one that a single record may have had [%].
_OFTEN = 25.0


def run() -> Found:
    """Return the rows of section 3.1 and Fig. 3."""
    return (*_shapes(), *_delay(), _gain(), _criterion())


@cache
def _records(values_a_sample: int) -> list[dict[int, ArxFit]]:
    """Return the fits by their delay for white noise that is held a part of the period."""
    return [
        fits_by_delay(*record(seed, values_a_sample), order=2, delays=DELAYS)
        for seed in range(_RECORDS)
    ]


def record(seed: int, values_a_sample: int) -> tuple[np.ndarray, np.ndarray]:
    """Return inflow and level of the chain at the samples."""
    random = np.random.default_rng(seed)
    inflow = random.normal(0.0, _DEVIATION, _SAMPLES * values_a_sample)
    level = sampled_chain(period=PERIOD / values_a_sample).output(inflow)
    return inflow[::values_a_sample], level[::values_a_sample]


def _counts(values_a_sample: int) -> np.ndarray:
    """Return how often each delay has the smallest J."""
    chosen = [np.argmin(_costs(fits)) for fits in _records(values_a_sample)]
    return np.bincount(chosen, minlength=len(DELAYS))


def _costs(fits: dict[int, ArxFit]) -> np.ndarray:
    """Return J(d) for each delay."""
    return np.array([fits[delay].cost for delay in DELAYS])


def _shapes() -> Rows:
    order, delay = 2, PRINTED_D
    record = np.random.default_rng(1).normal(size=(2, _SAMPLES))
    F, y = regressors(record[0], record[1], order, delay)
    expected = (_SAMPLES - order - delay, 2 * order)
    parameters, errors = F.shape[1], len(y)
    yield PRINTED["(11)", "dimension of F"].claimed(
        F.shape == expected and len(y) == expected[0],
        f"{F.shape[0]} × {F.shape[1]} for N = {_SAMPLES}, n = 2, d = 5",
        samples=_SAMPLES,
    )
    yield PRINTED["(11)", "regression"].stated("y = F Θ + e", parameters == errors)
    yield PRINTED["(12)", "model order n"].compared(
        len(_ESTIMATES) / 2.0,
        right_if=[
            ("(12) gives 2n estimates, and (14) lists four", len(_ESTIMATES) == parameters),
            ("with n = 8 there would be 16 of them", len(_ESTIMATES) != 2 * 8),
        ],
    )


def _delay() -> Rows:
    chosen = int(np.argmax(_counts(1)))
    line = PRINTED["section 3.1", "delay steps of the smallest J(d)"]
    row = line.compared(float(chosen), records=_RECORDS, samples=_SAMPLES)
    fastest = _FASTER[-1]
    shares = 100.0 * _counts(fastest) / _RECORDS
    agrees = shares[PRINTED_D] > _OFTEN
    hangs_on = (
        f"The noise is not printed: with {fastest} values of it in a sampling period {PRINTED_D} "
        f"and {chosen} have the smallest J about equally often, in {shares[PRINTED_D]:.0f} and "
        f"{shares[chosen]:.0f} % of as many records; with one, {chosen} has it in "
        f"{_counts(1)[chosen]} of {_RECORDS}."
    )
    yield (row.undecided(hangs_on) if agrees else row)


def _gain() -> Row:
    gains = [fits[PRINTED_D].model.static_gain for fits in _records(1)]
    mean, error = float(np.mean(gains)), float(np.std(gains, ddof=1)) / _RECORDS**0.5
    by_squares = "fails" if _squares_of_the_print() > 1.0 else "holds"
    line = PRINTED["section 3.2", "least squares against fminsearch"]
    line = line.told(by_squares=by_squares, records=_RECORDS, samples=_SAMPLES)
    return line.remark(
        f"gain {mean:.2f} ± {error:.2f} by least squares at d = 5, "
        f"{printed_model().static_gain:.3f} of (21), {GAIN} of (8)"
    )


def _squares_of_the_print() -> float:
    """Return J of (21) over that of least squares with the same delay, in the same records."""
    theta = np.array([*PRINTED_A, *PRINTED_B])
    printed = fitted = 0.0
    for seed, fits in enumerate(_records(1)):
        F, y = regressors(*record(seed, 1), 2, PRINTED_D)
        squares = (y - F @ theta) ** 2
        fit = fits[PRINTED_D]
        # The samples that every delay has.
        printed += float(squares[-len(fit.residuals) :].sum())
        fitted += fit.cost
    return printed / fitted


def _criterion() -> Figure:
    delays = np.array(DELAYS, dtype=float)
    mean = np.mean([_costs(fits) for fits in _records(1)], axis=0)
    one = _costs(_records(1)[0])
    shares = {f"{faster} values a period": 100.0 * _counts(faster) / _RECORDS for faster in _FASTER}
    sums = (
        Curve(f"mean of {_RECORDS} records", delays, mean),
        Curve("one record", delays, one, "points"),
    )
    by_speed = "Records in which d has the smallest J, by the speed of the noise generator"
    return Figure(
        "Fig. 3",
        "Criterion of identification quality",
        (
            Panel(f"J(d) of {_SAMPLES} samples", "J [m²]", sums, "delay steps d"),
            Panel(by_speed, "share [%]", curves(delays, shares, "points"), "delay steps d"),
        ),
        "The document finds the minimum at d = 5. With noise held for a sampling period it is at "
        "6; a faster generator scatters it.",
    )
