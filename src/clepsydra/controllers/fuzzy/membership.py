"""Membership functions: how far a number belongs to a fuzzy set."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass
from functools import reduce
from itertools import pairwise
from typing import ClassVar

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError

#: Beyond this exponent a Gaussian stays at its value there, 1e-304, so that it is never zero.
_LARGEST_EXPONENT = 700.0
#: exp(-z) = (exp(-z / 2¹⁰))^(2¹⁰), the inner one by this many terms of its series: to 1e-12.
_HALVINGS = 10
_TERMS = 8


@dataclass(frozen=True)
class Trapezoid:
    """A set that rises from 0 at `foot` to 1 at `top` and falls from `end_of_top` to `end`.

    A triangle has its two tops in one place, a shoulder is open on one side (`left_shoulder`,
    `right_shoulder`), and where foot and top are one place the edge is upright.

    `foot`, `top`, `end_of_top`, `end`: in rising order; foot and top may both be -∞, end_of_top and
    end both ∞.

    Raises InputError: the places are not in order, the set has no width, or it is open where it
    must not be.

    Examples
    --------
    >>> Trapezoid(0.0, 1.0, 2.0, 4.0).degrees([-1.0, 0.25, 1.5, 3.0]).tolist()
    [0.0, 0.25, 1.0, 0.5]
    """

    foot: float
    top: float
    end_of_top: float
    end: float

    def __post_init__(self) -> None:
        open_ends = (self.foot == -math.inf) == (self.top == -math.inf)
        open_ends = open_ends and (self.end == math.inf) == (self.end_of_top == math.inf)
        bounded = math.isfinite(self.top) or math.isfinite(self.end_of_top)
        ordered = all(a <= b for a, b in pairwise(astuple(self))) and self.foot < self.end
        if not (ordered and open_ends and bounded):
            shown = ", ".join(f"{place:g}" for place in self.corners)
            raise InputError(
                "fuzzy set", shown, "numbers in rising order that do not all agree",
                "put them in order, from the left foot to the right one",
            )  # fmt: skip

    @property
    def corners(self) -> tuple[float, ...]:
        """The places at which the slope changes."""
        return tuple(place for place in astuple(self) if math.isfinite(place))

    @property
    def edges(self) -> tuple[tuple[float, float], ...]:
        """Slope and zero of the edges that are not upright.

        >>> triangle(-1.0, 0.0, 2.0).edges, left_shoulder(1.0, 5.0).edges
        (((1.0, -1.0), (-0.5, 2.0)), ((-0.25, 5.0),))
        """
        sides = (self.top - self.foot, self.foot), (self.end_of_top - self.end, self.end)
        return tuple((1.0 / width, zero) for width, zero in sides if abs(width) > 0.0)

    def degrees(self, x: object) -> np.ndarray:
        """Return the degrees of membership of numbers [n]."""
        x = np.asarray(x, dtype=float)
        return np.array(ca.evalf(self.expression(ca.SX(x.ravel())))).reshape(x.shape)

    def expression(self, x: ca.SX) -> ca.SX:
        """Return the degree as an expression that every target computes to the same bit."""
        edges = [(x - zero if slope > 0.0 else zero - x) * abs(slope) for slope, zero in self.edges]
        # d · (1/d), rounded twice, is never above 1: where the edges meet they are the limit.
        if len(edges) < 2 or self.top < self.end_of_top:
            edges.append(ca.SX(1))
        degree = ca.fmax(0, reduce(ca.fmin, edges))
        if self.top - self.foot == 0.0:
            degree = ca.if_else(x - self.foot >= 0, degree, 0)
        if self.end - self.end_of_top == 0.0:
            degree = ca.if_else(self.end - x >= 0, degree, 0)
        return degree


@dataclass(frozen=True)
class Gaussian:
    """A set of degree exp(-(x - centre)² / (2 width²)).

    It is computed by additions and multiplications alone, to 12 digits, so that the engine, C and
    Structured Text agree in every bit; it is nowhere zero.

    `centre`, `width`: the width is the standard deviation.

    Raises InputError: the width is not above zero.

    Examples
    --------
    >>> Gaussian(0.0, 0.5).degrees([0.0, 0.5]).round(6).tolist()
    [1.0, 0.606531]
    """

    centre: float
    width: float
    #: None: it is smooth.
    corners: ClassVar[tuple[float, ...]] = ()
    edges: ClassVar[tuple[tuple[float, float], ...]] = ()

    def __post_init__(self) -> None:
        if not (math.isfinite(self.centre) and 0.0 < self.width < math.inf):
            raise InputError(
                "fuzzy set", f"{self.centre:g}, {self.width:g}", "a centre, and a width above zero",
                "give the standard deviation as the second number",
            )  # fmt: skip

    def degrees(self, x: object) -> np.ndarray:
        """Return the degrees of membership of numbers [n]."""
        distance = (np.asarray(x, dtype=float) - self.centre) / self.width
        return np.exp(-np.minimum(distance * distance / 2.0, _LARGEST_EXPONENT))

    def expression(self, x: ca.SX) -> ca.SX:
        """Return the degree as an expression that every target computes to the same bit."""
        distance = (x - self.centre) * (1.0 / self.width)
        # Farther away the square would not change the degree, but could overflow.
        distance = ca.fmin(50.0, ca.fabs(distance))
        exponent = ca.fmin(_LARGEST_EXPONENT, 0.5 * (distance * distance))
        part = exponent * 2.0**-_HALVINGS
        series = ca.SX(1)
        for n in range(_TERMS, 0, -1):
            series = 1 - part * (1.0 / n) * series
        for _ in range(_HALVINGS):
            series = series * series
        return series


Membership = Trapezoid | Gaussian


def triangle(foot: float, top: float, end: float) -> Trapezoid:
    """Return a triangle.

    Examples
    --------
    >>> triangle(-1.0, 0.0, 2.0).degrees([-0.5, 0.5]).tolist()
    [0.5, 0.75]
    """
    return Trapezoid(foot, top, top, end)


def left_shoulder(end_of_top: float, end: float) -> Trapezoid:
    """Return an L-function: 1 left of its first point, 0 right of its second one.

    Examples
    --------
    >>> left_shoulder(-0.2, 0.0).degrees([-9.0, -0.1, 0.0]).tolist()
    [1.0, 0.5, 0.0]
    """
    return Trapezoid(-math.inf, -math.inf, end_of_top, end)


def right_shoulder(foot: float, top: float) -> Trapezoid:
    """Return an R-function: 0 left of its first point, 1 right of its second one.

    Examples
    --------
    >>> right_shoulder(0.0, 0.2).degrees([0.0, 0.1, 9.0]).tolist()
    [0.0, 0.5, 1.0]
    """
    return Trapezoid(foot, top, math.inf, math.inf)
