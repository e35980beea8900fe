"""What is tuned: parameters of a step law between bounds, and the cube that a search moves in."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.process.process import Process
from clepsydra.studies.tuning.parameter_words import ParameterWords

#: A start this near outside a bound stands on it, a share of the width.
ROUNDING = 1e-9


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


@dataclass(frozen=True)
class LawSpace:
    """The unit cube of the tuned parameters of one controller.

    Parameters
    ----------
    controller : Controller
        Its values are where the search starts.
    parameters : tuple of TunedParameter

    Raises
    ------
    InputError
        There is no parameter, one is named twice or is none of the law, a bound lies outside
        of what the law takes, or the start lies outside of the bounds.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> space = LawSpace(controller, (TunedParameter("level_1.proportional_gain", 0.3, 30.0),))
    >>> space.start.round(6), space.values_at(np.array([0.25]))
    (array([0.5]), {'level_1.proportional_gain': array([0.9486833])})
    """

    controller: Controller
    parameters: tuple[TunedParameter, ...]

    def __post_init__(self) -> None:
        law = {p.name: p for p in self.controller.law.parameters}
        check_names(self.parameters, law, f"a parameter of {self.controller.law.name}: ")
        for parameter in self.parameters:
            for name in (parameter.name, *parameter.followers):
                own = law[name]
                if not (own.low <= parameter.low and parameter.high <= own.high):
                    raise InputError(
                        f"tuning, {parameter.name}",
                        f"bounds {parameter.low:g} to {parameter.high:g}",
                        f"bounds for {name} within {own.low:g} to {own.high:g} {own.unit}",
                        "narrow the bounds",
                    )  # fmt: skip
            check_start(parameter, self.controller.values[parameter.name])

    @property
    def start(self) -> np.ndarray:
        """Where the controller's own values stand in the cube [p]."""
        return shares(self.parameters, self.controller.values)

    def numbers_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the tuned parameters by name [n], at points [n, p]."""
        return self.values_at(points)

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the values of tuned parameters and followers by name [n], at points [n, p].

        At the start they are the controller's own, in every bit.
        """
        return values_of(self.parameters, self.controller.values, points)

    def controller_values(self, point: np.ndarray) -> dict[str, float]:
        """Return all parameter values of the law at one point [p]."""
        found = {name: float(value[0]) for name, value in self.values_at(point).items()}
        return {**self.controller.values, **found}

    def identity(self) -> dict[str, object]:
        """Return what tells this space from any other, for JSON."""
        return {"parameters": [asdict(parameter) for parameter in self.parameters]}

    def words(self, process: Process) -> ParameterWords:
        """Return the tuned parameters in words."""
        return ParameterWords(self.controller, process)


def check_names(
    parameters: Sequence[TunedParameter], known: Collection[str], expected: str
) -> None:
    """Refuse parameters of which there is none, or one is unknown or named twice.

    Parameters
    ----------
    parameters : sequence of TunedParameter
    known : collection of str
        Names of all that can be tuned.
    expected : str
        What stands before these in a message.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_names([TunedParameter("gain", 1.0, 2.0)], ["gain", "time"], "one of ")
    """
    place = "tuning, parameters"
    if not parameters:
        raise InputError(place, "none", "at least one", "name what to tune")
    named: set[str] = set()
    for parameter in parameters:
        for name in (parameter.name, *parameter.followers):
            if name not in known:
                raise InputError(
                    place, name, f"{expected}{', '.join(known)}",
                    suggestion(name, known, "choose one of them"),
                )  # fmt: skip
            if name in named:
                raise InputError(place, name, "each name once", "drop one")
            named.add(name)


def shares(parameters: Sequence[TunedParameter], values: Mapping[str, float]) -> np.ndarray:
    """Return where values stand between the bounds of each parameter [p], 0 to 1.

    Examples
    --------
    >>> shares([TunedParameter("gain", 1.0, 100.0)], {"gain": 10.0})
    array([0.5])
    """
    return np.clip([p.share(values[p.name]) for p in parameters], 0.0, 1.0)


def values_of(
    parameters: Sequence[TunedParameter], start: Mapping[str, float], points: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the values of parameters and followers by name [n], at points [n, p].

    At the shares of the values of the start they are these, in every bit.

    Examples
    --------
    >>> values_of([TunedParameter("gain", 1.0, 100.0)], {"gain": 10.0}, np.array([[0.5], [1.0]]))
    {'gain': array([ 10., 100.])}
    """
    points = np.atleast_2d(points)
    at_start = np.all(points == shares(parameters, start), axis=1)
    return {
        name: np.where(at_start, start[name], parameter.value(column))
        for parameter, column in zip(parameters, points.T, strict=True)
        for name in (parameter.name, *parameter.followers)
    }


def check_start(parameter: TunedParameter, start: float) -> None:
    """Refuse a start outside of a parameter's bounds.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_start(TunedParameter("level_1.integral_time", 4.0, 400.0), 40.0)
    """
    if not -ROUNDING <= parameter.share(start) <= 1.0 + ROUNDING:
        raise InputError(
            f"tuning, {parameter.name}", f"a start at {start:g}",
            f"a start within its bounds {parameter.low:g} to {parameter.high:g}",
            "widen the bounds or start elsewhere",
        )  # fmt: skip


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
