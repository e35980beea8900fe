"""Digital Smith predictors with a polynomial or a PI controller as primary controller."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import elements, path
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.smith_predictor import FAMILY, PredictorShape, smith_predictor_law
from clepsydra.designs.applicability import NotApplicable, reasons_about
from clepsydra.designs.arguments.argument import word
from clepsydra.designs.arguments.numbers import ASSIGNED_POLES, PENALTY
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.closed_loop_time import CLOSED_LOOP_TIME
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.models.delayed_lags import half_rule
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.polynomial.paired_design import paired_controller
from clepsydra.designs.polynomial.paired_models import (
    LoopGains,
    ModelledPair,
    Request,
    modelled_pairs,
    polynomial_gains,
)
from clepsydra.designs.polynomial.sampled_model import ON_THE_CIRCLE, SampledModel
from clepsydra.designs.polynomial_control import SOURCE
from clepsydra.designs.simc import simc_settings
from clepsydra.linear.linear_model import LinearModel

Primary = Literal["polynomial", "PI"]
#: Phase margin of the loop that keeps an integrating model with its process, as Mataušek and
#: Micić's rule κ = 1/(2 k L) has it [rad].
_PHASE_MARGIN = math.pi / 2 - 0.5
#: A pair of poles damped at least so well is taken for two equal lags.
_DAMPED = 0.5
_POINTS = 4000


@design(
    "smith_predictor",
    "Smith predictor",
    Studied(230, "Smith predictor, LQ"),
    Studied(240, "Smith predictor, PI", {"primary": "PI"}),
    keys=(
        word("primary", "what controls the model without its delay", Primary),
        PENALTY,
        ASSIGNED_POLES,
        CLOSED_LOOP_TIME,
    ),
)
def design_smith_predictor(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    primary: Primary = "polynomial",
    penalty: float | None = None,
    assigned_poles: Sequence[float] | None = None,
    closed_loop_time_constant: float | None = None,
    models: Sequence[SampledModel] | None = None,
) -> Controller:
    """Design a digital Smith predictor for each pair.

    Each paired element is sampled, of second order at most with whole samples of delay
    (`designs.polynomial.element_sampling`). The primary controller is designed for the model
    without its delay and with B(1) z^-1 in the place of B:

    - "polynomial": the spectral factor of A and B for q_u and the assigned poles make D, and
      A (1 − z^-1) P + B(1) z^-1 Q = D with r0 = D(1)/B(1) the controller. q_u and poles are
      chosen as in `designs.polynomial_control` where they are not given.
    - "PI": SIMC for the lags of the model, with half a sampling period as delay.

    Where nothing is given all loops are slowed down by one factor until together they have a
    sensitivity peak of 2.

    The plain predictor keeps an offset under a load where the model integrates. There the
    predicted error also moves the model, by a gain κ that leaves that loop a phase margin of
    61 degrees (Mataušek and Micić). An unstable element is refused.

    Parameters
    ----------
    primary : {"polynomial", "PI"}
    penalty, assigned_poles
        Of the polynomial controller, as in `design_polynomial`.
    closed_loop_time_constant : float, optional
        τc of the PI controller [s].
    models : sequence of SampledModel, optional
        One for each pair, an identified one say, in the place of the process's own.

    Raises
    ------
    NotApplicable
        No element has a delay, one is unstable, has no sampled model or no lags for a PI
        controller, the loops are unstable together, or a gain is outside of what a controller
        takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the primary
        controller is unknown, a setting is given that it does not have or is out of range, or a
        given model is unstable or does not fit.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, sections 4 and 5; M. R. Mataušek, A. D. Micić, A modified Smith predictor for
    controlling a process with an integrator and long dead-time, IEEE Transactions on Automatic
    Control 41(8), 1996, 1199-1203.

    Examples
    --------
    The design of Fig. 8, for the model that the document prints:

    >>> import clepsydra as cl
    >>> analysis = cl.load("eight-tanks").analysis
    >>> printed = SampledModel((0.0309 * 60, 0.0286 * 60), (-1.777, 0.7964), 5, 60.0)
    >>> controller = design_smith_predictor(
    ...     analysis.model, analysis.pairing, penalty=10 * 3600, assigned_poles=[0.5],
    ...     models=[printed])
    >>> round(60 * controller.values["level_8.reference_gain"], 4)  # [m³/min/m]
    0.2232
    """
    request = Request(penalty, assigned_poles)
    given, time = request.in_words(), closed_loop_time_constant
    if primary == "PI" and given:
        remedy = "give closed_loop_time_constant, or primary = polynomial"
        raise InputError("penalty and assigned_poles", given, "none for a PI controller", remedy)
    if time is not None and primary == "polynomial":
        place, expected = "closed_loop_time_constant", "none for a polynomial controller"
        raise InputError(place, time, expected, "give penalty or assigned_poles, or primary = PI")
    pairs = modelled_pairs(model, pairing, models)
    for pair in pairs:
        _check(pair, models is not None)
    if not any(pair.sampled.delay for pair in pairs):
        raise NotApplicable(
            "no pair has a delay of a sampling period, so that there is nothing to predict; "
            "2DOF polynomial control is the same without a predictor"
        )

    def gains_at(factor: float) -> list[LoopGains]:
        if primary == "PI":
            return [_simc(pair, time, factor) for pair in pairs]
        return [
            polynomial_gains(pair, request, factor, (0.0, math.fsum(pair.sampled.B)))
            for pair in pairs
        ]

    feedback = [_error_feedback(pair.sampled) for pair in pairs]
    shapes = [
        PredictorShape(
            loop.shape, model.order, len(model.numerator), model.delay, error_feedback=bool(kappa)
        )
        for loop, model, kappa in zip(
            gains_at(1.0), [pair.sampled for pair in pairs], feedback, strict=True
        )
    ]
    law = smith_predictor_law(
        [pair.output for pair in pairs], [pair.input for pair in pairs], shapes
    )
    kind, means, source = "LQ", "polynomial", SOURCE
    if primary == "PI":
        kind = means = "PI"
        source = "SIMC (Skogestad 2003) for the model without its delay"
        given = "" if time is None else f"a closed-loop time constant of {time:g} s"
    name, control = f"Smith predictor, {kind}", f"{FAMILY} with {means} control"
    integrating = [pair.pair for pair, kappa in zip(pairs, feedback, strict=True) if kappa]
    note = (
        f"{', '.join(integrating)}: the process integrates, so that its model follows it by the "
        "predicted error (Mataušek and Micić); a plain predictor would keep an offset under loads."
    )
    notes, fixed = [note] if integrating else [], _fixed(pairs, feedback)
    return paired_controller(
        name, control, model, pairs, law, gains_at, source, given, notes, fixed
    )


def _check(pair: ModelledPair, given: bool) -> None:
    """Refuse a model whose poles the open loop of the predictor would not bear."""
    model = pair.sampled
    if not model.order:
        expected = "a model with a pole: the predictor runs it from sample to sample"
        remedy = "identify one with a coefficient a1"
        raise InputError("models", model.in_words(), expected, remedy)
    outside = np.sum(np.abs(model.poles) >= 1.0 - ON_THE_CIRCLE)
    if outside > (1 if model.is_integrating else 0):
        if given:
            expected = "a stable model, or one that integrates once"
            remedy = "use 2DOF polynomial control, which holds unstable processes"
            raise InputError("models", model.in_words(), expected, remedy)
        raise NotApplicable(
            f"{pair.pair}: the model is unstable without control, or integrates twice; 2DOF "
            "polynomial control can hold it"
        )
    if abs(math.fsum(model.B)) <= 1e-9 * float(np.sum(np.abs(model.B))):
        raise NotApplicable(f"{pair.pair}: the input cannot hold the output")


def _simc(pair: ModelledPair, given: float | None, factor: float) -> LoopGains:
    """Return the gains of a PI controller for the model without its delay."""
    model, time = pair.sampled, given
    with reasons_about(pair.pair):
        lags = half_rule(_without_delay(model), model.period / 2.0)
    if time is None:
        room = 1.0 / math.sqrt(pair.usual_penalty)
        time = factor * max(lags.delay, 1.0 / (abs(lags.slope) * room) - lags.delay)
    gain, integral_time, _ = simc_settings(lags, time)
    words = f"Ti = {time_text(integral_time)}, τc = {time_text(time)}"
    return LoopGains(gain * model.period / integral_time, (gain,), (gain,), (), words)


def _without_delay(model: SampledModel) -> TransferElement:
    """Return the continuous element of the model's gain and poles.

    A well damped pair of poles is taken for two equal lags of its natural frequency.
    """
    poles: list[complex] = []
    integrators = 0
    for pole in model.poles:
        if abs(pole - 1.0) <= ON_THE_CIRCLE:
            integrators += 1
            continue
        if abs(pole) < 1e-12 or (pole.imag == 0.0 and pole.real < 0.0):
            raise NotApplicable(f"the pole {pole.real:.3g} of its model is that of no lag")
        rate = complex(np.log(pole)) / model.period
        if rate.imag and -rate.real < _DAMPED * abs(rate):
            raise NotApplicable("its model oscillates; choose the polynomial controller")
        poles.append(rate if not rate.imag else complex(-abs(rate)))
    gain = model.static_gain
    if integrators:
        rest = np.polydiv(model.A, [1.0, -1.0])[0]
        gain = math.fsum(model.B) / float(np.sum(rest)) / model.period
    return TransferElement(gain, tuple(poles), (), integrators)


def _error_feedback(model: SampledModel) -> float:
    """Return κ for an integrating model, zero for others."""
    if not model.is_integrating:
        return 0.0
    frequencies = np.geomspace(1e-7, 1.0, _POINTS) * math.pi
    values = model.response(np.exp(1j * frequencies))
    sign = math.copysign(1.0, math.fsum(model.B) / float(np.sum(np.polydiv(model.A, [1, -1])[0])))
    phase = np.unwrap(np.angle(sign * values))
    passed = int(np.argmax(phase <= _PHASE_MARGIN - math.pi))
    if passed == 0:
        passed = len(phase) - 1
    below, above = phase[passed - 1], phase[passed]
    share = (below - (_PHASE_MARGIN - math.pi)) / (below - above)
    sizes = np.log(np.abs(values[passed - 1 : passed + 1]))
    return sign * float(np.exp(-(sizes[0] + share * (sizes[1] - sizes[0]))))


def _fixed(pairs: Sequence[ModelledPair], feedback: Sequence[float]) -> dict[str, float]:
    """Return the parameters of the models, of B, A and the operating point."""
    values: dict[str, float] = {}
    for pair, kappa in zip(pairs, feedback, strict=True):
        y, model, total = pair.output, pair.sampled, math.fsum(pair.sampled.B)
        values[path(y, "model_gain")] = total
        shares = [b / total for b in model.numerator]
        for part, numbers in (("model_feedback", model.denominator), ("model_share", shares)):
            values |= dict(zip(elements(path(y, part), len(numbers)), numbers, strict=True))
        if kappa:
            values[path(y, "error_feedback")] = kappa
    return values
