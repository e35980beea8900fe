"""FOPDT, SOPDT and IPDT from a record."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.designs.models.delayed_lags import DelayedLags
from clepsydra.identification.control_settings import control_settings
from clepsydra.identification.estimate import Estimate, around, by_logarithm, ratio_signal
from clepsydra.identification.fitted_model import FittedModel
from clepsydra.identification.output_error import LATEST, OutputErrorFit, fit_output_error
from clepsydra.identification.record import Record
from clepsydra.identification.residual_tests import chance_of_no_effect, residual_tests
from clepsydra.identification.structures import IPDT, Structure
from clepsydra.identification.uncertainty import Uncertainty, uncertainty
from clepsydra.identification.validation import USEFUL, fit_percent, fits

#: A dead time of a smaller share of the sampling period is none.
_PROMPT = 1e-6


def transfer_model(
    structure: Structure, record: Record, manipulated: str, output: str
) -> FittedModel:
    """Fit a transfer function with dead time to the first two thirds of a record.

    Examples
    --------
    A tank that fills by 1 mm/s for each volt above 3 V, after 4 s:

    >>> u = 3.0 + np.tile(np.repeat([0.0, 1.0, -1.0], 10), 4)
    >>> level = 0.2 + np.cumsum(np.concatenate([np.zeros(5), 1e-3 * (u[:-5] - 3.0)]))
    >>> record = Record("by hand", (Signal("u", "V"), Signal("h", "m")), {"u": u, "h": level}, 1.0)
    >>> model = transfer_model(IPDT, record, "u", "h")
    >>> [round(each.value, 6) for each in model.estimates], round(model.validated, 3)
    ([0.001, 4.0, 3.0], 100.0)
    """
    u, y = record.moving(manipulated), record.moving(output)
    count = record.held_back
    fit = fit_output_error(structure, u[:count], y[:count], record.period)
    tests = residual_tests(fit.residuals, fit.jacobian, u[:count, None], fit.rounding)
    alone = _alone(structure, y[:count], record.period)
    chance = max(
        chance_of_no_effect(
            without.residuals, fit.residuals, further=2, parameters=fit.jacobian.shape[1],
            noise=tests.noise, rounding=fit.rounding,
        )
        for without in alone
    )  # fmt: skip
    # The dead time was sought over so many whole samples, and the best of them is bound to fit.
    chance = min(1.0, chance * LATEST * count)
    sure = uncertainty(_apart(fit), fit.residuals, [tests.noise])
    signals = record.signal(manipulated, "input"), record.signal(output, "output")
    estimates = _estimates(fit, sure, *signals, float(u[0]))
    reach = float(np.ptp(y[:count])), float(np.ptp(u[:count]))
    simulated, by_itself = fit.simulated(u), alone[0].simulated(np.zeros(len(u)))
    fitted, validated = fits(y, simulated, count)
    return FittedModel(
        name=structure.name,
        title=structure.title,
        formula=structure.formula,
        estimates=estimates,
        parameters=2 + structure.lags,
        simulated=simulated,
        residuals=fit.residuals,
        tests=tests,
        widening=sure.widening,
        fit=fitted,
        validated=validated,
        beyond=fit_percent(y[count:], simulated[count:], by_itself[count:]),
        chance=chance,
        settings=control_settings(_element(fit), signals[1], signals[0], record.period, reach),
        remarks=_remarks(fit, estimates),
        outweighed=_outweighed(estimates, u[:count]),
    )


def _alone(structure: Structure, y: np.ndarray, period: float) -> list[OutputErrorFit]:
    """Return what the output does by itself, as the structure has it and as a ramp, best first."""
    still = np.zeros(len(y))
    found = [fit_output_error(each, still, y, period) for each in {structure, IPDT}]
    return sorted(found, key=lambda fit: float(fit.residuals @ fit.residuals))


def _apart(fit: OutputErrorFit) -> np.ndarray:
    """Return the Jacobian by parameters that can be told apart.

    Where two lags are equal, no small difference of them shows: they count as one.
    """
    if not fit.has_equal_lags:
        return fit.jacobian
    both = np.sum(fit.jacobian[:, -3:-1], axis=1, keepdims=True)
    return np.concatenate([fit.jacobian[:, :-3], both, fit.jacobian[:, -1:]], axis=1)


def _estimates(
    fit: OutputErrorFit, sure: Uncertainty, manipulated: Signal, output: Signal, first: float
) -> tuple[Estimate, ...]:
    """Return gain, lags, dead time and, of an integrating model, the input that holds it."""
    reach, lags = sure.reach, fit.structure.lags
    if fit.structure is IPDT:
        gain = ratio_signal("slope", output, manipulated, "slope per input", per="/s")
    else:
        gain = ratio_signal("gain", output, manipulated, "static gain")
    found = [around(gain, fit.gain, float(reach[0]))]
    names = ("time_constant", "second_time_constant") if lags == 2 else ("time_constant",)
    widths = [reach[-2]] * lags if fit.has_equal_lags else reach[-1 - lags : -1]
    for name, lag, width in zip(names, fit.lags, widths, strict=False):
        signal = Signal(name, "s", low=0.0, description=name.replace("_", " "))
        found.append(by_logarithm(signal, float(lag), float(width)))
    late = fit.delay if fit.delay > _PROMPT * fit.period else 0.0
    dead_time = Signal("dead_time", "s", description="dead time")
    width = float(reach[-1])
    found.append(Estimate(dead_time, late, max(late - width, 0.0), late + width))
    if fit.structure is IPDT and fit.gain != 0.0:
        # y drifts by c a second where the input stays at its first value: c + k' (u − u0) = 0.
        drift = float(fit.free[1])
        gradient = np.zeros(len(reach))
        gradient[0], gradient[2] = drift / fit.gain**2, -1.0 / fit.gain
        signal = Signal(
            "balance", manipulated.unit, display_unit=manipulated.display_unit,
            description=f"{manipulated.name} that holds {output.name}",
        )  # fmt: skip
        found.append(around(signal, first - drift / fit.gain, sure.reach_of(gradient)))
    return tuple(found)


def _element(fit: OutputErrorFit) -> DelayedLags:
    if fit.structure is IPDT:
        return DelayedLags(fit.gain, math.inf, fit.delay)
    lag, *second = map(float, fit.lags)
    return DelayedLags(fit.gain / lag, lag, fit.delay, *second)


def _remarks(fit: OutputErrorFit, estimates: tuple[Estimate, ...]) -> tuple[str, ...]:
    if fit.at_bound:
        return (
            "a time ran into the bounds of the search, so that the record has no trace of "
            f"{fit.structure.title}",
        )
    untold = [
        each.signal.description
        for each in estimates
        if not each.is_told and each.signal.name not in ("dead_time", "balance")
    ]
    return (f"the record does not tell its {' and its '.join(untold)}",) if untold else ()


def _outweighed(estimates: tuple[Estimate, ...], u: np.ndarray) -> bool:
    """Return whether the input that holds the output is nowhere near those of the record."""
    balance = next((each.value for each in estimates if each.signal.name == "balance"), None)
    if balance is None:
        return False
    # Per second the input moved the output by the slope times its range, everything else by the
    # slope times how far the middle of that range is from where the input would hold the output.
    distance = abs(balance - 0.5 * (float(u.max()) + float(u.min())))
    return distance > 100.0 / USEFUL * float(np.ptp(u))
