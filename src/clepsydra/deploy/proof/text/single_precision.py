"""Single-precision arithmetic on numbers of Python, equal in every bit."""

from __future__ import annotations

from array import array
from collections.abc import Callable


def rounding() -> Callable[[float], float]:
    """Return a function that rounds a double to the nearest single-precision number.

    A number of single precision is kept as the double that has its value. Sum, difference,
    product, quotient and square root are computed in double and rounded once more, which is the
    number that one rounding of the exact result gives, since 53 binary digits are at least twice
    24 and two more (S. A. Figueroa, ACM SIGNUM Newsletter 30(3), 1995,
    doi 10.1145/221332.221334). That holds below the smallest normal number too, 2^-126, where
    fewer than 24 digits remain: a sum there is a multiple of 2^-149 and exact, a product of two
    singles has 48 digits and is exact in double anywhere, and no root gets there. A quotient A/B
    of whole numbers below 2^24, in units of some power of two, differs from a middle M of two
    neighbours, whole and below 2^25, by a share of |A - M B| / (M B) of it, at least 2^-49 where
    it is not M itself, which a rounding of 2^-53 does not bridge. Exponents of singles stay far
    inside those of double, so that nothing is lost or infinite before the second rounding.

    Every function has a place of its own to round in: two texts can run at the same time.

    Examples
    --------
    >>> single = rounding()
    >>> single(0.1), single(1e39), single(1e-46)
    (0.10000000149011612, inf, 0.0)
    """
    place = array("f", [0.0])

    def single(value: float) -> float:
        place[0] = value
        return place[0]

    return single
