"""The integration step, from the fastest eigenvalue."""

from __future__ import annotations

import math

import numpy as np

#: Largest |λ| h of an RK4 step. The error of one step is about |λ h|⁵ / 120 of the state's
#: motion: 1e-7 here.
_REACH = 0.1


def substeps_for(A: np.ndarray, sampling_period: float) -> int:
    """Return the number of RK4 steps in a sampling period that the fastest eigenvalue asks for.

    Parameters
    ----------
    A : ndarray [n, n]
        State matrix of the linear model [1/s].
    sampling_period : float
        [s]

    Examples
    --------
    >>> substeps_for(np.diag([-0.5, -0.01]), 1.0)
    5
    """
    fastest = float(np.max(np.abs(np.linalg.eigvals(A)), initial=0.0))
    return max(1, math.ceil(fastest * sampling_period / _REACH - 1e-9))
