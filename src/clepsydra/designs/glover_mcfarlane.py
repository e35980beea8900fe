"""Glover-McFarlane loop shaping: robust control of a loop that another design has shaped."""

from __future__ import annotations

import math
from itertools import chain

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.controllers.conditioned_linear import FAMILY
from clepsydra.controllers.conditioned_linear import MOST_STATES as MOST_STATES_OF_A_LAW
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import number, whole_number
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loop_shaping.conditioning import conditioned_matrices, linear_controller
from clepsydra.designs.loop_shaping.coprime_factors import CoprimeFactors, coprime_factors
from clepsydra.designs.loop_shaping.order_reduction import reduced_plant
from clepsydra.designs.loop_shaping.precompensator import Precompensator, precompensator_of
from clepsydra.designs.loop_shaping.robust_controller import (
    RELAXATION,
    RobustController,
    robust_controller,
)
from clepsydra.designs.loop_shaping.shaped_plant import ShapedPlant, shaped_plant
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.simc import design_simc
from clepsydra.designs.slowing_down import note_on_peak
from clepsydra.designs.states.state_controllers import sensitivity_peak
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

METHOD = "Glover-McFarlane"
#: A loop shape whose γ_min is above this asks for more than the process can do robustly.
LARGEST_GAMMA = 4.0
#: What a reduction of the order may cost of the norm that is kept below.
REDUCTION_COST = 1.02


@design(
    "glover_mcfarlane",
    "robust control by Glover and McFarlane",
    Studied(260, "Glover-McFarlane on PI, SIMC"),
    keys=(
        number("relaxation", "a factor", "γ as a multiple of its least", above=1.0, example="1.1"),
        whole_number("order", "how many states of the controller are kept"),
    ),
    method=METHOD,
)
def design_glover_mcfarlane(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    precompensator: Controller | Precompensator | None = None,
    relaxation: float = RELAXATION,
    order: int | None = None,
) -> Controller:
    """Design the most robust controller of a loop that a pre-compensator has shaped.

    1. The pre-compensator W₁ shapes the loop: PI control by SIMC for the pairing, or another
       controller of the errors, as one with decoupling.
    2. The shaped plant is sampled with its inputs held, exactly also with dead time, in shares
       of the ranges of its measurements, and split into normalised coprime factors. They give
       γ_min, and 1/γ_min is how much of them can be off, in the ∞-norm.
    3. The order is reduced as far as the norm that is kept with the full plant rises by no more
       than 2 %, or to what is asked for.
    4. The controller of γ = 1.1 γ_min is an observer of the shaped plant with feedback of its
       estimate. Both the observer and W₁ are told the output that was applied, so that neither
       winds up and changes of mode are bumpless (`controllers.conditioned_linear`).

    Parameters
    ----------
    pairing : sequence of (output, input), or mapping, optional
        Of the PI control by SIMC, the one that the relative gains suggest if left out; another
        pre-compensator has its own.
    precompensator : Controller or Precompensator, optional
        What gives the loop its shape, exactly as it runs from sample to sample.
    relaxation : float
        γ/γ_min, above one.
    order : int, optional
        Number of states of the observer.

    Returns
    -------
    Controller
        Of all outputs at once.

    Raises
    ------
    NotApplicable
        There is no such pre-compensator, a mode that does not die out is out of reach, the
        model has too many states, no order is low enough, or a number is outside of what a
        controller takes.
    InputError
        The model has no operating point, the pre-compensator is none of errors, γ/γ_min is not
        above one, or the order is none of the shaped plant.

    References
    ----------
    D. McFarlane and K. Glover, A loop shaping design procedure using H∞ synthesis, IEEE
    Transactions on Automatic Control 37(6), 1992, 759-769, doi 10.1109/9.256330. S. Skogestad
    and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section 9.4, with the
    observer form and what it does against windup in 9.4.5.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> controller = design_glover_mcfarlane(analysis.model, analysis.pairing)
    >>> controller.name, controller.manipulated
    ('Glover-McFarlane on PI, SIMC', ('pump_1', 'pump_2'))
    """
    point = operating_point_of(model)
    shaping = _precompensator(model, pairing, precompensator)
    check_ranges(point.process, shaping.outputs, shaping.inputs)
    plant = shaped_plant(model, shaping)
    full = coprime_factors(plant.system)
    robust, achieved = _of_low_order(full, plant, relaxation, order)
    if math.isinf(achieved):
        raise NotApplicable(f"the loop is unstable with a controller of order {order}")
    measured, moved = (
        [point.process.signal(name) for name in names]
        for names in (shaping.outputs, shaping.inputs)
    )
    matrices, name = conditioned_matrices(plant, robust), f"{METHOD} on {shaping.name}"
    found = linear_controller(point, name, FAMILY, measured, moved, matrices, plant)
    peak = sensitivity_peak(found, model)
    if math.isinf(peak):
        raise NotApplicable("the sampled loop is unstable")
    smallest, reduced = full.smallest_gamma, len(full.X) - robust.order
    which = "its sensor" if len(found.measurements) == 1 else "any of its sensors"
    notes = [
        f"A fault of {which} holds every output.",
        f"Its matrices hold for a sampling period of {plant.period:g} s and no other.",
    ]
    if smallest > LARGEST_GAMMA:
        notes.append(
            f"γ_min is {smallest:.2f}, above {LARGEST_GAMMA:g}: the process cannot follow the "
            "shape of this loop robustly; choose a slower pre-compensator."
        )
    return found.described(
        f"Loop shaped by {shaping.name}, crossover {plant.crossover:.3g} rad/s; "
        f"γ_min = {smallest:.3f}, so that up to {100.0 / smallest:.0f} % of the normalised coprime "
        f"factors can be off; an observer of order {robust.order}"
        f"{f' for {len(full.X)}' if reduced else ''} keeps γ = {achieved:.3f}; a bumpless start "
        f"fades in {time_text(1.0 / plant.crossover)}; sensitivity peak {peak:.2f}.",
        (*notes, *note_on_peak(peak, "choose a slower pre-compensator")),
        shaping.slowed,
    )


