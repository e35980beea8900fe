"""The horizon of a predictive controller, and the tables over it."""

from __future__ import annotations

import numpy as np

from clepsydra.controllers.predictive.prediction import Prediction
from clepsydra.designs.states.bryson_rule import inverse_response
from clepsydra.designs.states.observed_process import ObservedProcess
from clepsydra.linear.linear_model import LinearModel

#: So many times 1/z of a zero in the right half-plane: with two no filter makes the loops of four
#: tanks quiet, three are nearly as good (docs/decisions/0073).
INVERSE_RESPONSES = 4.0
#: Digits of a number in a table, and what share of its largest number is nothing.
_DIGITS, _NOTHING = 10, 1e-20


def usual_horizon(model: LinearModel, settling: float) -> float:
    """Return how far a predictive controller looks ahead [s].

    That is the time for which a largest error may last, or four times 1/z of the slowest zero z in
    the right half-plane, by when an inverse response is over.

    Parameters
    ----------
    settling : float
        By Bryson's rule [s].

    Examples
    --------
    The slowest one is at 0.0128 1/s:

    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank-nonminimum-phase").linear
    >>> round(usual_horizon(model, 78.0)), usual_horizon(cl.load("quadruple-tank").linear, 30.0)
    (314, 30.0)
    """
    return max(settling, INVERSE_RESPONSES * inverse_response(model))


def blocks_of(samples: int, count: int) -> tuple[int, ...]:
    """Return the lengths of blocks that fill a horizon, each longer than the one before.

    The first is a sample; the lengths grow by one factor. Near moves matter most: what comes
    later will be planned anew.

    Examples
    --------
    >>> blocks_of(20, 5), blocks_of(64, 5), blocks_of(7, 1)
    ((1, 2, 3, 5, 9), (1, 2, 6, 16, 39), (7,))
    """
    low, high = 1.0, float(samples)
    for _ in range(60):
        factor = 0.5 * (low + high)
        if np.sum(factor ** np.arange(count)) > samples:
            high = factor
        else:
            low = factor
    lengths = [max(1, round(low**k)) for k in range(count)]
    return (*lengths[:-1], samples - sum(lengths[:-1]))


def prediction_of(
    observed: ObservedProcess, blocks: tuple[int, ...], bounded: tuple[int, ...] = ()
) -> Prediction:
    """Return the tables over a horizon of a sampled process, from what an observer estimates.

    Parameters
    ----------
    observed : ObservedProcess
        With its disturbances among what is estimated.
    blocks : tuple of int
        The samples of each.
    bounded : tuple of int
        Which of what is estimated has a bound.

    With x(k+1) = Φ x(k) + Γ (u₋ + v_b), where b is the block that sample k is in, and the errors
    e_j(k) = C_j x(k) − r_j for k = 1 … T.

    Examples
    --------
    An integrator over two samples with one move: e = x + v − r, then x + 2 v − r.

    >>> import clepsydra as cl
    >>> from clepsydra.base.signal import Signal
    >>> seen = ObservedProcess(cl.load("equalisation-tank").linear, 1.0, ("level",),
    ...                        (Signal("x"),), np.eye(1), np.eye(1), np.eye(1))
    >>> found = prediction_of(seen, (2,))
    >>> found.curves.tolist(), found.slopes.tolist()
    ([[[5.0]]], [[[3.0, -3.0, 5.0]]])
    """
    held, moved, shown = observed.held, observed.moved, observed.shown[observed.controlled]
    (N, m), q, n = moved.shape, len(shown), len(blocks) * moved.shape[1]
    known = N + q + m
    by_known, by_moves = np.eye(N, known), np.zeros((N, n))
    last = np.eye(m, known, k=N + q)
    curves, slopes = np.zeros((q, n, n)), np.zeros((q, n, known))
    reached, at_ends = [], []
    for block, length in enumerate(blocks):
        chosen = np.eye(m, n, k=block * m)
        for _ in range(length):
            by_known, by_moves = held @ by_known + moved @ last, held @ by_moves + moved @ chosen
            errors = shown @ by_known - np.eye(q, known, k=N)
            outputs = shown @ by_moves
            curves += outputs[:, :, None] * outputs[:, None, :]
            slopes += outputs[:, :, None] * errors[:, None, :]
        reached.append(by_known[[*bounded]])
        at_ends.append(by_moves[[*bounded]])
    by_state = (np.swapaxes(each, 0, 1) for each in (reached, at_ends))
    curves, slopes, *ends = map(rounded_table, (curves, slopes, *by_state))
    return Prediction(blocks, curves, slopes, bounded, *ends)


def rounded_table(table: np.ndarray) -> np.ndarray:
    """Return the numbers of a table with the digits that are printed; what is nothing is zero.

    What has faded over a horizon may be too small for single precision.

    Examples
    --------
    >>> rounded_table(np.array([1 / 3, 1e-49]))
    array([0.33333333, 0.        ])
    """
    least = _NOTHING * np.max(np.abs(table), initial=0.0)
    shown = (f"{value:.{_DIGITS - 1}e}" for value in np.where(abs(table) < least, 0, table).ravel())
    return np.array([float(each) for each in shown]).reshape(table.shape)
