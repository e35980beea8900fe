"""An ARX model from a record, beside the transfer functions."""

from __future__ import annotations

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.identification.arx import ArxFit, choose_arx, longest_delay
from clepsydra.identification.estimate import Estimate, around, ratio_signal
from clepsydra.identification.fitted_model import FittedModel
from clepsydra.identification.record import Record
from clepsydra.identification.residual_tests import (
    NoiseModel,
    basis_of,
    chance_of_no_effect,
    residual_tests,
)
from clepsydra.identification.uncertainty import uncertainty
from clepsydra.identification.validation import fits


def arx_model(record: Record, manipulated: str, output: str) -> FittedModel:
    """Fit an ARX model to the first two thirds of a record.

    Its residuals are errors of one-step predictions. Where they are coloured the estimates
    themselves are biased, which no interval shows: that is a remark.

    Examples
    --------
    >>> from clepsydra.designs.polynomial.sampled_model import SampledModel
    >>> u = 3.0 + np.sign(np.sin(1.7 * np.arange(90) ** 1.3))
    >>> y = 12.0 + SampledModel((0.2,), (-0.9,), 4, 1.0).output(u - 3.0)
    >>> record = Record("by hand", (Signal("u", "V"), Signal("y", "m")), {"u": u, "y": y}, 1.0)
    >>> model = arx_model(record, "u", "y")
    >>> [(each.signal.name, round(each.value, 6)) for each in model.estimates]
    [('a1', -0.9), ('b1', 0.2), ('delay', 4.0), ('gain', 2.0)]
    """
    u, y = record.moving(manipulated), record.moving(output)
    count = record.held_back
    fit = choose_arx(u[:count], y[:count], record.period)
    rows = len(fit.residuals)
    tests = residual_tests(fit.residuals, fit.jacobian, u[count - rows : count, None], fit.rounding)
    sure = uncertainty(fit.jacobian, fit.residuals, [tests.noise])
    order, model = fit.model.order, fit.model
    moved, measured = record.signal(manipulated, "input"), record.signal(output, "output")
    slope = ratio_signal("b", measured, moved, "")
    estimates: list[Estimate] = []
    for place, value in enumerate([*model.denominator, *model.numerator]):
        letter, number = ("a", place + 1) if place < order else ("b", place - order + 1)
        signal = Signal(f"{letter}{number}", description=f"{letter}{number}")
        if letter == "b":
            signal = Signal(f"b{number}", slope.unit, slope.display_unit, description=f"b{number}")
        estimates.append(around(signal, value, float(sure.reach[place])))
    steps = Signal("delay", description="delay [samples], by Schwarz's criterion")
    estimates.append(Estimate(steps, float(model.delay)))
    if not model.is_integrating:
        below = float(np.sum(model.A))
        gradient = np.zeros(2 * order + 1)
        gradient[:order], gradient[order:-1] = -model.static_gain / below, 1.0 / below
        gain = ratio_signal("gain", measured, moved, "static gain")
        estimates.append(around(gain, model.static_gain, sure.reach_of(gradient)))
    with np.errstate(all="ignore"):
        simulated = fit.simulated(u, y)
    coloured = "its residuals are coloured, which biases its coefficients: take a transfer function"
    fitted, validated = fits(y, simulated, count)
    return FittedModel(
        name="ARX",
        title=f"ARX of order {order} with {model.delay} samples of delay",
        formula=model.in_words(),
        estimates=tuple(estimates),
        parameters=2 * order + 1,
        simulated=simulated,
        residuals=fit.residuals,
        tests=tests,
        widening=sure.widening,
        fit=fitted,
        validated=validated,
        beyond=validated,  # by itself it would stay at its mean
        chance=_chance(fit, y[count - rows : count], tests.noise, longest_delay(count) + 1),
        settings=None,
        remarks=() if tests.white else (coloured,),
    )


def _chance(fit: ArxFit, y: np.ndarray, noise: NoiseModel | None, tests: int) -> float:
    """Return the probability that an input without effect does as well, at the best of delays."""
    order = fit.model.order
    by_itself = basis_of(np.delete(fit.jacobian, np.s_[order : 2 * order], axis=1))
    chance = chance_of_no_effect(
        y - by_itself @ (by_itself.T @ y), fit.residuals, further=order, parameters=2 * order + 1,
        noise=noise,
        rounding=fit.rounding,
    )  # fmt: skip
    return min(1.0, tests * chance)
