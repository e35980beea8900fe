"""Which states of a process ask for short integration steps, and how short."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

#: Largest |λ| h of an RK4 step. The error of one step is about |λ h|⁵ / 120 of the state's
#: motion: 1e-7 here.
REACH = 0.1
#: A lag that settles this many times in a sampling period: what is left of it is e⁻²⁰.
_SETTLED = 20.0


def settled_lags(model: LinearModel, period: float) -> list[int]:
    """Return which states are lags of instruments that settle long before the next sample.

    A lag depends on no other state, as an actuator's, or no other depends on it, as a sensor's.
    Its entry on the diagonal then is an eigenvalue, and the others are those of what remains.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    period : float
        The sampling period [s].

    Examples
    --------
    >>> import clepsydra as cl
    >>> settled_lags(cl.load("quadruple-tank").linear, 1.0)
    []
    """
    elements = operating_point_of(model).process.elements
    tanks = {s.name for e in elements if e.holds_liquid for s in e.states()}
    own = {s.name for e in elements for s in e.states()} - tanks
    coupled = model.A != 0.0
    np.fill_diagonal(coupled, False)
    alone = ~coupled.any(axis=1) | ~coupled.any(axis=0)
    quick = -np.diag(model.A) * period >= _SETTLED
    return [i for i, name in enumerate(model.states) if name in own and alone[i] and quick[i]]
