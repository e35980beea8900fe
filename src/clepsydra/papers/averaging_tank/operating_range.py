"""Section 5, asked again: what large steps cost, by wind-up or nonlinearity, and what helps."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Sequence
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np

from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, lqi_of
from clepsydra.papers.averaging_tank.pi import BY_HAND, OPTIMAL, pi_controller
from clepsydra.papers.averaging_tank.range_controllers import (
    KINDS,
    controller_of,
    linear_errors,
)
from clepsydra.papers.averaging_tank.step_batch import absolute_errors, step_batch
from clepsydra.papers.averaging_tank.step_run import MEASURED, SIGNALS, model_of
from clepsydra.papers.averaging_tank.symbols import C0, V0, VARIANTS, Variant, constant_flow
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Curve, Figure, Panel, curves
from clepsydra.papers.row import Row, Rows

PERIOD, HORIZON = 0.01, 30.0  # [s]
#: The document's own step, and half of the operating point, both ways; and one to C = 8 kmol/m³
#: and V = 4 m³.
_SMALL = 0.05
_LARGE = (-0.5, 0.5)
_SHARES = (-0.5, -0.25, -0.05, 0.05, 0.25, 0.5)
_PERIODS = (1e-3, 1e-2, 1e-1)  # [s]
#: Drawn at every sampling period.
_SAMPLED = ("PI", "PI, anti-windup", "LQI", "LQI, anti-windup", "LQI, recomputed, anti-windup")
_LAWS = ("PI", "LQI")
_ALL_OF_IT = 0.99
#: A decline that a remedy lowers by less is as it was.
_FELT = 0.01
_TUNINGS = ("by hand", "optimal")
#: A usual cycle of a programmable logic controller [s].
CYCLE = 0.01
#: Sampling periods between which stability is sought [s], and halvings of that interval.
_LONGEST, _SHORTEST, _HALVINGS = 10.0, 1e-5, 16


class Step(NamedTuple):
    """Steps of both references, as shares of their values at rest."""

    concentration: float
    volume: float

    @property
    def sizes(self) -> tuple[float, float]:
        """Of C [kmol/m³] and V [m³]."""
        return self.concentration * C0, self.volume * V0

    def relative(self, errors: Iterable[float]) -> float:
        """Return the mean of errors of C and V over the sizes of their steps, if they step."""
        both = zip(errors, self.sizes, strict=True)
        return float(np.mean([error / abs(size) for error, size in both if size]))

    @property
    def small(self) -> Step:
        """Steps of the document's size in the same directions."""
        return Step(*(_SMALL * float(np.sign(share)) for share in self))

    @property
    def words(self) -> str:
        """As the reader sees it."""
        told = zip(MEASURED, self.sizes, ("kmol/m³", "m³"), strict=True)
        return " and ".join(f"{name} by {size:+g} {unit}" for name, size, unit in told if size)


LARGE_STEPS = (
    *(Step(share, 0.0) for share in _LARGE),
    *(Step(0.0, share) for share in _LARGE),
    *(Step(*shares) for shares in product(_LARGE, _LARGE)),
    Step(0.6, 1.0),
)
#: Steps of one output.
_BY_SIZE = {
    "C": [Step(share, 0.0) for share in _SHARES],
    "V": [Step(0.0, share) for share in _SHARES],
}
#: Every step, with those of the document's size.
STEPS = tuple({*LARGE_STEPS, *_BY_SIZE["C"], *_BY_SIZE["V"], *(each.small for each in LARGE_STEPS)})


def run() -> Found:
    """Return the rows on large steps, sampling and actuators, and their figures."""
    return (*_declines(), sampling_row(), *_trends(), _by_size(), _by_period())


def range_runs(
    constant: Variant, kind: str, steps: Sequence[Step], period: float = PERIOD
) -> dict[str, np.ndarray]:
    """Return one of `KINDS` through steps, as `step_batch` does."""
    model = model_of(constant, period, high=True)
    sizes = [step.sizes for step in steps]
    return step_batch(controller_of(constant, kind, period), model, sizes, HORIZON)


@cache
def relative_errors(
    constant: Variant, kind: str, steps: tuple[Step, ...] = STEPS, period: float = PERIOD
) -> dict[Step, float]:
    """Return ∫ |e| dt over the size of each step [s], the mean of the outputs that step.

    In a linear loop without limits it is the same for every size.
    """
    errors = absolute_errors(range_runs(constant, kind, steps, period))
    return {step: step.relative(both) for step, both in zip(steps, errors.T, strict=True)}


