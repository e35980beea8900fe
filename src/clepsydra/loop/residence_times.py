"""How long changes take on their way through a process, which no single time constant shows."""

from __future__ import annotations

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of


def residence_times(model: LinearModel) -> np.ndarray:
    """Return the mean time that a change takes to each output from its strongest input [s].

    -G'(0)/G(0), the sum of the lags of the channel: for n equal tanks in series it is n times
    the time constant of one. The strongest input is the one whose range moves the output most.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point; without dead time, and nothing in it integrates.

    Returns
    -------
    ndarray [q]
        [s]; 0 where no input moves the output.
    """
    process = operating_point_of(model).process
    widths = [width_of_range(process.signal(name)) for name in model.inputs]
    once = np.linalg.solve(model.A, model.B)
    gains, moments = -model.C @ once, -model.C @ np.linalg.solve(model.A, once)
    rows, columns = np.arange(len(gains)), np.argmax(np.abs(gains) * widths, axis=1)
    gain, moment = gains[rows, columns], moments[rows, columns]
    found = np.abs(np.divide(moment, gain, out=np.zeros_like(moment), where=gain != 0.0))
    return np.asarray(found)


def width_of_range(signal: Signal) -> float:
    """Return the width of a signal's range, or 1 where it has none."""
    span = signal.span
    return span if np.isfinite(span) and span > 0.0 else 1.0
