"""Control authority: how hard a controller may push before its input meets a limit."""

from __future__ import annotations

from clepsydra.base.signal import Signal

#: The setpoint step that must not saturate the input, as a share of the measurement's range.
DESIGN_STEP = 0.1


def control_authority(signal: Signal, value: float) -> float:
    """Return the distance from a value to the nearer limit, at least a tenth of the range.

    Parameters
    ----------
    signal : Signal
        An input with a finite range.
    value : float
        Where it stands [signal unit].

    Examples
    --------
    >>> pump = Signal("pump", "V", low=0.0, high=10.0)
    >>> control_authority(pump, 3.0), control_authority(pump, 9.8)
    (3.0, 1.0)
    """
    return max(min(value - signal.low, signal.high - value), 0.1 * signal.span)