def decline(constant: Variant, kind: str, step: Step) -> float:
    """Return by what share the relative error of a step exceeds that of the document's step.

    Each beside the document's step in the same directions: with C_in between 0 and 25 kmol/m³ and
    5 at rest, and the flows between 0 and 1 m³/s and 0.2 at rest, a step down has less room.
    """
    errors = relative_errors(constant, kind)
    return errors[step] / errors[step.small] - 1.0


@cache
def linear_declines(constant: Variant, kind: str) -> dict[Step, float]:
    """Return the `decline` of each large step on the linear model under the same limits.

    There C and V do not act on each other under these laws, so that each has one error a size.
    """
    controller, model = controller_of(constant, kind, PERIOD), model_of(constant, PERIOD, high=True)
    every = [each.sizes for step in LARGE_STEPS for each in (step, step.small)]
    sizes = [sorted({size for size in of_one if size}) for of_one in zip(*every, strict=True)]
    found = linear_errors(controller, model, list(zip(*sizes, strict=True)), HORIZON)
    of_size = [
        dict(zip(of_one, errors, strict=True)) for of_one, errors in zip(sizes, found, strict=True)
    ]

    def relative(step: Step) -> float:
        return step.relative(
            errors.get(size, 0.0) for errors, size in zip(of_size, step.sizes, strict=True)
        )

    return {step: relative(step) / relative(step.small) - 1.0 for step in LARGE_STEPS}


def _worst(constant: Variant, kind: str) -> tuple[float, Step]:
    declines = [(decline(constant, kind, step), step) for step in LARGE_STEPS]
    return max(declines, key=lambda pair: pair[0])


def _declines() -> Rows:
    found, causes, shares = [], [], {}
    for constant in VARIANTS:
        for kind in _LAWS:
            worst, step = _worst(constant, kind)
            linear = linear_declines(constant, kind)
            without = decline(constant, f"{kind}, anti-windup", step)
            found.append(f"{_times(worst)} ({kind}, {constant_flow(constant)}, {step.words})")
            causes.append(
                f"{kind}, {constant_flow(constant)}: {_times(worst)} in the tank, "
                f"{_times(linear[step])} on the linear model, where the worst is "
                f"{_times(max(linear.values()))}, and {_times(without)} in the tank with "
                "anti-windup"
            )
            shares[constant, kind] = (1.0 + linear[step]) / (1.0 + worst)
    assert all(shares["inflow", kind] > _ALL_OF_IT for kind in _LAWS)
    yield PRINTED["section 5", "large steps"].remark("; ".join(found))
    yield PRINTED["section 5", "cause of the decline"].remark(
        "; ".join(causes),
        pi=f"{shares['outflow', 'PI']:.2f}",
        lqi=f"{shares['outflow', 'LQI']:.2f}",
    )
    scheduled = [_remedy(c, kind, f"{kind}, scheduled") for c in VARIANTS for kind in _LAWS]
    cyclic = [_remedy(constant, "LQI", "LQI, recomputed") for constant in VARIANTS]
    yield PRINTED["section 5", "gain scheduling"].remark("; ".join(scheduled))
    yield PRINTED["section 5", "cyclic calculation"].remark("; ".join(cyclic))


def _remedy(constant: Variant, kind: str, remedy: str) -> str:
    """Return the worst decline with and without a remedy, and where it helps most, in words."""
    ends = "", ", anti-windup"
    before, alone = (_worst(constant, f"{kind}{end}")[0] for end in ends)
    after, both = (_worst(constant, f"{remedy}{end}")[0] for end in ends)
    pairs = {s: (decline(constant, remedy, s), decline(constant, kind, s)) for s in LARGE_STEPS}
    step, (helped, plain) = max(pairs.items(), key=lambda pair: pair[1][1] - pair[1][0])
    is_felt = plain - helped > _FELT
    most = f"most with {step.words}, {_times(helped)} and {_times(plain)}" if is_felt else "nowhere"
    return (
        f"{kind}, {constant_flow(constant)}: {_times(after)} with it and {_times(before)} "
        f"without, under anti-windup {_times(both)} and {_times(alone)}; it "
        f"helps {most}"
    )  # fmt: skip


