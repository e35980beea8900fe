"""The controller that makes a plant most robust against differences of its coprime factors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.designs.loop_shaping.coprime_factors import CoprimeFactors
from clepsydra.designs.sampled.sampled_system import SampledSystem

#: γ over γ_min: the controller at γ_min itself has gains without bound.
RELAXATION = 1.1


@dataclass(frozen=True, eq=False)
class RobustController:
    """u = F ξ, ξ = (A + H C) x̂ − H y, x̂⁺ = ξ + B u: an observer with feedback of its estimate.

    ξ is what the next estimate would be without any input. In the convention of the source the
    controller is added, u = K y.

    Parameters
    ----------
    factors : CoprimeFactors
        Of the plant that it was made for.
    gamma : float
        The norm that it keeps below.
    feedback : ndarray [m, n]
        F

    Examples
    --------
    >>> from clepsydra.designs.loop_shaping.coprime_factors import coprime_factors
    >>> one = np.eye(1)
    >>> factors = coprime_factors(SampledSystem(one, one, one, 0.0 * one))
    >>> controller = robust_controller(factors)
    >>> controller.achieved_norm(factors.plant) < controller.gamma
    True
    """

    factors: CoprimeFactors
    gamma: float
    feedback: np.ndarray

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.factors.X)

    @property
    def prediction(self) -> np.ndarray:
        """A + H C."""
        return self.factors.plant.A + self.factors.injection @ self.factors.plant.C

    @property
    def system(self) -> SampledSystem:
        """K, from y to u."""
        F, H, B = self.feedback, self.factors.injection, self.factors.plant.B
        closed = np.eye(self.order) + B @ F
        return SampledSystem(closed @ self.prediction, -closed @ H, F @ self.prediction, -F @ H)

    def achieved_norm(self, plant: SampledSystem) -> float:
        """Return ‖[K; 1] (1 − G K)⁻¹ [1 G]‖∞ with a plant; infinite where that is unstable.

        With the normalised factors of that plant it is ‖[K; 1] (1 − G K)⁻¹ M⁻¹‖∞, and 1/norm is
        the ‖[ΔN ΔM]‖∞ that is borne.

        Parameters
        ----------
        plant : SampledSystem
            The one it was made for, or the full one of which that is a reduction.
        """
        A, B, C, _ = plant
        a, b, c, d = self.system
        q, m = C.shape[0], B.shape[1]
        # Of y and u with something added to each: y = C x + w, u = K y, x⁺ = A x + B (u + v).
        return SampledSystem(
            np.block([[A + B @ d @ C, B @ c], [b @ C, a]]),
            np.block([[B @ d, B], [b, np.zeros((len(a), m))]]),
            np.block([[d @ C, c], [C, np.zeros((q, len(a)))]]),
            np.block([[d, np.zeros((m, m))], [np.eye(q), np.zeros((q, m))]]),
        ).largest_gain


def robust_controller(factors: CoprimeFactors, relaxation: float = RELAXATION) -> RobustController:
    """Return the central controller of a norm below γ = relaxation · γ_min.

    As the observer of the factors knows what they are disturbed by from the measurement of the
    same sample, ‖[K; 1](1 − G K)⁻¹ M⁻¹‖ < γ is a problem of full information, with one further
    Riccati equation, whose solution is P = ((1 − γ⁻²) 1 − γ⁻² X Z)⁻¹ X; then
    F = −(1 + Bᵀ P B)⁻¹ Bᵀ P.

    Parameters
    ----------
    relaxation : float
        γ/γ_min, above one.

    References
    ----------
    J. Sefton and K. Glover, Pole-zero cancellations in the general H∞ problem with reference to
    a two block design, Systems & Control Letters 14(4), 1990, 295-306, for the observer form in
    continuous time; S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed.,
    2005, section 9.4. P. Iglesias and K. Glover, State-space approach to discrete-time H∞
    control, International Journal of Control 54(5), 1991, 1031-1073, for full information.

    Examples
    --------
    See `RobustController`.
    """
    gamma = relaxation * factors.smallest_gamma
    X, B, identity = factors.X, factors.plant.B, np.eye(len(factors.X))
    share = gamma**-2
    P = np.linalg.solve((1.0 - share) * identity - share * X @ factors.Z, X)
    feedback = -np.linalg.solve(np.eye(B.shape[1]) + B.T @ P @ B, B.T @ P)
    return RobustController(factors, gamma, feedback)
