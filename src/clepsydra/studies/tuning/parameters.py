"""What is tuned: parameters of a step law, or other numbers, between bounds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable

#: A start this near outside a bound stands on it, a share of the width.
ROUNDING = 1e-9
METHOD = "tuning by simulation"
#: What is tuned of a law where nothing is named: on a logarithmic scale, and evenly.
_TUNED = (
    "proportional_gain",
    "integral_time",
    "integral_gain",
    "derivative_time",
    "derivative_gain",
    "derivative_filter",
    "filter_time",
)
_TUNED_EVENLY = ("setpoint_weight",)


@dataclass(frozen=True)
class TunedParameter:
    """A parameter of a step law that may take any value between two bounds.

    Parameters
    ----------
    name : str
        "level_1.proportional_gain"
    low, high : float
        Bounds, in the law's unit, the low one below the high one.
    logarithmic : bool
        Whether equal ratios count as equal steps, as befits gains and times; both bounds
        then have one sign and neither is zero.
    followers : tuple of str
        Parameters of the law that take the same value: a tracking time, say.

    Raises
    ------
    InputError
        There is nothing between the bounds, as where the law itself leaves no choice.
    """

    name: str
    low: float
    high: float
    logarithmic: bool = True
    followers: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.low < self.high:
            given, expected = f"bounds {self.low:g} to {self.high:g}", "a low bound below the high"
            raise InputError(f"tuning, {self.name}", given, expected, "widen them, or tune others")

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

    None of them is zero. The tracking time of a loop follows its integral time where both are
    equal. The bounds end where the law's own range does.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> (time,) = around(controller, ["level_1.integral_time"])
    >>> round(time.low, 3), round(time.high, 1), time.followers
    (3.203, 320.3, ('level_1.tracking_time',))
    """
    law = {p.name: p for p in controller.law.parameters}
    found = []
    for name in names:
        value = controller.values[name]
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


def settings_of(controller: Controller) -> tuple[TunedParameter, ...]:
    """Return all settings of the loops of a law: gains, times and filters, and setpoint weights.

    Each may move by a factor of ten up and down, but a setpoint weight between 0 and 1. What is
    zero is off, and stays so.

    Raises
    ------
    NotApplicable
        There are none.

    Examples
    --------
    >>> import clepsydra as cl
    >>> [p.name.partition(".")[2] for p in settings_of(cl.design.simc(cl.load("three-tanks")))]
    ['proportional_gain', 'integral_time', 'setpoint_weight']
    """
    values = controller.values
    names = [
        parameter.name
        for parameter in controller.law.parameters
        if parameter.part in _TUNED and values[parameter.name] != 0.0
    ]
    if not names:
        raise NotApplicable(f"{controller.name} has no gain and no integral time to tune", METHOD)
    weights = [
        TunedParameter(parameter.name, parameter.low, parameter.high, logarithmic=False)
        for parameter in controller.law.parameters
        if parameter.part in _TUNED_EVENLY
        and parameter.low <= values[parameter.name] <= parameter.high
    ]
    return (*around(controller, names), *weights)
