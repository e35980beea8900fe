"""Operating points for a schedule: where, what is designed there, and the peaks between."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache, lru_cache
from typing import Literal, NamedTuple

import numpy as np

from clepsydra.base.arguments import check_choice, is_finite_number
from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.gain_scheduling import FEWEST_POINTS, MOST_POINTS
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.designed_values import kind as kind_of
from clepsydra.designs.request import in_shown_unit
from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.linear.operating_point import OperatingPoint

#: How near to the ends of a range operating points are looked for, a share of it.
_MARGIN = 0.05
#: Shares of the way to the end at which the outermost point is tried.
_WAYS = (1.0, 0.7, 0.4, 0.2, 0.1)
#: Points at most; they are added where the peak between two of them is above the limit.
_MOST = 9
#: Gains that change by less over the range need no schedule.
_LEAST_CHANGE = 0.02
#: A peak between points that is this near above the limit is let pass.
_CLOSE = 1.01

Follows = Literal["measurement", "setpoint"]


class PlannedPoint(NamedTuple):
    """A point of a schedule: where it is, the values designed there, and the peak of |S|."""

    place: float
    values: dict[str, float]
    peak: float


Plan = Sequence[PlannedPoint]


class Along:
    """A design at the operating points along one controlled measurement.

    Parameters
    ----------
    plain : Controller
        Without a schedule.
    values_at : callable
        A linear model to the parameters that are designed for it.
    over : str
        The controlled measurement.
    """

    def __init__(
        self,
        model: LinearModel,
        plain: Controller,
        values_at: Callable[[LinearModel], dict[str, float]],
        over: str,
    ) -> None:
        self.model, self.plain, self.values_at, self.over = model, plain, values_at, over
        self.point = operating_point_of(model)
        self.signal = self.point.process.signal(over)
        self.rest = self.point.as_dict()[over]
        #: What each parameter is, the gains of one matrix being of one kind.
        self.kinds = {parameter.name: kind_of(parameter) for parameter in plain.law.parameters}

    def peak(self, there: LinearModel, values: Mapping[str, float]) -> float:
        """Return the sensitivity peak of the plain controller with these values on a model."""
        seen = with_outputs(there, self.plain.measurements)
        values = {**self.plain.values, **values}
        return SampledLoops(self.plain, seen).at(values).maximum_sensitivity

    def designed(self, place: float, there: LinearModel | None = None) -> PlannedPoint:
        """Return the design at a place [unit of the measurement], where the model may be known."""
        there = model_at(self.model, {self.over: place}) if there is None else there
        values = self.values_at(there)
        return PlannedPoint(place, values, self.peak(there, values))

    def needed(self, place: float) -> PlannedPoint:
        """Return the design at a point without which there is no schedule."""
        try:
            return self.designed(place)
        except ClepsydraError as refusal:
            raise NotApplicable(f"at {self.over} {place:g}: {refusal}") from None

    def outermost(self) -> list[PlannedPoint]:
        """Return the design of the model between those nearest to the ends of the range."""
        signal, rest, margin = self.signal, self.rest, _MARGIN * self.signal.span
        found = [self.designed(rest, self.model)]
        for end, sign in ((signal.low + margin, -1.0), (signal.high - margin, 1.0)):
            for way in _WAYS if math.isfinite(margin) and (end - rest) * sign > margin else ():
                with suppress(ClepsydraError):
                    found.append(self.designed(rest + way * (end - rest)))
                    break
        return sorted(found, key=lambda point: point.place)

    def between(self, plan: Plan) -> list[float]:
        """Return the peaks halfway between neighbours, with interpolated settings."""
        found = []
        for low, high in itertools.pairwise(plan):
            place = 0.5 * (low.place + high.place)
            there = model_at(self.model, {self.over: place})
            found.append(self.peak(there, _interpolated(plan, place)))
        return found

    def checked(self, points: Sequence[float]) -> list[float]:
        """Return the points that a user gave, rising and within the range of the measurement."""
        over, signal = self.over, self.signal
        numbers = isinstance(points, (list, tuple, np.ndarray)) and all(
            map(is_finite_number, points)
        )
        count = len(points) if numbers else 0
        if not FEWEST_POINTS <= count <= MOST_POINTS or any(np.diff(points) <= 0.0):
            expected = f"{FEWEST_POINTS} to {MOST_POINTS} rising numbers"
            raise InputError("points", points, expected, f"give values of {over} in {signal.unit}")
        outside = [value for value in points if not signal.low <= value <= signal.high]
        if outside:
            expected = f"a number from {signal.low:g} to {signal.high:g} {signal.unit}"
            remedy = f"choose points within the range of {over}"
            raise InputError("points", outside[0], expected, remedy)
        return [float(value) for value in points]

    def elsewhere(self, plan: Plan) -> list[str]:
        """Return what the peak is where another controlled output is halfway to an end."""
        at, notes = self.point.as_dict(), []
        values = _interpolated(plan, self.rest)
        for name in self.plain.setpoints:
            signal = self.point.process.signal(name)
            if name == self.over or not math.isfinite(signal.span):
                continue
            for end in (signal.low, signal.high):
                place = 0.5 * (at[name] + end)
                try:
                    peak = self.peak(model_at(self.model, {name: place}), values)
                except ClepsydraError:
                    continue
                text = f"{peak:.2f}" if math.isfinite(peak) else "infinite: the loop is unstable"
                notes.append(
                    f"With {name} at {in_shown_unit(signal, place)}, over which nothing is "
                    f"scheduled, the sensitivity peak is {text}."
                )
        return notes


def planned_points(
    model: LinearModel,
    plain: Controller,
    values_at: Callable[[LinearModel], dict[str, float]],
    over: str | None,
    points: Sequence[float] | None,
) -> tuple[Along, list[PlannedPoint], list[float]]:
    """Return along what is scheduled, its points, and the peaks halfway between them.

    Parameters
    ----------
    over : str, optional
        The controlled measurement over which the parameters change the most if left out.
    points : sequence of float, optional
        In its unit; if left out as many as keep the peaks between them at 2.

    Raises
    ------
    NotApplicable
        There are no other operating points, or the parameters hardly change over them.
    InputError
        A name is unknown, or the points are no 2 to 15 rising numbers within the range.
    """
    outputs = plain.setpoints
    if len(model.inputs) != len(model.outputs):
        raise NotApplicable(
            f"{len(model.inputs)} inputs for {len(model.outputs)} controlled outputs leave other "
            "operating points open"
        )
    if over is not None:
        check_choice("over", over, outputs)
    if points is not None:
        along = Along(model, plain, values_at, over or outputs[0])
        plan = [along.needed(place) for place in along.checked(points)]
        return along, plan, along.between(plan)
    candidates = (over,) if over is not None else outputs
    values_at = cache(values_at)  # the model itself is a point along each of them
    changes = [
        (largest_change(plan, {name: along.kinds[name] for name in plan[0].values}), along, plan)
        for along in (Along(model, plain, values_at, name) for name in candidates)
        if len(plan := along.outermost()) >= FEWEST_POINTS
    ]
    if not changes:
        raise NotApplicable(f"there is no other operating point along {' or '.join(candidates)}")
    change, along, plan = max(changes, key=lambda each: each[0])
    if change < _LEAST_CHANGE:
        raise NotApplicable(
            f"its gains change by less than {100.0 * _LEAST_CHANGE:g} % over the range of "
            f"{' or '.join(candidates)}: fixed gains do as well"
        )
    pairs = itertools.pairwise(plan)
    halfway = [along.needed(0.5 * (low.place + high.place)) for low, high in pairs]
    plan = sorted([*plan, *halfway], key=lambda point: point.place)
    between = along.between(plan)
    while max(between) > SENSITIVITY_LIMIT * _CLOSE and len(plan) < _MOST:
        worst = int(np.argmax(between))
        place = 0.5 * (plan[worst].place + plan[worst + 1].place)
        plan.insert(worst + 1, along.needed(place))
        between = along.between(plan)
    return along, plan, between


def _interpolated(plan: Plan, place: float) -> dict[str, float]:
    places = [each.place for each in plan]
    return {
        name: float(np.interp(place, places, [each.values[name] for each in plan]))
        for name in plan[0].values
    }


def model_at(model: LinearModel, asked: Mapping[str, float]) -> LinearModel:
    """Return the linear model of a process where some controlled measurements are others.

    The other controlled measurements, the disturbances and the inputs that are left alone are
    those of the operating point of the model.

    Parameters
    ----------
    asked : mapping
        Controlled measurement to its value [its unit].

    Raises
    ------
    NoEquilibrium
        There is no such operating point.
    InputError
        A value is outside of its range, the process has not as many inputs as outputs, or a
        tank is empty there.

    Examples
    --------
    Twice the volume has twice the time constant, of 10 s at 2 m³:

    >>> import clepsydra as cl
    >>> model = cl.load("averaging-tank").linear
    >>> there = model_at(model, {"volume": 4.0})
    >>> round(-1 / float(there.A.diagonal().min()), 6)
    20.0
    """
    at = operating_point_of(model).as_dict()
    outputs = tuple((name, float(asked.get(name, at[name]))) for name in model.outputs)
    found = _found_at(operating_point_of(model), model.inputs, outputs)
    if isinstance(found, ClepsydraError):
        raise found
    return found


def largest_change(plan: Plan, kinds: Mapping[str, str]) -> float:
    """Return the largest change of a value over the points, a share of its largest magnitude.

    Of gains of one kind, those near zero beside the others do not count.

    Parameters
    ----------
    kinds : mapping
        Name to its kind, of those that count.

    Examples
    --------
    >>> plan = [PlannedPoint(1.0, {"gain": 4.0}, 1.5), PlannedPoint(2.0, {"gain": 5.0}, 1.5)]
    >>> largest_change(plan, {"gain": "gain"})
    0.2
    """
    table = np.array([[point.values[name] for name in kinds] for point in plan])
    sizes, of = np.abs(table).max(axis=0), np.array([*kinds.values()])
    alike = np.array([sizes[of == kind].max() for kind in of])
    counted = (sizes > 0.0) & (sizes >= 0.05 * alike)
    return float((np.ptp(table, axis=0)[counted] / sizes[counted]).max(initial=0.0))


@lru_cache(maxsize=128)
def _found_at(
    point: OperatingPoint, moved: tuple[str, ...], outputs: tuple[tuple[str, float], ...]
) -> LinearModel | ClepsydraError:
    """Return the model or why there is none: several designs ask for the same points."""
    process, at = point.process, point.as_dict()
    try:
        found = find_equilibrium(
            process,
            inputs={s.name: at[s.name] for s in process.inputs if s.name not in moved},
            outputs=dict(outputs),
            disturbances={signal.name: at[signal.name] for signal in process.disturbances},
        )
        return linearise(found).select([name for name, _ in outputs], moved)
    except ClepsydraError as refusal:
        return refusal
