"""Numbers as C and Structured Text read them back, to the last bit."""

from __future__ import annotations

import math

import numpy as np

#: A number with as many zeros at its end is written with an exponent.
_ZEROS = 6


def decimal(value: float, *, single: bool = False) -> str:
    """Write a finite number so that C and Structured Text read back the same number.

    The shortest decimal that rounds to the double, or to the single-precision number, always
    with a point, the exponent behind a capital E without a plus sign. A compiler may read a
    single-precision number as a double first: the text survives both roundings.

    Examples
    --------
    >>> [decimal(value) for value in (1e300, 0.1, -0.0, 5e-324, 1e22, 3.0)]
    ['1.0E300', '0.1', '-0.0', '5.0E-324', '1.0E22', '3.0']
    >>> decimal(0.10000000149011612, single=True), decimal(1e9), decimal(-1200000.0)
    ('0.1', '1.0E9', '-1200000.0')
    """
    if not math.isfinite(value):
        raise ValueError(f"{value} has no decimal form")
    text = repr(float(value))
    if single:
        shortest = str(np.float32(value))
        text = shortest if np.float32(float(shortest)) == value else text
    mantissa, _, exponent = text.partition("e")
    whole = mantissa.removesuffix(".0")
    digits = whole.rstrip("0")
    if not exponent and len(whole) - len(digits) >= _ZEROS and whole != mantissa:
        point = 2 if digits.startswith("-") else 1
        exponent = str(len(whole) - point)
        mantissa = f"{digits[:point]}.{digits[point:] or '0'}"
    if "." not in mantissa:
        mantissa += ".0"
    return f"{mantissa}E{int(exponent)}" if exponent else mantissa
