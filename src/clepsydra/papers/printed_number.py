"""A printed number, and what its digits leave open."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

_NUMBER = re.compile(r"([+\-−]?)(\d*)\.?(\d*)(?:[eE]([+\-−]?\d+))?")


@dataclass(frozen=True)
class PrintedNumber:
    """A printed number, and half a unit of its last digit: what rounding leaves open."""

    value: float
    half_unit: float

    def is_cut_from(self, value: float) -> bool:
        """Whether these are the first digits of a value, with the others left out.

        Examples
        --------
        >>> printed_number("64.93").is_cut_from(64.9351)
        True
        """
        same_sign = math.copysign(1.0, value) == math.copysign(1.0, self.value)
        beyond = abs(value) - abs(self.value)
        return same_sign and 0.0 <= beyond < 2.0 * self.half_unit


def printed_number(text: str, digits: int | None = None) -> PrintedNumber:
    """Read a number as it is printed, so that its digits count.

    Parameters
    ----------
    text : str
        "3.0536", "1.242E-02", "−2.6". Trailing zeros count as digits, also of whole numbers. A
        bare "0" says that there is nothing, and leaves nothing open.
    digits : int, optional
        Significant digits, where the print leaves out trailing zeros: "1" beside "0.92".

    Raises
    ------
    ValueError
        It is no number.

    Examples
    --------
    >>> printed_number("3.0536")
    PrintedNumber(value=3.0536, half_unit=5e-05)
    >>> printed_number("1.24E-02").half_unit
    5e-05
    >>> printed_number("5744").half_unit, printed_number("1", digits=2).half_unit
    (0.5, 0.05)
    """
    match = _NUMBER.fullmatch(text.strip())
    if match is None or not (match[2] or match[3]):
        raise ValueError(f"{text!r} is no printed number")
    plain = text.strip().replace("−", "-")
    power = int((match[4] or "0").replace("−", "-"))
    value, last = float(plain), power - len(match[3])
    if value == 0.0 and not match[3]:
        return PrintedNumber(value, 0.0)
    if digits is not None and value:
        last = math.floor(math.log10(abs(value))) - digits + 1
    # From text, so that 5e-05 is the nearest number to it.
    return PrintedNumber(value, float(f"5e{last - 1}"))
