"""Quantiles of scores over draws, with intervals that hold for any distribution.

The quantile is the inverse of the empirical distribution: of n scores in ascending order the one
at place ⌈q n⌉, the smallest that at least a share q of the draws does not exceed (definition 1 of
R. J. Hyndman and Y. Fan, Am. Stat. 50, 1996, doi:10.1080/00031305.1996.10473566). So it is the
score of a draw, which can be run again and looked at; and nothing is ever interpolated between a
finite score and an infinite one, which is what a loop that broke has.

Its interval is made of two other scores of the same order. How many of n draws are below the true
quantile is binomial, whatever the distribution is; the bounds are the innermost places that fail
with at most half of the chance that the level leaves (H. A. David and H. N. Nagaraja, Order
Statistics, 2003, section 7.1, doi:10.1002/0471722162). Where n is too small for one, there is none
on that side.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.studies.robustness.shares import LEVEL


class Places(NamedTuple):
    """Which of n scores in ascending order are a quantile and its bounds, counted from 1.

    Attributes
    ----------
    quantile : int
    low, high : int or None
        None where n is too small for a bound on that side.
    coverage : float
        How probable it is that the bounds hold the quantile of a continuous distribution; a bound
        that is not there cannot fail. Of any other distribution they hold it at least so often.
    """

    quantile: int
    low: int | None
    high: int | None
    coverage: float


@lru_cache(maxsize=4096)
def places(draws: int, chance: float, level: float = LEVEL) -> Places:
    """Return which scores are a quantile and the bounds of its interval.

    Parameters
    ----------
    draws : int
        How many there are, at least 1.
    chance : float
        The share of draws that the quantile is not to be exceeded in, above 0 and below 1. It is
        read as the decimal that is written: 7 % of 100 draws are 7.
    level : float
        How often the interval is to hold the quantile, at least.

    Raises
    ------
    InputError
        There are no draws, or the chance is not between 0 and 1.

    Examples
    --------
    >>> found = places(1000, 0.95)
    >>> found.quantile, found.low, found.high, round(found.coverage, 4)
    (950, 936, 964, 0.9581)
    >>> places(20, 0.95)[:3]
    (19, 17, None)
    """
    if draws < 1:
        raise InputError("quantile", Finding("no draws"), "one draw at least", "draw some")
    if not 0.0 < chance < 1.0:
        raise InputError("quantile", chance, "a share above 0 and below 1", "as 0.95 for 95 %")
    below, above = (_innermost(draws, each, level) for each in (chance, 1.0 - chance))
    return Places(
        math.ceil(Fraction(repr(float(chance))) * draws),
        below.place or None,
        draws + 1 - above.place if above.place else None,
        1.0 - below.fails - above.fails,
    )


class _Bound(NamedTuple):
    place: int
    fails: float


def _innermost(draws: int, chance: float, level: float) -> _Bound:
    """Return the lower bound that is nearest to a quantile, and how often it fails; 0 for none.

    It fails where fewer draws than its place are below the quantile. The upper bound is that of the
    descending order.
    """
    from scipy.stats import binom

    # A chance that is met in decimals, as 5 % of one draw, is not missed by a rounding.
    most = 0.5 * (1.0 - level) * (1.0 + 1e-9)
    place = int(binom.ppf(most, draws, chance))
    return _Bound(place, float(binom.cdf(place - 1, draws, chance)))


def draws_for_bounds(chance: float, level: float = LEVEL) -> int:
    """Return how many draws give a quantile's interval a bound on both sides.

    Examples
    --------
    >>> draws_for_bounds(0.5), draws_for_bounds(0.95), draws_for_bounds(0.99)
    (6, 72, 368)
    """
    rarer = max(chance, 1.0 - chance)
    count = max(1, math.floor(math.log(0.5 * (1.0 - level)) / math.log(rarer)))
    while None in places(count, chance, level):
        count += 1
    return count


@dataclass(frozen=True)
class Quantile:
    """A quantile of scores, with its interval.

    Attributes
    ----------
    chance : float
        The share of draws that do not exceed it.
    value : float
        The score of a draw; infinite where so many loops broke.
    low, high : float or None
        Bounds of the interval; None where there are too few draws for one on that side.
    draws : int
    level : float
        How often the interval holds the true quantile, at least.

    Examples
    --------
    >>> print(quantile(np.arange(1.0, 1001.0), 0.95))
    95 % of draws at or below 950 (936 to 964)
    >>> print(quantile(np.arange(1.0, 21.0), 0.95))
    95 % of draws at or below 19 (at least 17; an upper bound takes 72 draws)
    >>> broken = np.array([1.0, 2.0, np.inf, np.inf])
    >>> print(quantile(broken, 0.75).words("{:.1f} s"))
    75 % of draws at or below infinity (at least 1.0 s; an upper bound takes 13 draws)
    """

    chance: float
    value: float
    low: float | None
    high: float | None
    draws: int
    level: float

    def words(self, number: str | Callable[[float], str] = "{:.4g}") -> str:
        """Return it in words.

        Parameters
        ----------
        number : str or function
            The format of a finite number with its unit, such as ``"{:.1f} s"``, or what makes the
            text of one.
        """
        shown = number.format if isinstance(number, str) else number
        value, low, high = (
            "" if bound is None else _named(bound) or shown(bound)
            for bound in (self.value, self.low, self.high)
        )
        takes = f"{draws_for_bounds(self.chance, self.level):,} draws"
        if low and high:
            bounds = f"{low} to {high}"
        elif low:
            bounds = f"at least {low}; an upper bound takes {takes}"
        elif high:
            bounds = f"at most {high}; a lower bound takes {takes}"
        else:
            bounds = f"no bounds: they take {takes}"
        percent = f"{float(f'{100.0 * self.chance:.10g}'):g}"
        return f"{percent} % of draws at or below {value} ({bounds})"

    def __str__(self) -> str:
        return self.words()


def quantile(scores: np.ndarray, chance: float, level: float = LEVEL) -> Quantile:
    """Return a quantile of scores, with its interval.

    Parameters
    ----------
    scores : ndarray [draws]
        Infinite where a loop broke.
    chance, level : float
        As for `places`.

    Raises
    ------
    InputError
        There are no scores, one is not a number, or the chance is not between 0 and 1.

    Examples
    --------
    >>> found = quantile(np.array([3.0, 1.0, 2.0, np.inf, 5.0, 4.0]), 0.5)
    >>> found.value, found.low, found.high
    (3.0, 1.0, inf)
    """
    value, low, high = quantile_table(np.asarray(scores)[:, None], [chance], level)[:, 0, 0]
    place = places(len(scores), chance, level)
    return Quantile(
        chance,
        float(value),
        None if place.low is None else float(low),
        None if place.high is None else float(high),
        len(scores),
        level,
    )


def quantile_table(
    scores: np.ndarray, chances: list[float] | tuple[float, ...], level: float = LEVEL
) -> np.ndarray:
    """Return quantiles of many scores at once, with their bounds.

    Parameters
    ----------
    scores : ndarray [draws, scores]
    chances : list of float [k]
    level : float

    Returns
    -------
    ndarray [3, k, scores]
        The quantiles, their lower and their upper bounds. A bound for which there are too few draws
        is −∞ or ∞, so that it holds what it should; `places` tells it from a loop that broke.

    Raises
    ------
    InputError
        As for `quantile`.

    Examples
    --------
    >>> quantile_table(np.array([[1.0, 8.0], [2.0, 9.0]]), [0.5])[:, 0]
    array([[  1.,   8.],
           [-inf, -inf],
           [ inf,  inf]])
    """
    scores = np.asarray(scores, dtype=float)
    require_ordered(scores)
    found = [places(len(scores), chance, level) for chance in chances]
    inside = sorted({p for place in found for p in place[:3] if p is not None})
    ordered = np.partition(scores, [place - 1 for place in inside], axis=0)
    table = np.empty((3, len(found), scores.shape[1]))
    table[1], table[2] = -np.inf, np.inf
    for row, place in enumerate(found):
        for kind, which in enumerate(place[:3]):
            if which is not None:
                table[kind, row] = ordered[which - 1]
    return table


def require_ordered(scores: np.ndarray) -> None:
    """Refuse scores that have no place in an order: what is not a number."""
    unknown = int(np.count_nonzero(np.isnan(scores)))
    if unknown:
        raise InputError(
            "scores",
            Finding(f"{unknown:,} of {scores.size:,} that are not numbers"),
            "numbers, infinite where a loop broke",
            "say what a draw without a score is worth",
        )


def _named(bound: float) -> str:
    """Return the name of what no format writes well, else nothing."""
    return {math.inf: "infinity", -math.inf: "minus infinity"}.get(bound, "")
