"""What is tuned: parameters of a step law, or other numbers, between bounds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.arguments import is_finite_number, require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable

#: A start this near outside a bound stands on it, a share of the width.
ROUNDING = 1e-9
METHOD = "tuning by simulation"
#: What is tuned of a law where nothing is named.
_TUNED = ("proportional_gain", "integral_time", "integral_gain")


@dataclass(frozen=True)
class TunedParameter:
    """A parameter of a step law that may take any value between two bounds.

    Parameters
    ----------
    name : str
        "level_1.proportional_gain"
    low, high : float
        Bounds, in the law's unit.
    logarithmic : bool
        Whether equal ratios count as equal steps, as befits gains and times; both bounds
        then have one sign and neither is zero.
    followers : tuple of str
        Parameters of the law that take the same value: a tracking time, say.

    Raises
    ------
    InputError
        The bounds are the wrong way round, not finite, or, for logarithmic steps, on both
        sides of zero.

    Examples
    --------
    >>> TunedParameter("tracking_time", 400.0, 4.0)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: tuning, tracking_time: got 'bounds 400 to 4', expected \
a low bound below the high bound; exchange or widen them.
    """

    name: str
    low: float
    high: float
    logarithmic: bool = True
    followers: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        require_type(self.name, str, "tuning, name", "the name of a parameter", "give it as text")
        place = f"tuning, {self.name}"
        for bound in (self.low, self.high):
            if not is_finite_number(bound):
                raise InputError(place, bound, "a finite bound", "give a number in the law's unit")
        given = f"bounds {self.low:g} to {self.high:g}"
        if not self.low < self.high:
            raise InputError(
                place, given, "a low bound below the high bound", "exchange or widen them"
            )
        if self.logarithmic and not self.low * self.high > 0.0:
            raise InputError(
                place, given, "bounds of one sign for logarithmic steps",
                "keep zero outside, or take linear steps",
            )  # fmt: skip

    def value(self, share: np.ndarray) -> np.ndarray:
        """Return the values at some shares of the way from low to high.

        Examples
        --------
        >>> TunedParameter("tracking_time", 4.0, 400.0).value(np.array([0.0, 0.5, 1.0])).round(9)
        array([  4.,  40., 400.])
        """
        share = np.asarray(share, dtype=float)
        if not self.logarithmic:
            found = self.low + share * (self.high - self.low)
        else:
            found = self.low * (self.high / self.low) ** share
        # At the ends rounding must not lead outside.
        return np.clip(found, self.low, self.high)

    def share(self, value: float) -> float:
        """Return where a value stands between low and high, 0 to 1 inside the bounds."""
        if not self.logarithmic:
            return (value - self.low) / (self.high - self.low)
        ratio = value / self.low
        if ratio <= 0.0:
            return -math.inf
        return math.log(ratio) / math.log(self.high / self.low)


def around(
    controller: Controller, names: Sequence[str], factor: float = 10.0
) -> tuple[TunedParameter, ...]:
    """Return parameters that may move by a factor up and down from where they stand.

    The tracking time of a loop follows its integral time where both are equal. The bounds end
    where the law's own range does.

    Parameters
    ----------
    controller : Controller
    names : sequence of str
        Parameters whose value is not zero.
    factor : float
        Above 1.

    Raises
    ------
    InputError
        A name is none of the law's, or its value is zero; or the factor is not above 1.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> (time,) = around(controller, ["level_1.integral_time"])
    >>> round(time.low, 3), round(time.high, 1), time.followers
    (3.203, 320.3, ('level_1.tracking_time',))
    """
    require_type(controller, Controller, "controller", "a Controller", "design one, or make one")
    names = sequence_of(
        names, str, "tuning, parameters", "a list of names of parameters",
        f'write as in ["{next(iter(controller.values), "level_1.proportional_gain")}"]',
    )  # fmt: skip
    if not is_finite_number(factor) or not factor > 1.0:
        raise InputError("tuning, factor", factor, "a number above 1", "10 is customary")
    law = {p.name: p for p in controller.law.parameters}
    found = []
    for name in names:
        value = controller.values.get(name)
        if value is None or value == 0.0:
            raise InputError(
                "tuning, parameters", name if value is None else f"{name} = 0",
                f"a parameter of {controller.law.name} that is not zero", "give bounds of its own",
            )  # fmt: skip
        ends = sorted((value / factor, value * factor))
        tracking = name.replace("integral_time", "tracking_time")
        follows = tracking != name and controller.values.get(tracking) == value
        found.append(
            TunedParameter(
                name,
                max(ends[0], law[name].low),
                min(ends[1], law[name].high),
                followers=(tracking,) if follows else (),
            )
        )
    return tuple(found)


def gains_and_times(controller: Controller) -> tuple[TunedParameter, ...]:
    """Return gains and integral times of a law, each within a factor of ten.

    Raises
    ------
    NotApplicable
        It has neither.

    Examples
    --------
    >>> import clepsydra as cl
    >>> [p.name for p in gains_and_times(cl.design.simc(cl.load("three-tanks")))]
    ['level_3.proportional_gain', 'level_3.integral_time']
    """
    names = [
        parameter.name
        for parameter in controller.law.parameters
        if parameter.part in _TUNED and controller.values[parameter.name] != 0.0
    ]
    if not names:
        raise NotApplicable(f"{controller.name} has no gain and no integral time to tune", METHOD)
    return around(controller, names)
