"""Numbers and names in sentences."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Sequence

#: Each unit of time, its length [s], and the longest time that is shown in it [s].
TIME_UNITS = (
    ("s", 1.0, 180.0),
    ("min", 60.0, 3.0 * 3600.0),
    ("h", 3600.0, 3.0 * 86400.0),
    ("d", 86400.0, math.inf),
)


#: Digits of an exponent as they are printed.
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: The hyphen before a number that stands alone or in brackets.
_MINUS = re.compile(r"(?<![^\s(])-(?=\d)")


def with_minus(text: str) -> str:
    """Return words with a minus before numbers below zero, as tables have it.

    What is read back, as in quotation marks or behind a sign of equality, stays as it is.

    Examples
    --------
    >>> with_minus("PI-2: K = -3.86 %/% (-1 V), as in --input x=-1")
    'PI-2: K = −3.86 %/% (−1 V), as in --input x=-1'
    """
    return _MINUS.sub("−", text)


def time_unit(time: float) -> tuple[str, float]:
    """Return the unit in which a length of time [s] is shown, and the unit's length [s].

    Seconds up to three minutes, minutes up to three hours, hours up to three days.

    Examples
    --------
    >>> time_unit(90.0), time_unit(3000.0), time_unit(1e6)
    (('s', 1.0), ('min', 60.0), ('d', 86400.0))
    """
    return next((name, length) for name, length, most in TIME_UNITS if abs(time) <= most)


def time_text(time: float, digits: int = 3) -> str:
    """Return a time [s] in the unit that suits it, without an exponent.

    Parameters
    ----------
    time : float
        Infinite for one that never comes.
    digits : int
        Significant digits at most.

    Examples
    --------
    >>> time_text(0.0512), time_text(8143.3), time_text(90519.0), time_text(306000.0)
    ('0.0512 s', '136 min', '25.1 h', '3.54 d')
    >>> time_text(float("inf"))
    'no end'
    """
    if not math.isfinite(time):
        return "no end"
    name, length = time_unit(time)
    return f"{float(f'{time / length:.{digits}g}'):g} {name}"


def listed(names: Sequence[str]) -> str:
    """Return names as a sentence lists them.

    Examples
    --------
    >>> listed(["level_1"]), listed(["level_1", "level_2", "level_3"])
    ('level_1', 'level_1, level_2 and level_3')
    """
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def with_article(words: str) -> str:
    """Return words with "a" or "an" before them.

    Examples
    --------
    >>> with_article("setpoint error"), with_article("IAE of level"), with_article("overshoot")
    ('a setpoint error', 'an IAE of level', 'an overshoot')
    """
    return f"{'an' if words[:1].lower() in 'aeiou' else 'a'} {words}"


def digits_apart(value: float, *others: float, digits: int = 4) -> int:
    """Return with how many significant digits a number is told from others, `digits` at least.

    Numbers that are equal, or not finite, are told from nothing.

    Examples
    --------
    >>> digits_apart(2.5, 2.0), digits_apart(2.00003, 2.0), digits_apart(2.0, 2.0)
    (4, 6, 4)
    """
    for most in range(digits, 18):
        text = f"{value:.{most}g}"
        if all(other == value or f"{other:.{most}g}" != text for other in others):
            return most
    return digits


def share_text(share: float) -> str:
    """Return a share of a range in percent, of two digits and without an exponent.

    Examples
    --------
    >>> share_text(3.2e-5), share_text(0.163), share_text(0.999)
    ('0.0032 %', '16 %', '100 %')
    """
    rounded = float(f"{100.0 * share:.2g}")
    return f"{rounded:.15f}".rstrip("0").rstrip(".") + " %"


def printable(text: str) -> str:
    r"""Return a text in which control characters are written out, so that none acts on a terminal.

    Ends of lines stay.

    Examples
    --------
    >>> print(printable("level\x1b[31m_1"))
    level\x1b[31m_1
    """
    return "".join(
        repr(each)[1:-1] if each != "\n" and unicodedata.category(each) == "Cc" else each
        for each in text
    )
