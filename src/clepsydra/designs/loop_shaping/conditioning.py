"""How a robust controller behind its pre-compensator is told what was applied."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.conditioned_linear import ConditionedMatrices, conditioned_linear_law
from clepsydra.controllers.controller import Controller
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.loop_shaping.coprime_factors import coprime_factors
from clepsydra.designs.loop_shaping.robust_controller import RobustController
from clepsydra.designs.loop_shaping.shaped_plant import ShapedPlant
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.linear.operating_point import OperatingPoint


def conditioned_matrices(plant: ShapedPlant, robust: RobustController) -> ConditionedMatrices:
    """Return observer and pre-compensator as one controller that is told what was applied.

    With e = S⁻¹ (y − r), v = S u_s and the deviations Δu of the inputs from u°, the observer is
    x̂⁺ = ξ + B u_s with ξ = (A + H C) x̂ − H e and u_s = F ξ, and the pre-compensator
    x_w⁺ = A_w x_w + B_w v, Δu = C_w x_w + D_w v.

    Where W₁ can be inverted and its inverse is stable, both get v = D_w⁻¹ (Δu − C_w x_w), what
    W₁ should have been asked for what was applied: Hanus's conditioning of the weight, and the
    true input of the observer. Else there is no such v, and the controller as a whole is told by
    the observer of its own normalised coprime factors.

    Parameters
    ----------
    robust : RobustController
        Of the shaped plant or a reduction of it.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section
    9.4.5; S. Miyamoto and G. Vinnicombe, Robust control of plants with saturation nonlinearity
    based on coprime factor representations, 35th IEEE Conference on Decision and Control, 1996,
    2838-2840.

    Examples
    --------
    An integrator behind a gain of 2 has an observer of one state; told its own output it does
    as the controller alone:

    >>> from clepsydra.designs.loop_shaping.precompensator import Precompensator
    >>> from clepsydra.designs.loop_shaping.robust_controller import robust_controller
    >>> one = np.eye(1)
    >>> gain = SampledSystem(one[:0, :0], one[:0], one[:, :0], 2.0 * one)
    >>> shaping = Precompensator("P", gain, ("level",), ("pump",))
    >>> shaped = SampledSystem(one, 0.2 * one, one, 0.0 * one)
    >>> robust = robust_controller(coprime_factors(shaped))
    >>> found = conditioned_matrices(ShapedPlant(shaped, shaping, np.ones(1), 1.0), robust)
    >>> alone = found.unconditioned()
    >>> bool(np.allclose(alone.transition, robust.system.A)), found.told.round(9).tolist()
    (True, [[0.1]])
    """
    A_w, B_w, C_w, D_w = plant.precompensator.system
    sizes, weights = plant.sizes, len(A_w)
    observed, injection = robust.prediction, robust.factors.injection / sizes
    asked = sizes[:, None] * robust.feedback  # v = asked ξ
    inverse = plant.precompensator.inverse_direct
    if inverse is None:
        whole = _whole(plant, robust)
        return told_by_own_observer(whole, sizes, np.ones(len(whole.D)))
    moved = robust.factors.plant.B @ (inverse / sizes[:, None])
    return ConditionedMatrices(
        transition=np.block(
            [
                [observed, -moved @ C_w],
                [np.zeros((weights, len(observed))), A_w - B_w @ inverse @ C_w],
            ]
        ),
        entered=np.vstack([-injection, np.zeros((weights, len(sizes)))]),
        told=np.vstack([moved, B_w @ inverse]),
        shown=np.hstack([D_w @ asked @ observed, C_w]),
        direct=-D_w @ asked @ injection,
    )


def told_by_own_observer(
    whole: SampledSystem, errors: np.ndarray, outputs: np.ndarray
) -> ConditionedMatrices:
    """Return A = a − M c and B = b − M d with the M that an observer of the controller has.

    Parameters
    ----------
    whole : SampledSystem
        From y − r to Δu.
    errors : ndarray [p]
        Sizes that the errors count in.
    outputs : ndarray [m]
        Sizes of the outputs that no error moves at once.
        The others count in what such errors make of them.

    Raises
    ------
    NotApplicable
        A mode of the controller does not die out, and no input reaches it or no output shows it.

    Examples
    --------
    An integrator of the error is told what was applied, so that it does not run away:

    >>> one = np.eye(1)
    >>> found = told_by_own_observer(SampledSystem(one, one, one, 0.0 * one), one[0], one[0])
    >>> bool(abs(found.transition[0, 0]) < 1.0)
    True
    """
    size = np.abs(whole.D) @ errors
    size = np.where(size > 0.0, size, outputs)
    scaled = SampledSystem(
        whole.A, whole.B * errors, whole.C / size[:, None], np.zeros_like(whole.D)
    )
    told = -coprime_factors(scaled).injection / size
    return ConditionedMatrices(
        transition=whole.A - told @ whole.C,
        entered=whole.B - told @ whole.D,
        told=told,
        shown=whole.C,
        direct=whole.D,
    )


def _whole(plant: ShapedPlant, robust: RobustController) -> SampledSystem:
    """Return the controller from y − r to Δu."""
    a, b, c, d = robust.system
    sizes = plant.sizes
    errors = SampledSystem(a, b / sizes, sizes[:, None] * c, sizes[:, None] * d / sizes)
    return errors.then(plant.precompensator.system)


def linear_controller(
    point: OperatingPoint,
    name: str,
    family: str,
    measured: Sequence[Signal],
    moved: Sequence[Signal],
    matrices: ConditionedMatrices,
    plant: ShapedPlant,
) -> Controller:
    """Return the controller with these matrices, at rest; it starts as fast as its loop is."""
    law = conditioned_linear_law(measured, moved, matrices)
    fading = max(1.0 / plant.crossover, plant.period)
    values = numbers_at(point, law.parameters, fading_time=fading, **matrices.numbers())
    return controller_at(point, name, family, law, values, numbers_at(point, law.state))
