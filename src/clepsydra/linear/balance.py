"""What is left of terms that balance: nothing, where it is no more than their rounding."""

from __future__ import annotations

import numpy as np

#: What is left, as a share of what it is left of: less is rounding.
_ROUNDING = 1e-13


def unbalanced(left: np.ndarray, terms: np.ndarray) -> np.ndarray:
    """Return what is left of sums, with zeros where it is the rounding of their terms.

    A sum that is nought in exact arithmetic leaves some 10⁻¹⁶ of its terms, or nothing, as the
    numbers happen to be. Only beside its terms can it be told from a coupling that is weak:
    its own size, or that of its neighbours, depends on units.

    Parameters
    ----------
    left : ndarray
        The sums.
    terms : ndarray
        The sizes of the terms of each, of the same shape and in the same units.

    Examples
    --------
    A flow of 0.1 l/s beside 3 l/s is a flow, and what three tenths leave of 0.1 + 0.2 is none:

    >>> left = np.array([0.1, 0.1 + 0.2 - 0.3])
    >>> unbalanced(left, np.array([3.0, 0.6])).tolist()
    [0.1, 0.0]
    """
    return np.where(np.abs(left) <= _ROUNDING * terms, 0.0, left)
