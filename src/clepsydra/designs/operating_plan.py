"""Operating points for a schedule: where, what is designed there, and the peaks between."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from clepsydra.base.arguments import check_choice, is_finite_number
from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.base.signal import Signal
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


class Wish(NamedTuple):
    """Over what a user wants parameters scheduled, following what, and at which values."""

    over: str | None
    follows: Follows
    points: Sequence[float] | None


class ScheduledDesign(NamedTuple):
    """What is scheduled.

    Parameters
    ----------
    plain : Controller
        Without a schedule.
    at : callable
        Takes a linear model and returns the parameters that are designed for it.
    name, words : str
        Of the controller and the design.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.lqi import design_lqi
    >>> plain = design_lqi(cl.load("quadruple-tank").linear)
    >>> ScheduledDesign(plain, lambda model: {}, "LQI, gain scheduling", "").plain.setpoints
    ('level_1', 'level_2')
    """

    plain: Controller
    at: Callable[[LinearModel], dict[str, float]]
    name: str
    words: str

    @property
    def kinds(self) -> dict[str, str]:
        """What each parameter is, the gains of one matrix being of one kind."""
        return {parameter.name: kind_of(parameter) for parameter in self.plain.law.parameters}

    def peak(self, there: LinearModel, values: Mapping[str, float]) -> float:
        """Return the sensitivity peak of the plain controller with these values on a model."""
        plain = self.plain
        seen = with_outputs(there, plain.measurements)
        return SampledLoops(plain, seen).at({**plain.values, **values}).maximum_sensitivity


class _Along(NamedTuple):
    """The operating points along which a design is scheduled."""

    model: LinearModel
    scheduled: ScheduledDesign
    over: str

    @property
    def signal(self) -> Signal:
        return operating_point_of(self.model).process.signal(self.over)

    def designed_at(self, place: float) -> PlannedPoint:
        there = model_at(self.model, {self.over: place})
        values = self.scheduled.at(there)
        return PlannedPoint(place, values, self.scheduled.peak(there, values))

    def needed_at(self, place: float) -> PlannedPoint:
        """Return the design at a point without which there is no schedule."""
        try:
            return self.designed_at(place)
        except ClepsydraError as refusal:
            raise NotApplicable(f"at {self.over} {place:g}: {refusal}") from None

    def end(self, high: bool) -> list[PlannedPoint]:
        """Return the design nearest to an end of the range at which there is one, if any."""
        signal, rest = self.signal, operating_point_of(self.model).as_dict()[self.over]
        margin, sign = _MARGIN * signal.span, 1.0 if high else -1.0
        end = signal.high - margin if high else signal.low + margin
        if math.isfinite(signal.span) and (end - rest) * sign > margin:
            for way in _WAYS:
                with suppress(ClepsydraError):
                    return [self.designed_at(rest + way * (end - rest))]
        return []

    def outermost(self) -> list[PlannedPoint]:
        """Return the design of the model between those nearest to the ends of the range."""
        rest = operating_point_of(self.model).as_dict()[self.over]
        values = self.scheduled.at(self.model)
        own = PlannedPoint(rest, values, self.scheduled.peak(self.model, values))
        return sorted([*self.end(False), *self.end(True), own], key=lambda point: point.place)

    def between(self, plan: Sequence[PlannedPoint]) -> list[float]:
        """Return the peaks halfway between neighbours, with interpolated settings."""
        found = []
        for low, high in itertools.pairwise(plan):
            there = model_at(self.model, {self.over: 0.5 * (low.place + high.place)})
            values = {name: 0.5 * (value + high.values[name]) for name, value in low.values.items()}
            found.append(self.scheduled.peak(there, values))
        return found

    def checked(self, points: Sequence[float]) -> list[float]:
        over, signal, place = self.over, self.signal, "points"
        numbers = isinstance(points, (list, tuple, np.ndarray)) and all(
            is_finite_number(value) for value in points
        )
        count = len(points) if numbers else 0
        if not FEWEST_POINTS <= count <= MOST_POINTS or any(np.diff(points) <= 0.0):
            raise InputError(
                place,
                points,
                f"{FEWEST_POINTS} to {MOST_POINTS} rising numbers",
                f"give values of {over} in {signal.unit}",
            )
        outside = [value for value in points if not signal.low <= value <= signal.high]
        if outside:
            raise InputError(
                place,
                outside[0],
                f"a number from {signal.low:g} to {signal.high:g} {signal.unit}",
                f"choose points within the range of {over}",
            )
        return [float(value) for value in points]


def planned_points(
    model: LinearModel, scheduled: ScheduledDesign, wish: Wish
) -> tuple[str, list[PlannedPoint], list[float]]:
    """Return over what is scheduled, its points, and the peaks halfway between them.

    Raises
    ------
    NotApplicable
        There are no other operating points, or the parameters hardly change over them.
    InputError
        A name is unknown, or the points are no 2 to 15 rising numbers within the range.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.lqi import design_lqi
    >>> model = cl.load("quadruple-tank").linear
    >>> design = ScheduledDesign(
    ...     design_lqi(model), lambda place: design_lqi(place).values, "LQI", "")
    >>> over, points, between = planned_points(
    ...     model, design, Wish("level_1", "measurement", [4.0, 8.0]))
    >>> over, [point.place for point in points], len(between)
    ('level_1', [4.0, 8.0], 1)
    """
    outputs = scheduled.plain.setpoints
    if len(model.inputs) != len(model.outputs):
        raise NotApplicable(
            f"{len(model.inputs)} inputs for {len(model.outputs)} controlled outputs leave other "
            "operating points open"
        )
    if wish.over is not None:
        check_choice("over", wish.over, outputs)
    if wish.points is not None:
        along = _Along(model, scheduled, wish.over or outputs[0])
        plan = [along.needed_at(place) for place in along.checked(wish.points)]
        return along.over, plan, along.between(plan)
    candidates = (wish.over,) if wish.over is not None else outputs
    kinds = scheduled.kinds
    changes = [
        (largest_change(plan, {name: kinds[name] for name in plan[0].values}), along, plan)
        for along in (_Along(model, scheduled, over) for over in candidates)
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
    halfway = [along.needed_at(0.5 * (low.place + high.place)) for low, high in pairs]
    plan = sorted([*plan, *halfway], key=lambda point: point.place)
    between = along.between(plan)
    while max(between) > SENSITIVITY_LIMIT * _CLOSE and len(plan) < _MOST:
        worst = int(np.argmax(between))
        place = 0.5 * (plan[worst].place + plan[worst + 1].place)
        plan.insert(worst + 1, along.needed_at(place))
        between = along.between(plan)
    return along.over, plan, between


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


def peaks_elsewhere(
    model: LinearModel, scheduled: ScheduledDesign, over: str, plan: Sequence[PlannedPoint]
) -> list[str]:
    """Return what the peak is where another controlled output is halfway to an end of its range.

    Parameters
    ----------
    over : str
        What is scheduled over.

    Returns
    -------
    list of str
        A sentence for each such point that is an equilibrium.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.lqi import design_lqi
    >>> model = cl.load("averaging-tank").linear
    >>> design = ScheduledDesign(design_lqi(model), lambda place: {}, "LQI", "")
    >>> peaks_elsewhere(model, design, "volume", [PlannedPoint(2.0, {}, 1.0)])[0].split(", ")
    ['With concentration at 2.5 kmol/m^3', 'over which nothing is scheduled', \
'the sensitivity peak is 1.04.']
    """
    point = operating_point_of(model)
    at, notes = point.as_dict(), []
    values = {
        name: float(
            np.interp(at[over], [each.place for each in plan], [each.values[name] for each in plan])
        )
        for name in plan[0].values
    }
    for name in scheduled.plain.setpoints:
        signal = point.process.signal(name)
        if name == over or not math.isfinite(signal.span):
            continue
        for end in (signal.low, signal.high):
            place = 0.5 * (at[name] + end)
            try:
                peak = scheduled.peak(model_at(model, {name: place}), values)
            except ClepsydraError:
                continue
            text = f"{peak:.2f}" if math.isfinite(peak) else "infinite: the loop is unstable"
            notes.append(
                f"With {name} at {in_shown_unit(signal, place)}, over which nothing is scheduled, "
                f"the sensitivity peak is {text}."
            )
    return notes


def largest_change(plan: Sequence[PlannedPoint], kinds: Mapping[str, str]) -> float:
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
    largest, alike = 0.0, dict[str, float]()
    numbers = {name: [point.values[name] for point in plan] for name in kinds}
    sizes = {name: max(map(abs, found)) for name, found in numbers.items()}
    for name, kind in kinds.items():
        alike[kind] = max(alike.get(kind, 0.0), sizes[name])
    for name, kind in kinds.items():
        if sizes[name] != 0.0 and sizes[name] >= 0.05 * alike[kind]:
            span = max(numbers[name]) - min(numbers[name])
            largest = max(largest, span / sizes[name])
    return largest


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
