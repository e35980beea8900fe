"""The Niederlinski index of a pairing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError


def niederlinski_index(
    gain: ArrayLike,
    pairing: Sequence[tuple[str, str]],
    outputs: Sequence[str],
    inputs: Sequence[str],
) -> float:
    """Return N = det G / Π g_ii with the paired elements on the diagonal.

    With integral action in every loop and N < 0 the closed loop is unstable, however the loops
    are tuned (for a stable process with proper rational loops). N > 0 is necessary only; for
    two loops it says the same as a positive relative gain, since N = 1/λ.

    Parameters
    ----------
    gain : array_like [q, m]
        G(0) [output unit / input unit].
    pairing : sequence of (output, input)
    outputs, inputs : sequence of str
        Names of the rows and of the columns of `gain`.

    Returns
    -------
    float
        [1]; infinite where a paired element is zero.

    Raises
    ------
    InputError
        A gain of the paired signals is not finite: the process integrates.

    References
    ----------
    A. Niederlinski, A heuristic approach to the design of linear multivariable interacting
    control systems, Automatica 7(6), 1971, 691-701.

    Examples
    --------
    >>> pairs = [("level_1", "pump_1"), ("level_2", "pump_2")]
    >>> niederlinski_index([[2.0, 1.0], [1.0, 2.0]], pairs, ("level_1", "level_2"),
    ...                    ("pump_1", "pump_2"))
    0.75
    """
    gains = np.asarray(gain, float)
    rows = [list(outputs).index(output) for output, _ in pairing]
    columns = [list(inputs).index(name) for _, name in pairing]
    paired = gains[np.ix_(rows, columns)]
    if not np.all(np.isfinite(paired)):
        raise InputError(
            "Niederlinski index, gain",
            paired.tolist(),
            "finite static gains",
            "the index is defined for a process that does not integrate",
        )
    diagonal = np.diag(paired)
    if np.any(diagonal == 0.0):
        return float("inf")
    # Row by row, so that large or small units cannot overflow the product.
    return float(np.linalg.det(paired / diagonal[:, None]))
