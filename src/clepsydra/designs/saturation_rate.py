"""The rule for α of a variable structure: how fast an integral is brought out of saturation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.request import positive_number

#: So many times faster than the loop the integral settles while it saturates.
SLOWEST, USUAL, FASTEST = 2.0, 3.0, 5.0
#: Share of a step in which a loop counts as settled; the excess is counted alike.
BAND = 0.02


def rate_for(settling_time: float, times_faster: float = USUAL) -> float:
    """Return α with which an excess settles so many times faster than the loop [1/s].

    Alone, the excess dies away as e^(−α t), so that it settles within ln(1/0.02)/α.

    Parameters
    ----------
    settling_time : float
        Of the loop as designed, to 2 % [s].
    times_faster : float
        2 to 5.

    References
    ----------
    A. S. Hodel and C. E. Hall, Variable-structure PID control to prevent integrator windup,
    IEEE Transactions on Industrial Electronics 48(2), 2001, 442-451, doi 10.1109/41.915424.

    Examples
    --------
    >>> round(rate_for(39.12, 2.0), 4)
    0.2
    """
    return times_faster * math.log(1.0 / BAND) / settling_time


def times_faster(rate: float, settling_time: float) -> float:
    """Return how many times faster than the loop an excess settles with this α.

    Examples
    --------
    >>> round(times_faster(0.1, 39.12), 3)
    1.0
    """
    return rate * settling_time / math.log(1.0 / BAND)


def rates_in_words(
    rates: Sequence[float], settling: Mapping[str, float], names: Sequence[str]
) -> str:
    """Return α of each loop beside how fast it is.

    Examples
    --------
    >>> rates_in_words([0.1], {"level": 39.12}, ["level"])
    '0.1 1/s (1 times as fast as level settles)'
    """
    return ", ".join(
        f"{rate:.3g} 1/s ({times_faster(rate, settling[name]):.2g} times as fast as {name} settles)"
        for rate, name in zip(rates, names, strict=True)
    )


def saturation_rates(
    settling: Mapping[str, float],
    names: Sequence[str],
    given: float | Sequence[float] | None,
    effects: Sequence[float] | None = None,
) -> tuple[float, ...]:
    """Return α of each loop by the rule, or the user's if they keep to it.

    While it saturates, the integral has to settle 2 to 5 times faster than the loop as it was
    designed. A given α may err by a thousandth.

    Parameters
    ----------
    settling : mapping
        Controlled measurement to its settling time [s].
    names : sequence of str
        The controlled measurements in the order of the loops.
    given : float or sequence of float or None
        α of all loops or of each [1/s].
    effects : sequence of float, optional
        Where a given α counts the excess of an input: the effect of each input on its output,
        over which α is a rate.

    Raises
    ------
    InputError
        A given α is no number above zero, or outside of the rule.
    NotApplicable
        A loop does not settle.

    Examples
    --------
    >>> saturation_rates({"level": 100.0}, ["level"], 0.5)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: alpha of level: got 0.5, expected \
0.0782 to 0.196 1/s, 2 to 5 times as fast as the loop settles (100 s); choose α within, or leave \
it out for 3 times.
    """
    for name in names:
        if not math.isfinite(settling[name]):
            raise NotApplicable(f"{name} does not settle at its setpoint")
    if given is None:
        return tuple(rate_for(settling[name]) for name in names)
    unit = "1/s" if effects is None else "per second and unit of the input"
    remedy = f"give it {'in ' if effects is None else ''}{unit}"
    every: list[Any] = (
        list(given) if isinstance(given, (list, tuple, np.ndarray)) else [given] * len(names)
    )
    if len(every) != len(names):
        raise InputError("alpha", every, f"{len(names)} rates", "give one for each loop, or one")
    found = []
    for name, value, effect in zip(names, every, effects or [1.0] * len(names), strict=True):
        place = f"alpha of {name}"
        alpha = positive_number(place, value, f"a rate above 0 {unit}", remedy)
        low, high = (rate_for(settling[name], times) * effect for times in (SLOWEST, FASTEST))
        if not low * 0.999 <= alpha <= high * 1.001:
            expected = (
                f"{low:.3g} to {high:.3g} {unit}, {SLOWEST:g} to {FASTEST:g} times as fast as the "
                f"loop settles ({time_text(settling[name])})"
            )
            within = f"choose α within, or leave it out for {USUAL:g} times"
            raise InputError(place, alpha, expected, within)
        found.append(alpha / effect)
    return tuple(found)