def _precompensator(
    model: LinearModel, pairing: Pairing | None, asked: Controller | Precompensator | None
) -> Precompensator:
    if isinstance(asked, Precompensator):
        return asked
    if asked is not None and not isinstance(asked, Controller):
        given, expected = type(asked).__name__, "a Controller or a Precompensator"
        remedy = "design one first, or leave it out for PI control by SIMC"
        raise InputError("precompensator", given, expected, remedy)
    if asked is None:
        try:
            asked = design_simc(model, pairing)
        except NotApplicable as refusal:
            raise NotApplicable(
                f"it shapes the loop by {refusal.method}, which does not apply: {refusal.reason}"
            ) from None
    return precompensator_of(asked, model)


def _of_low_order(
    full: CoprimeFactors, plant: ShapedPlant, relaxation: float, order: int | None
) -> tuple[RobustController, float]:
    """Return the controller of the lowest order that is as good, and the norm that it keeps."""
    size = len(full.X)
    if order is not None:
        if order > size:
            expected = f"a whole number from 1 to {size}, the order of the shaped plant"
            remedy = "leave it out for the lowest order that is as good"
            raise InputError("order", order, expected, remedy)
        return _reduced(full, plant, relaxation, order)
    largest = relaxation * full.smallest_gamma * REDUCTION_COST
    most = MOST_STATES_OF_A_LAW - len(plant.precompensator.system.A)
    for kept in chain(range(1, min(size, most + 1)), [size] if size <= most else []):
        found = _reduced(full, plant, relaxation, kept)
        if found[1] <= largest:
            return found
    raise NotApplicable(
        f"the shaped plant has {size} states, and no observer of up to {most} states does as well"
    )


def _reduced(
    full: CoprimeFactors, plant: ShapedPlant, relaxation: float, order: int
) -> tuple[RobustController, float]:
    factors = full
    if order < len(full.X):
        try:
            factors = coprime_factors(reduced_plant(full, order))
        except NotApplicable:  # a plant so small that a mode of it is lost
            return robust_controller(full, relaxation), math.inf
    controller = robust_controller(factors, relaxation)
    return controller, controller.achieved_norm(plant.system)
