"""A sampled linear system in numbers: its frequency response and its largest gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.linear.frequency_peak import largest_gain
from clepsydra.linear.response import evaluate_transfer

#: An eigenvalue this near to the unit circle stands on it.
_ROUNDING = 1e-10


class SampledSystem(NamedTuple):
    """x(k+1) = A x(k) + B u(k), y(k) = C x(k) + D u(k).

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]

    Examples
    --------
    >>> one = np.eye(1)
    >>> round(SampledSystem(0.5 * one, one, one, 0.0 * one).largest_gain, 9)
    2.0
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray

    @classmethod
    def by_tustins_rule(cls, matrices: Sequence[np.ndarray], period: float) -> SampledSystem:
        """Return a continuous system A, B, C, D as it is sampled by s = 2/T (z − 1)/(z + 1).

        An integral stays one, and phase is lost only as the frequency comes near π/T.

        Examples
        --------
        PI control with K = 2 and Ti = 10 s each second: the integral gains K T/Ti.

        >>> integral = np.zeros((1, 1)), np.array([[0.2]]), np.eye(1), 2.0 * np.eye(1)
        >>> found = SampledSystem.by_tustins_rule(integral, 1.0)
        >>> float((found.C @ found.B)[0, 0]), float(found.D[0, 0])
        (0.2, 2.1)
        """
        from scipy.linalg import solve

        A, B, C, D = matrices
        identity, half = np.eye(len(A)), 0.5 * period * A
        moved = solve(identity - half, period * B)
        shown = solve((identity - half).T, C.T).T
        return cls(solve(identity - half, identity + half), moved, shown, D + 0.5 * (C @ moved))

    @property
    def is_stable(self) -> bool:
        """Whether every eigenvalue stands inside the unit circle, and none on it."""
        return bool(self.are_stable)

    @property
    def are_stable(self) -> np.ndarray:
        """The same of each of a stack of systems."""
        largest = np.max(np.abs(np.linalg.eigvals(self.A)), axis=-1, initial=0.0)
        return np.asarray(largest < 1.0 - _ROUNDING)

    @property
    def largest_gain(self) -> float:
        """Largest singular value over frequency, ‖G‖∞; infinite for an unstable system."""
        if not self.is_stable:
            return float("inf")
        return largest_gain(*self.continuous_image()).peak

    def continuous_image(self) -> SampledSystem:
        """Return the continuous system of s = (z − 1)/(z + 1), or a stack of them of a stack.

        It has the same gains, Hankel singular values and coprime factors.
        """
        identity = np.eye(self.A.shape[-1])
        inverse = np.linalg.inv(self.A + identity)
        root = np.sqrt(2.0)
        return SampledSystem(
            (self.A - identity) @ inverse,
            root * inverse @ self.B,
            root * self.C @ inverse,
            self.D - self.C @ inverse @ self.B,
        )

    def among(self, which: np.ndarray) -> SampledSystem:
        """Return some of a stack of systems."""
        return SampledSystem(*(matrix[which] for matrix in self))

    def response(self, angles: np.ndarray) -> np.ndarray:
        """Return G(e^jωT) at angles ωT [l, rad] as [l, q, m]; of a stack at [k, l]."""
        return np.asarray(evaluate_transfer(self.A, self.B, self.C, self.D, np.exp(1j * angles)))

    def then(self, second: SampledSystem) -> SampledSystem:
        """Return second · this: the outputs of this are the inputs of the second.

        Examples
        --------
        >>> one = np.eye(1)
        >>> lag = SampledSystem(0.5 * one, one, one, 0.0 * one)
        >>> round(lag.then(lag).largest_gain, 9)
        4.0
        """
        n, r = len(self.A), len(second.A)
        return SampledSystem(
            np.block([[self.A, np.zeros((n, r))], [second.B @ self.C, second.A]]),
            np.vstack([self.B, second.B @ self.D]),
            np.hstack([second.D @ self.C, second.C]),
            second.D @ self.D,
        )
