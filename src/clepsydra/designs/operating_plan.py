"""Operating points for a schedule: where, what is designed there, and the peaks between."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.controllers.blocks.schedule import FEWEST_POINTS, MOST_POINTS
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.designed_values import kind
from clepsydra.designs.loops.detuning import SENSITIVITY_LIMIT
from clepsydra.designs.request import in_shown_unit
from clepsydra.designs.sampled.sampled_loop import SampledLoops
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
    """A point of a schedule: where it is, the values designed there, and the peak of |S|.

    Examples
    --------
    >>> PlannedPoint(6.0, {"level.proportional_gain": 3.0}, 1.8).peak
    1.8
    """

    place: float
    values: dict[str, float]
    peak: float


class Wish(NamedTuple):
    """Over what a user wants parameters scheduled, following what, and at which values.

    Examples
    --------
    >>> Wish(None, "measurement", None).follows
    'measurement'
    """

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
    method, name, words : str
        Of the method, the controller and the design.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.bryson import design_lqi
    >>> plain = design_lqi(cl.load("quadruple-tank").linear)
    >>> ScheduledDesign(plain, lambda model: {}, "LQI", "LQI, gain scheduling", "").plain.setpoints
    ('level_1', 'level_2')
    """

    plain: Controller
    at: Callable[[LinearModel], dict[str, float]]
    method: str
    name: str
    words: str

    @property
    def kinds(self) -> dict[str, str]:
        """What each parameter is, the gains of one matrix being of one kind."""
        return {parameter.name: kind(parameter) for parameter in self.plain.law.parameters}


def planned_points(
    model: LinearModel, scheduled: ScheduledDesign, wish: Wish
) -> tuple[str, list[PlannedPoint], list[float]]:
    """Return over what is scheduled, its points, and the peaks halfway between them.

    Parameters
    ----------
    model : LinearModel
    scheduled : ScheduledDesign
    wish : Wish

    Raises
    ------
    NotApplicable
        There are no other operating points, or the parameters hardly change over them.
    InputError
        A name is unknown, or the points are no 2 to 15 rising numbers within the range.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.bryson import design_lqi
    >>> model = cl.load("quadruple-tank").linear
    >>> design = ScheduledDesign(
    ...     design_lqi(model), lambda place: design_lqi(place).values, "LQI", "LQI", "")
    >>> over, points, between = planned_points(
    ...     model, design, Wish("level_1", "measurement", [4.0, 8.0]))
    >>> over, [point.place for point in points], len(between)
    ('level_1', [4.0, 8.0], 1)
    """
    method, outputs = scheduled.method, scheduled.plain.setpoints
    if len(model.inputs) != len(model.outputs):
        raise NotApplicable(
            method,
            f"{len(model.inputs)} inputs for {len(model.outputs)} controlled outputs leave other "
            "operating points open",
        )
    if wish.over is not None and wish.over not in outputs:
        raise InputError(
            f"{method}, over", wish.over, f"one of {', '.join(outputs)}", "correct the name"
        )
    if wish.points is not None:
        over = wish.over or outputs[0]
        places = _checked_points(model, over, wish.points, method)
        plan = [_needed(model, scheduled, over, place) for place in places]
        return over, plan, _between(model, scheduled, over, plan)
    candidates = (wish.over,) if wish.over is not None else outputs
    best: tuple[float, str, list[PlannedPoint]] | None = None
    for over in candidates:
        ends = [_end(model, scheduled, over, high) for high in (False, True)]
        found = [point for point in ends if point is not None]
        rest = operating_point_of(model).as_dict()[over]
        values = scheduled.at(model)
        plan = sorted(
            [*found, PlannedPoint(rest, values, _peak(scheduled, model, values))],
            key=lambda point: point.place,
        )
        kinds = scheduled.kinds
        change = largest_change(values, plan, {name: kinds[name] for name in values})
        if len(plan) >= FEWEST_POINTS and (best is None or change > best[0]):
            best = change, over, plan
    if best is None:
        raise NotApplicable(
            method, f"there is no other operating point along {' or '.join(candidates)}"
        )
    change, over, plan = best
    if change < _LEAST_CHANGE:
        raise NotApplicable(
            method,
            f"its gains change by less than {100.0 * _LEAST_CHANGE:g} % over the range of "
            f"{' or '.join(candidates)}: fixed gains do as well",
        )
    for low, high in itertools.pairwise(plan):
        plan = [*plan, _needed(model, scheduled, over, 0.5 * (low.place + high.place))]
    plan = sorted(plan, key=lambda point: point.place)
    between = _between(model, scheduled, over, plan)
    while max(between) > SENSITIVITY_LIMIT * _CLOSE and len(plan) < _MOST:
        worst = int(np.argmax(between))
        place = 0.5 * (plan[worst].place + plan[worst + 1].place)
        plan.insert(worst + 1, _needed(model, scheduled, over, place))
        between = _between(model, scheduled, over, plan)
    return over, plan, between


