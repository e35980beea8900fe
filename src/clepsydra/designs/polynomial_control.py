"""2DOF polynomial control by LQ spectral factorisation and assigned poles."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.polynomial_controller import FAMILY, polynomial_law
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.numbers import ASSIGNED_POLES, PENALTY
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.polynomial.paired_design import paired_controller
from clepsydra.designs.polynomial.paired_models import (
    LoopGains,
    Request,
    modelled_pairs,
    polynomial_gains,
)
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.linear.linear_model import LinearModel

#: A delay of more samples is left to the Smith predictor: P would have a gain for each.
LONGEST_DELAY = 24
SOURCE = "Diophantine equation with an LQ spectral factor and assigned poles"


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
    pairs = modelled_pairs(model, pairing, models)
    for pair in pairs:
        if pair.sampled.delay > LONGEST_DELAY:
            raise NotApplicable(
                f"{pair.pair}: its delay of {pair.sampled.delay} samples would need as many gains; "
                "a Smith predictor keeps it in a ring"
            )

    def gains_at(factor: float) -> list[LoopGains]:
        return [
            polynomial_gains(
                pair, request, factor, (*[0.0] * pair.sampled.delay, *map(float, pair.sampled.B))
            )
            for pair in pairs
        ]

    law = polynomial_law(
        [pair.output for pair in pairs],
        [pair.input for pair in pairs],
        [loop.shape for loop in gains_at(1.0)],
    )
    name, given = "2DOF polynomial, LQ", request.in_words()
    return paired_controller(name, FAMILY, model, pairs, law, gains_at, SOURCE, given)
