"""2DOF polynomial control by LQ spectral factorisation and assigned poles."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.polynomial_controller import FAMILY, polynomial_law
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.numbers import ASSIGNED_POLES, PENALTY
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.polynomial.loop_gains import LoopGains, PairedDesign, of_two_degrees
from clepsydra.designs.polynomial.paired_models import (
    ModelledPair,
    Request,
    characteristic,
    modelled_pairs,
)
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.polynomial.two_degree_of_freedom import two_degree_of_freedom
from clepsydra.linear.linear_model import LinearModel

#: A delay of more samples is left to the Smith predictor: P would have a gain for each.
LONGEST_DELAY = 24


@design(
    "polynomial",
    "polynomial control with two degrees of freedom",
    Studied(220, "2DOF polynomial, LQ"),
    keys=(PENALTY, ASSIGNED_POLES),
)
def design_polynomial(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    penalty: float | None = None,
    assigned_poles: Sequence[float] | None = None,
    models: Sequence[SampledModel] | None = None,
) -> Controller:
    """Design a polynomial controller of two degrees of freedom for each pair.

    Each paired element is sampled, of second order at most (`element_sampling`). Two roots of
    the characteristic polynomial D follow from q_u by spectral factorisation, the others are
    assigned, and the Diophantine equation A (1 − z^-1) P + z^-d B Q = D with r0 = D(1)/B(1)
    gives the controller. The delay is part of the equation, so that an unstable or integrating
    element is no hindrance.

    Without a penalty q_u follows from Bryson's rule; without assigned poles there is one for
    each pole of the spectral factor, as fast as that. Where neither is given, all loops are
    slowed down by one factor until together they have a sensitivity peak of 2.

    Parameters
    ----------
    penalty : float, optional
        q_u of all loops [output unit² / input unit²].
    assigned_poles : sequence of float, optional
        γ of all loops, and further ones.
    models : sequence of SampledModel, optional
        One for each pair, an identified one say, in the place of the process's own.

    Raises
    ------
    NotApplicable
        A signal has no range, an element has no sampled model or a delay of more than 24
        samples, the loops are unstable together, or a gain is outside of what a controller
        takes.
    InputError
        The model has no operating point, the pairing is no pairing of the model, the penalty is
        not above zero, an assigned pole is not stable, the models do not fit, or the input
        cannot hold the output of one.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, section 5.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("wet-well").analysis
    >>> controller = design_polynomial(analysis.model, analysis.pairing)
    >>> controller.name, controller.law.name
    ('2DOF polynomial, LQ', 'polynomial_control')
    """
    request = Request(penalty, assigned_poles)
    point, pairs = modelled_pairs(model, pairing, models)
    for pair in pairs:
        if pair.model.delay > LONGEST_DELAY:
            raise NotApplicable(
                f"{pair.words}: its delay of {pair.model.delay} samples would need as many gains; "
                "a Smith predictor keeps it in a ring"
            )

    def gains_at(factor: float) -> list[LoopGains]:
        return [_gains(pair, request, factor) for pair in pairs]

    law = polynomial_law(
        [pair.output for pair in pairs],
        [pair.input for pair in pairs],
        [loop.shape for loop in gains_at(1.0)],
    )
    design = PairedDesign("2DOF polynomial, LQ", FAMILY, model, point, pairs, law, {}, gains_at)
    return design.controller(
        "Diophantine equation with an LQ spectral factor and assigned poles",
        [models_note(pairs)],
        request.in_words(),
    )


def models_note(pairs: Sequence[ModelledPair]) -> str:
    """Return the sampled models in words.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> tank = SampledModel((0.1,), (-0.9,), 0, 1.0)
    >>> models_note([ModelledPair(Signal("level"), Signal("pump"), tank, 0.0)])
    'Sampled models: level by pump: (0.1 z^-1) / (1 − 0.9 z^-1).'
    """
    words = "; ".join(f"{pair.words}: {pair.model.in_words()}" for pair in pairs)
    return f"Sampled models: {words}."


def _gains(pair: ModelledPair, request: Request, factor: float) -> LoopGains:
    sampled = pair.model
    D, penalty, poles = characteristic(pair, request, factor, sampled.B)
    B = (*[0.0] * sampled.delay, *(float(b) for b in sampled.B))
    try:
        found = two_degree_of_freedom(tuple(sampled.A), B, D)
    except InputError as refusal:
        raise InputError(
            f"{pair.words}, {refusal.place}",
            refusal.value, refusal.expected, refusal.remedy,
        ) from None  # fmt: skip
    return of_two_degrees(found, settings_words(penalty, poles))


def settings_words(penalty: float, poles: Sequence[float]) -> str:
    """Return penalty and assigned poles in words.

    Examples
    --------
    >>> settings_words(10.0, (0.5,))
    'q_u = 10, γ = 0.5'
    """
    shown = ", ".join(dict.fromkeys(f"{pole:.4g}" for pole in poles))
    return f"q_u = {penalty:.4g}, γ = {shown or 'none'}"