def model_at(model: LinearModel, asked: Mapping[str, float]) -> LinearModel:
    """Return the linear model of a process where some controlled measurements are others.

    The other controlled measurements, the disturbances and the inputs that are left alone are
    those of the operating point of the model.

    Parameters
    ----------
    model : LinearModel
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
    model : LinearModel
    scheduled : ScheduledDesign
    over : str
        What is scheduled over.
    plan : sequence of PlannedPoint

    Returns
    -------
    list of str
        A sentence for each such point that is an equilibrium.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.bryson import design_lqi
    >>> model = cl.load("averaging-tank").linear
    >>> design = ScheduledDesign(design_lqi(model), lambda place: {}, "LQI", "LQI", "")
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
                peak = _peak(scheduled, model_at(model, {name: place}), values)
            except ClepsydraError:
                continue
            text = f"{peak:.2f}" if math.isfinite(peak) else "infinite: the loop is unstable"
            notes.append(
                f"With {name} at {in_shown_unit(signal, place)}, over which nothing is scheduled, "
                f"the sensitivity peak is {text}."
            )
    return notes


def largest_change(
    values: Mapping[str, float], plan: Sequence[PlannedPoint], kinds: Mapping[str, str]
) -> float:
    """Return the largest change of a value over the points, a share of its largest magnitude.

    Of gains of one kind, those near zero beside the others do not count.

    Parameters
    ----------
    values : mapping
        Values to compare with too.
    plan : sequence of PlannedPoint
    kinds : mapping
        Name to its kind, of those that count.

    Examples
    --------
    >>> plan = [PlannedPoint(1.0, {"gain": 4.0}, 1.5), PlannedPoint(2.0, {"gain": 5.0}, 1.5)]
    >>> largest_change({"gain": 4.5}, plan, {"gain": "gain"})
    0.2
    """
    largest = 0.0
    sizes = {name: max(abs(point.values[name]) for point in plan) for name in kinds}
    for name, own in kinds.items():
        alike = max(size for other, size in sizes.items() if kinds[other] == own)
        if sizes[name] < 0.05 * alike or sizes[name] == 0.0:
            continue
        numbers = [point.values[name] for point in plan] + [values[name]]
        largest = max(largest, (max(numbers) - min(numbers)) / sizes[name])
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


def _end(
    model: LinearModel, scheduled: ScheduledDesign, over: str, high: bool
) -> PlannedPoint | None:
    """Return the point nearest to an end of the range at which there is a design."""
    point = operating_point_of(model)
    signal, rest = point.process.signal(over), point.as_dict()[over]
    if not math.isfinite(signal.span):
        return None
    end = signal.high - _MARGIN * signal.span if high else signal.low + _MARGIN * signal.span
    if (end - rest) * (1.0 if high else -1.0) <= _MARGIN * signal.span:
        return None
    for way in _WAYS:
        place = rest + way * (end - rest)
        try:
            return _designed_at(model, scheduled, over, place)
        except ClepsydraError:
            continue
    return None


def _designed_at(
    model: LinearModel, scheduled: ScheduledDesign, over: str, place: float
) -> PlannedPoint:
    there = model_at(model, {over: place})
    values = scheduled.at(there)
    return PlannedPoint(place, values, _peak(scheduled, there, values))


def _needed(
    model: LinearModel, scheduled: ScheduledDesign, over: str, place: float
) -> PlannedPoint:
    """Return the design at a point without which there is no schedule."""
    try:
        return _designed_at(model, scheduled, over, place)
    except ClepsydraError as refusal:
        raise NotApplicable(scheduled.method, f"at {over} {place:g}: {refusal}") from None


def _between(
    model: LinearModel, scheduled: ScheduledDesign, over: str, plan: Sequence[PlannedPoint]
) -> list[float]:
    """Return the peaks halfway between neighbours, with interpolated settings."""
    found = []
    for low, high in itertools.pairwise(plan):
        there = model_at(model, {over: 0.5 * (low.place + high.place)})
        values = {name: 0.5 * (value + high.values[name]) for name, value in low.values.items()}
        found.append(_peak(scheduled, there, values))
    return found


def _peak(scheduled: ScheduledDesign, there: LinearModel, values: Mapping[str, float]) -> float:
    """Return the sensitivity peak of the plain controller with these values on a model."""
    plain = scheduled.plain
    seen = with_outputs(there, plain.measurements)
    return SampledLoops(plain, seen).at({**plain.values, **values}).maximum_sensitivity


def _checked_points(
    model: LinearModel, over: str, points: Sequence[float], method: str
) -> list[float]:
    signal = operating_point_of(model).process.signal(over)
    place = f"{method}, points"
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
