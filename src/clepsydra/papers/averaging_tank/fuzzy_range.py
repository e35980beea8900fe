"""Section 5 of fuzzy control: large steps, and the scan of a programmable logic controller."""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.loop.run import Run
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.fuzzy import FILTERED, Reading, fuzzy_loop, fuzzy_run
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, lqi_of
from clepsydra.papers.averaging_tank.operating_range import (
    CYCLE,
    HORIZON,
    LARGE_STEPS,
    Step,
    relative_errors,
)
from clepsydra.papers.averaging_tank.step_batch import absolute_errors, step_batch
from clepsydra.papers.averaging_tank.step_run import MEASURED, STEPS, model_of, trend_figure
from clepsydra.papers.averaging_tank.symbols import VARIANTS, constant_flow
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Figure
from clepsydra.papers.row import Row

#: At this scan, and at 0.2 ms, the document's step ends alike [s].
_FAST = 1e-3
_SCANS = (_FAST, 2e-3, 5e-3, CYCLE, 2.0 * CYCLE)
#: Of a run at a scan, and its end that is looked at [s].
_RUN, _END = 10.0, 2.0
_BY_HAND = {
    f"{law}, {constant_flow(constant)}": (constant, law)
    for law in ("PI", "LQI")
    for constant in VARIANTS
}


def run() -> Found:
    """Return the rows on large steps and on scans, and a picture of the scans."""
    return (away_from_equilibrium(FILTERED), large_steps(FILTERED), scans(FILTERED), _figure())


@cache
def fuzzy_errors(reading: Reading) -> dict[Step, float]:
    """Return ∫ |e| dt over the size of each large step, and of each small one [s].

    As `operating_range.relative_errors` does, at a scan of a millisecond.
    """
    steps = tuple(dict.fromkeys(each for step in LARGE_STEPS for each in (step, step.small)))
    controller, model = fuzzy_loop(reading, _FAST)
    run = step_batch(controller, model, [step.sizes for step in steps], HORIZON)
    both = zip(steps, absolute_errors(run).T, strict=True)
    return {step: step.relative(errors) for step, errors in both}


def large_steps(reading: Reading) -> Row:
    """Compare the nine steps of `operating_range` under the three kinds of control."""
    errors, best, beaten = fuzzy_errors(reading), 0, []
    declines = {step: errors[step] / errors[step.small] for step in LARGE_STEPS}
    for step in LARGE_STEPS:
        error = errors[step]
        others = {who: relative_errors(*each)[step] for who, each in _BY_HAND.items()}
        below = [f"{who} {other:.2f} s" for who, other in others.items() if other < error]
        best += not below
        if below:
            beaten.append(f"{step.words}, {error:.2f} s ({'; '.join(below)})")
    worst = max(declines, key=lambda step: declines[step])
    named = " nor of ".join(beaten)
    return PRINTED["section 5", "fuzzy control, large steps"].remark(
        f"smallest error in {best} of {len(LARGE_STEPS)} steps; not of {named}; "
        f"{min(declines.values()):.1f} to {declines[worst]:.1f} times that of a small step, "
        f"most of {worst.words}"
    )


def away_from_equilibrium(reading: Reading) -> Row:
    """Count the large steps in which fuzzy control has a smaller error than LQI."""
    found = fuzzy_errors(reading)
    errors = {who: relative_errors(*_BY_HAND[who]) for who in _BY_HAND if who.startswith("LQI")}
    told = {f"{who}, by hand": each for who, each in errors.items()}
    for weights in (each for each in COLUMNS if each.tuned == "optimal"):
        model = model_of(weights.constant, _FAST, high=True)
        sizes = [step.sizes for step in LARGE_STEPS]
        run = step_batch(lqi_of(weights, model), model, sizes, HORIZON)
        both = zip(LARGE_STEPS, absolute_errors(run).T, strict=True)
        told[f"LQI, {weights.title}"] = {step: step.relative(each) for step, each in both}
    better = {who: [found[step] < each[step] for step in LARGE_STEPS] for who, each in told.items()}
    ((who, step),) = (
        (who, step)
        for who, each in better.items()
        for step, less in zip(LARGE_STEPS, each, strict=True)
        if not less
    )
    exception = f"{step.words}, {found[step]:.2f} s against {told[who][step]:.2f} s of {who}"
    line = PRINTED["section 4", "LQI away from the equilibrium"].told(exception=exception)
    return line.remark(
        "; ".join(f"{who}: {sum(each)} of {len(each)}" for who, each in better.items())
    )


def rest_of(found: Run) -> tuple[float, float, float, float]:
    """Return the largest errors of C and V at the end [% of the step], and f_in [m³/s]."""
    end = found.time > found.time[-1] - _END
    errors = []
    for output, (name, factor) in MEASURED.items():
        error = (found.values[f"{name}.setpoint"] - found.true_measurement(name))[end] / factor
        errors.append(100.0 * float(np.max(np.abs(error))) / STEPS[output])
    inflow = found.values["inflow"][end]
    return errors[0], errors[1], float(inflow.min()), float(inflow.max())


def scans(reading: Reading) -> Row:
    """Tell what is left of the document's step at longer and longer scans."""
    told = []
    for scan in _SCANS:
        of_c, of_v, low, high = rest_of(fuzzy_run(reading, horizon=_RUN, period=scan))
        told.append(
            f"{1e3 * scan:g} ms: C within {of_c:.1f} %, V {of_v:.1f} %, f_in {low:.2f} to "
            f"{high:.2f} m³/s"
        )
    return PRINTED["section 5", "fuzzy control in a PLC"].remark("; ".join(told))


def _figure() -> Figure:
    runs = {f"{1e3 * scan:g} ms": fuzzy_run(FILTERED, horizon=_RUN, period=scan)
            for scan in (_FAST, CYCLE)}  # fmt: skip
    return trend_figure(
        "", "Steps of both references under fuzzy control, at two scans", runs, 1.0,
        f"At {1e3 * CYCLE:g} ms the flows never come to rest.",
    )  # fmt: skip
