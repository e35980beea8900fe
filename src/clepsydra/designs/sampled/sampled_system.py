"""A sampled linear system in numbers: its frequency response and its largest gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.frequency_peak import largest_gain
from clepsydra.linear.response import evaluate_transfer

#: An eigenvalue this near to the unit circle stands on it.
_ROUNDING = 1e-10
#: A matrix of a larger condition number has no inverse.
SINGULAR = 1e12


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
    def by_tustins_rule(
        cls, matrices: Sequence[np.ndarray], period: float, place: str, remedy: str
    ) -> SampledSystem:
        """Return a continuous system A, B, C, D as it is sampled by s = 2/T (z − 1)/(z + 1).

        Raises
        ------
        InputError
            A pole stands at 2/T.
        """
        from scipy.signal import cont2discrete

        A = matrices[0]
        if len(A) and np.linalg.cond(np.eye(len(A)) - 0.5 * period * A) > SINGULAR:
            raise InputError(place, f"a pole at {2.0 / period:.3g} rad/s", "no pole at 2/T", remedy)
        return cls(*cont2discrete(matrices, period, "bilinear")[:4])

    @property
    def is_stable(self) -> bool:
        """Whether every eigenvalue stands inside the unit circle, and none on it."""
        return bool(np.max(np.abs(np.linalg.eigvals(self.A)), initial=0.0) < 1.0 - _ROUNDING)

    @property
    def largest_gain(self) -> float:
        """Largest singular value over frequency, ‖G‖∞; infinite for an unstable system."""
        if not self.is_stable:
            return float("inf")
        return largest_gain(*self.continuous_image()).peak

    def continuous_image(self) -> SampledSystem:
        """Return the continuous system of s = (z − 1)/(z + 1).

        It has the same gains, Hankel singular values and coprime factors.
        """
        identity = np.eye(len(self.A))
        inverse = np.linalg.inv(self.A + identity)
        root = np.sqrt(2.0)
        return SampledSystem(
            (self.A - identity) @ inverse,
            root * inverse @ self.B,
            root * self.C @ inverse,
            self.D - self.C @ inverse @ self.B,
        )

    def response(self, angles: np.ndarray) -> np.ndarray:
        """Return G(e^jωT) at angles ωT [rad], as [l, q, m]."""
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
