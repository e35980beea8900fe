"""How finely a law has to run the equations of a process within a sample."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.sampled_matrices import doublings_for
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.process_equations import NEARLY_EMPTY, ProcessEquations

#: A step of the Runge-Kutta method spans at most this share of the fastest time constant.
_FINE = 0.5
#: More steps in a sample take too long on a controller.
MOST_SUBSTEPS = 500
#: Shares of the ranges at which the fastest rate is looked for.
_SHARES = (NEARLY_EMPTY, 0.1, 0.3, 1.0)


def fastest_rate(equations: ProcessEquations) -> float:
    """Return the fastest rate of the equations over the ranges of states and inputs [1/s].

    The Perron root of |∂f/∂x|: no units of the states, however chosen, give the matrix a smaller
    norm, and it bounds every eigenvalue.

    References
    ----------
    R. A. Horn and C. R. Johnson, Matrix Analysis, 2nd ed., Cambridge University Press 2013,
    section 8.1.

    Examples
    --------
    At 1 m³/s through a tank with a fiftieth of 4 m³:

    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> round(fastest_rate(process_equations(cl.load("averaging-tank").linear)), 3)
    12.5
    """
    point = equations.point
    process, at = point.process, point.as_dict()
    states = equations.signals_of_states()
    inputs = [process.signal(name) for name in equations.inputs]
    corners = [[at[signal.name] for signal in inputs]]
    if all(math.isfinite(signal.span) for signal in inputs):
        corners += [[s.low for s in inputs], [s.high for s in inputs]]
    rest = np.array([at[signal.name] for signal in states])
    places = [rest]
    for share in _SHARES:
        placed = at_share(share, states, rest)
        places.append(placed)
        # One tank nearly empty beside others that are not.
        for j, value in enumerate(placed):
            alone = rest.copy()
            alone[j] = value
            places.append(alone)
    largest = 0.0
    values = equations.values([equations.A])
    for place in places:
        for moved in corners:
            (A,) = values(place, np.array(moved))
            if np.all(np.isfinite(A)):
                root = float(np.max(np.abs(np.linalg.eigvals(np.abs(A))), initial=0.0))
                largest = max(largest, root)
    return largest


def at_share(share: float, signals: Sequence[Signal], rest: np.ndarray) -> np.ndarray:
    """Return values at a share of the ranges; at rest where a signal has none."""
    found = [
        signal.low + share * signal.span if math.isfinite(signal.span) else value
        for signal, value in zip(signals, rest, strict=True)
    ]
    return np.array(found, float)


def steps_in_a_sample(equations: ProcessEquations) -> tuple[int, int]:
    """Return the steps of the Runge-Kutta method in a sample, and the doublings of a series.

    Raises
    ------
    NotApplicable
        The process is too fast for its sampling period.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.process_equations import process_equations
    >>> steps_in_a_sample(process_equations(cl.load("averaging-tank").linear))
    (3, 3)
    """
    period = equations.point.process.sampling_period
    covered = fastest_rate(equations) * period
    substeps, doublings = max(1, math.ceil(covered / _FINE)), doublings_for(covered)
    if substeps > MOST_SUBSTEPS:
        raise NotApplicable(
            f"its equations would need {substeps} steps in a sample of {period:g} s, and a "
            f"controller takes at most {MOST_SUBSTEPS}; sample faster"
        )
    return substeps, doublings
