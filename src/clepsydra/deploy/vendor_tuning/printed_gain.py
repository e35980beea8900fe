"""Numbers as they are printed for who enters them, and gains in the units that a process shows."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.designs.gain_units import gain_factor, percent_gain

#: Significant digits that are printed.
DIGITS = 5


def printed_number(value: float, resolution: float = 0.0) -> str:
    """Return a number as it is printed: five significant digits, in the block's steps.

    Examples
    --------
    >>> printed_number(1.0 / 3.0), printed_number(1.0 / 3.0, 0.01), printed_number(3.0e-7)
    ('0.33333', '0.33', '3e-07')
    """
    if resolution:
        value = round(round(value / resolution) * resolution, 12)
    return f"{value:.{DIGITS}g}"


def engineering_unit(measurement: Signal, moved: Signal) -> str:
    """Return the unit of a gain in display units, "V/cm"."""
    above, below = (
        f"({unit})" if "/" in unit else unit for unit in (moved.shown_unit, measurement.shown_unit)
    )
    return f"{above}/{below}"


def gain_words(gain: float, measurement: Signal, moved: Signal) -> str:
    """Return a gain [SI] in display units, and in percent where both signals have a range.

    Examples
    --------
    >>> level = Signal("level", "m", "cm", low=0.0, high=0.5)
    >>> gain_words(40.0, level, Signal("pump", "V", low=0.0, high=10.0))
    '0.4 V/cm = 2 %/%'
    """
    unit = engineering_unit(measurement, moved)
    words = f"{printed_number(gain * gain_factor(measurement, moved))} {unit}"
    if measurement.has_range and moved.has_range and unit != "%/%":
        words += f" = {printed_number(percent_gain(gain, measurement, moved))} %/%"
    return words