def _times(decline: float) -> str:
    return f"{1.0 + decline:.2f} times"


def _trends() -> Found:
    """Draw two large steps under the loops by hand."""
    steps = {"V falls by half": Step(0.0, -0.5), "C and V rise by half": Step(0.5, 0.5)}
    runs = {kind: range_runs("outflow", kind, list(steps.values())) for kind in _SAMPLED}
    shown = slice(0, int(20.0 / PERIOD), 4)
    for lane, what in enumerate(steps):
        panels = [
            Panel(name, label, [
                Curve(kind, run["time"][shown], run[signal][lane, shown] / factor, drawn)
                for kind, run in runs.items()
            ])
            for name, signal, label, factor, drawn in SIGNALS if name != "f_out"
        ]  # fmt: skip
        yield Figure(
            "", f"A large step with f_out constant: {what}", panels,
            "Constants by hand. While an input stands at its limit, an integral without "
            "anti-windup goes on.",
        )  # fmt: skip


def _by_size() -> Figure:
    """Draw the relative error against the size of a step."""
    panels = []
    for output, steps in _BY_SIZE.items():
        errors = {k: [relative_errors("outflow", k)[step] for step in steps] for k in KINDS}
        shown = curves(100.0 * np.array(_SHARES), errors)
        panels.append(Panel(output, "IAE / step [s]", shown, f"step of {output} [% of its value]"))
    return Figure(
        "", "What a step costs, against its size, f_out constant",
        panels, "A flat line would be a linear loop without limits.",
    )  # fmt: skip


def _by_period() -> Figure:
    """Draw the relative error of large steps against the sampling period."""
    panels, steps = [], LARGE_STEPS[:4]
    # At the period of all the other runs these steps are among theirs.
    others = [() if period == PERIOD else (steps, period) for period in _PERIODS]
    found = {k: [relative_errors("outflow", k, *each) for each in others] for k in _SAMPLED}
    for step in steps:
        errors = {kind: [each[step] for each in by_period] for kind, by_period in found.items()}
        shown = curves(1e3 * np.array(_PERIODS), errors)
        panels.append(Panel(step.words, "IAE / step [s]", shown, "sampling period [ms]", True))
    return Figure(
        "", "What large steps cost, against the sampling period",
        panels, "f_out constant, constants by hand.",
    )  # fmt: skip


def sampling_row() -> Row:
    """Return the remark on the sampling period."""
    told = []
    for constant, law, tuned in product(VARIANTS, _LAWS, _TUNINGS):
        before, present = (
            float(f"{1e3 * longest_period(constant, law, tuned, present=each):.3g}")
            for each in (False, True)
        )
        told.append(f"{law} {tuned}, {constant_flow(constant)}: {before:g} and {present:g} ms")
    return PRINTED["section 5", "sampling"].remark("; ".join(told))


def longest_period(constant: Variant, law: str, tuned: str, *, present: bool = False) -> float:
    """Return up to which sampling period a design's loop is stable [s], by halving the interval.

    The sum for the integral ends at the error before the present one, or with it, `present`.

    Examples
    --------
    PI control of V, an integrator, is stable while Kp Δt²/Ti − 2 Kp Δt + 4 > 0, up to
    (2 − √3) s with Kp = 8 1/s and Ti = 2 s:

    >>> abs(longest_period("outflow", "PI", "by hand") - (2 - 3**0.5)) < 1e-4
    True
    """
    place, at_cycle = _TUNINGS.index(tuned), model_of(constant, CYCLE)
    constants = (BY_HAND, OPTIMAL)[place][constant]
    weights = COLUMNS[2 * VARIANTS.index(constant) + place]
    low, high = math.log(_SHORTEST), math.log(_LONGEST)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        model = _sampled(model_of(constant), math.exp(middle))
        summed = math.exp(middle) if present else 0.0
        controller = (
            pi_controller(constants.summed(summed), at_cycle)
            if law == "PI"
            else lqi_of(weights, at_cycle, summed)
        )
        is_stable = SampledLoops(controller, model).at(controller.values).is_stable
        low, high = (middle, high) if is_stable else (low, middle)
    return math.exp(low)


def _sampled(model: LinearModel, period: float) -> LinearModel:
    point = operating_point_of(model)
    process = dataclasses.replace(point.process, sampling_period=period)
    return dataclasses.replace(model, point=dataclasses.replace(point, process=process))
