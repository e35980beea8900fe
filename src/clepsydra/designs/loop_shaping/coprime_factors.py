"""Normalised left coprime factors of a sampled plant, and the largest robustness that follows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.designs.states.riccati import optimal_regulator

#: The smallest difference of a Hankel norm from one that can be told from rounding.
_SMALLEST_MARGIN = 1e-6


@dataclass(frozen=True, eq=False)
class CoprimeFactors:
    """G = M⁻¹ N of a plant x⁺ = A x + B u, y = C x, with N Nᴴ + M Mᴴ = 1 on the unit circle.

    They share one observer, x̂⁺ = A x̂ + B u + H (C x̂ − y): with S = 1 + C Z Cᵀ, S^½ the
    Cholesky factor of it and H = −A Z Cᵀ S⁻¹,
    [N M] = S^(−½) [0 1] + S^(−½) C (z − A − H C)⁻¹ [B H].

    Parameters
    ----------
    plant : SampledSystem
        Without a direct way from input to output.
    X : ndarray [n, n]
        Of the regulator: X = AᵀXA + CᵀC − AᵀXB (1 + BᵀXB)⁻¹ BᵀXA.
    Z : ndarray [n, n]
        Of the observer: Z = AZAᵀ + BBᵀ − AZCᵀ (1 + CZCᵀ)⁻¹ CZAᵀ.
    injection : ndarray [n, q]
        H
    root : ndarray [q, q]
        S^½, lower triangular.

    Examples
    --------
    An integrator that gains its input in each sample: X and Z are the golden ratio.

    >>> one = np.eye(1)
    >>> factors = coprime_factors(SampledSystem(one, one, one, 0.0 * one))
    >>> round(factors.smallest_gamma, 6), round(float(factors.hankel_singular_values[0]), 6)
    (1.902113, 0.850651)
    """

    plant: SampledSystem
    X: np.ndarray
    Z: np.ndarray
    injection: np.ndarray
    root: np.ndarray

    @property
    def smallest_gamma(self) -> float:
        """γ_min = √(1 + ρ(X Z)), below which no controller brings the norm.

        1/γ_min is the largest ‖[ΔN ΔM]‖∞ that a controller can be made to bear.
        """
        spectrum = np.linalg.eigvals(self.X @ self.Z)
        return math.sqrt(1.0 + float(np.max(spectrum.real, initial=0.0)))

    @cached_property
    def system(self) -> SampledSystem:
        """[N M], from u and y; stable."""
        plant, H = self.plant, self.injection
        q, m = plant.C.shape[0], plant.B.shape[1]
        weight = np.linalg.inv(self.root)
        return SampledSystem(
            plant.A + H @ plant.C,
            np.hstack([plant.B, H]),
            weight @ plant.C,
            np.hstack([np.zeros((q, m)), weight]),
        )

    @cached_property
    def hankel_singular_values(self) -> np.ndarray:
        """Of [N M], falling, all below one; γ_min = (1 − σ₁²)^(−½)."""
        return np.linalg.svd(self._joined, compute_uv=False)

    @cached_property
    def roots(self) -> tuple[np.ndarray, np.ndarray]:
        """R and L of the Gramians P = R Rᵀ and Q = L Lᵀ of [N M].

        P is Z itself, and Q = (X⁻¹ + Z)⁻¹ = U (1 + Uᵀ Z U)⁻¹ Uᵀ with X = U Uᵀ: no difference of
        large numbers, of which a small state would keep few digits.
        """
        reached, weight = _root(self.Z), _root(self.X)
        lower = np.linalg.cholesky(np.eye(len(self.Z)) + weight.T @ self.Z @ weight)
        return reached, np.linalg.solve(lower, weight.T).T

    @property
    def _joined(self) -> np.ndarray:
        reached, shown = self.roots
        return np.asarray(shown.T @ reached)


def coprime_factors(plant: SampledSystem) -> CoprimeFactors:
    """Return the normalised left coprime factors of a sampled plant.

    Parameters
    ----------
    plant : SampledSystem
        Without a direct way from input to output, D = 0.

    Raises
    ------
    NotApplicable
        The inputs do not reach, or the outputs do not show, a mode that does not die out; or the
        plant is so sensitive that no controller bears a difference of one part in a million.

    References
    ----------
    K. Glover and D. McFarlane, Robust stabilization of normalized coprime factor plant
    descriptions with H∞-bounded uncertainty, IEEE Transactions on Automatic Control 34(8),
    1989, 821-830, doi 10.1109/9.29424. In discrete time: D. Walker, Relationship between three
    discrete-time H∞ algebraic Riccati equation solutions, International Journal of Control
    52(4), 1990, 801-809.

    Examples
    --------
    See `CoprimeFactors`.
    """
    A, B, C = plant.A, plant.B, plant.C
    q, m = C.shape[0], B.shape[1]
    inputs, outputs = np.eye(m), np.eye(q)
    X = optimal_regulator(A, B, C.T @ C, np.zeros((len(A), m)), inputs).cost
    Z = optimal_regulator(A.T, C.T, B @ B.T, np.zeros((len(A), q)), outputs).cost
    X, Z = (X + X.T) / 2.0, (Z + Z.T) / 2.0
    spread = outputs + C @ Z @ C.T
    injection = -np.linalg.solve(spread, C @ Z @ A.T).T
    found = CoprimeFactors(plant, X, Z, injection, np.linalg.cholesky(spread))
    if not 1.0 / found.smallest_gamma >= _SMALLEST_MARGIN:
        raise NotApplicable(
            "no controller bears a difference of one part in a million of this plant"
        )
    return found


def _root(gramian: np.ndarray) -> np.ndarray:
    """Return R of R Rᵀ = M for a symmetric M without negative eigenvalues but for rounding."""
    try:
        return np.linalg.cholesky(gramian)
    except np.linalg.LinAlgError:  # a state that is not reached or not shown
        sizes, directions = np.linalg.eigh(gramian)
        return np.asarray(directions * np.sqrt(np.maximum(sizes, 0.0)))
