"""The sampling period as a TIME of a task."""

from __future__ import annotations

import math
from decimal import Decimal

from clepsydra.base.errors import InputError

#: The type TIME counts milliseconds in 32 bits.
LONGEST = 2**32 - 1


def milliseconds(sampling_period: float) -> int:
    """Return a sampling period in whole milliseconds, which a TIME can hold.

    Parameters
    ----------
    sampling_period : float
        [s]

    Raises
    ------
    InputError
        It is no positive number, no whole number of milliseconds, or longer than 2^32 - 1 of
        them (49.7 days).

    Examples
    --------
    >>> milliseconds(2.3)
    2300
    """
    usable = isinstance(sampling_period, (int, float)) and math.isfinite(sampling_period)
    # The decimal that was written, not the binary number beside it: 2.3 s are 2300 ms.
    count = Decimal(repr(float(sampling_period))) * 1000 if usable else Decimal(0)
    if count != count.to_integral_value() or not 1 <= count <= LONGEST:
        raise InputError(
            "sampling period", f"{sampling_period} s",
            "a whole number of milliseconds, at most 2^32 - 1 of them (49.7 days), which the type "
            "TIME of a task can hold",
            "give another sampling period in the process file and design again",
        )  # fmt: skip
    return int(count)


def time_literal(sampling_period: float) -> str:
    """Write a sampling period [s] as a TIME.

    Raises
    ------
    InputError
        See `milliseconds`.

    Examples
    --------
    >>> time_literal(60.0), time_literal(0.25)
    ('T#60s', 'T#250ms')
    """
    count = milliseconds(sampling_period)
    return f"T#{count}ms" if count % 1000 else f"T#{count // 1000}s"
