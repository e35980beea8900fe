"""Gain scheduling: a design at each of several operating points, interpolated between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from clepsydra.base.signal import path
from clepsydra.base.words import listed, time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.gain_scheduling import FAMILY, Schedule, scheduled_law, scheduled_lqi_law
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import word
from clepsydra.designs.arguments.of_process import OVER, POINTS
from clepsydra.designs.at_operating_point import controller_at
from clepsydra.designs.design import Studied, design
from clepsydra.designs.designed_values import kind
from clepsydra.designs.loops.closed_loop_time import TimedLoop
from clepsydra.designs.loops.law_settings import law_settings
from clepsydra.designs.loops.multiloop import Detuned, MultiloopPid, checked_form
from clepsydra.designs.loops.pairing import Pairing, checked_pairing
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.operating_plan import (
    Follows,
    PlannedPoint,
    ScheduledDesign,
    Wish,
    largest_change,
    peaks_elsewhere,
    planned_points,
)
from clepsydra.designs.request import in_shown_unit
from clepsydra.designs.simc import simc_loop
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_deviations
from clepsydra.designs.states.linear_quadratic import ANTI_WINDUP
from clepsydra.designs.states.relevant_states import without_idle_states
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.program.step_law import StepLaw

METHOD = "gain-scheduled SIMC"
#: The scheduling variable is filtered over this share of the shortest time that the gains act in.
_FILTER = 0.2

_SCHEDULE = (
    OVER,
    word("follows", "what of it the schedule follows", Follows),
    POINTS,
)


@design(
    "gain_scheduled_pid",
    "PI or PID whose gains follow the operating point",
    Studied(110, "PI, gain scheduling"),
    keys=_SCHEDULE,
    method=METHOD,
)
def design_gain_scheduled_pid(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    form: PidForm | None = None,
    over: str | None = None,
    follows: Follows = "measurement",
    points: Sequence[float] | None = None,
) -> Controller:
    """Design PI or PID controllers by SIMC at several operating points, and schedule them.

    The operating points are equilibria with one controlled measurement at different values and
    the others as they are. At each the loops have the closed-loop time constants of the
    operating point of the model, lengthened by one factor where their sampled loops would have a
    sensitivity peak above 2. Between the points the settings are interpolated linearly, and the
    peak is computed halfway between neighbours with the interpolated settings on the linear
    model there; where it is above 2 a point is added.

    Parameters
    ----------
    over : str, optional
        The controlled measurement over which settings are scheduled; if left out the one over
        whose range they change most, or with points given the first one.
    follows : {"measurement", "setpoint"}
        Whether the settings follow the measurement itself, filtered, or its setpoint.
    points : sequence of float, optional
        Values of that measurement [its unit]; over all of its range if left out.

    Raises
    ------
    NotApplicable
        SIMC does not apply, there are no other equilibria, or the settings hardly change.
    InputError
        The model has no operating point, a name is unknown, or the points are no 2 to 15 rising
        numbers within the range.

    References
    ----------
    S. Skogestad, Journal of Process Control 13(4), 2003, 291-309,
    doi 10.1016/S0959-1524(02)00062-8; W. J. Rugh and J. S. Shamma, Research on gain scheduling,
    Automatica 36(10), 2000, 1401-1425, doi 10.1016/S0005-1098(00)00058-3.

    Examples
    --------
    The time constant of the concentration is V/f, so that its gain rises with the volume:

    >>> import clepsydra as cl
    >>> analysis = cl.load("averaging-tank").analysis
    >>> controller = design_gain_scheduled_pid(
    ...     analysis.model, analysis.pairing, over="volume", points=[1.0, 2.0, 3.0])
    >>> from clepsydra.base.signal import elements
    >>> table = elements("concentration.proportional_gain.at", 3)
    >>> [round(controller.values[name], 3) for name in table]
    [1.0, 2.0, 3.0]
    """
    form, actions = checked_form(form)
    outputs, inputs = checked_pairing(pairing, model)
    pairs = list(zip(outputs, inputs, strict=True))
    chosen = form

    def loops_at(place: LinearModel) -> MultiloopPid:
        return MultiloopPid(place, pairs, chosen, METHOD)

    together = loops_at(model)
    delay = together.process.sampling_period / 2.0

    def timed(place: MultiloopPid) -> list[TimedLoop]:
        return [simc_loop(loop, delay, actions) for loop in place.loops]

    shortest = [loop.shortest for loop in timed(together)]

    def detuned(place: MultiloopPid, times: Sequence[float]) -> Detuned:
        loops = list(zip(timed(place), times, strict=True))
        return place.slowed_down(
            lambda factor: [loop.settings_at(factor * time) for loop, time in loops]
        )

    found = detuned(together, shortest)
    times = [found.factor * time for time in shortest]
    plain = together.controller(found, "SIMC (Skogestad 2003)", [])

    def values_at(place: LinearModel) -> dict[str, float]:
        settings = detuned(loops_at(place), times).design
        found = {
            path(output, name): value
            for output, setting in zip(outputs, settings, strict=True)
            for name, value in law_settings(setting, chosen).items()
        }
        return {name: value for name, value in found.items() if name in plain.values}

    words = "; ".join(
        f"{loop.pair}: closed-loop time constant {time_text(time)}"
        for loop, time in zip(together.loops, times, strict=True)
    )
    return _designed(
        model,
        ScheduledDesign(plain, values_at, f"{actions}, gain scheduling", words),
        lambda schedule, names: scheduled_law(plain.law, schedule, names),
        Wish(over, follows, points),
    )


@design(
    "gain_scheduled_lqi",
    "LQI whose gains follow the operating point",
    Studied(190, "LQI, gain scheduling"),
    keys=(*DEVIATIONS, ANTI_WINDUP, *_SCHEDULE),
    method="gain-scheduled LQI",
)
def design_gain_scheduled_lqi(
    model: LinearModel,
    *,
    maximum_errors: Mapping[str, float] | None = None,
    maximum_moves: Mapping[str, float] | None = None,
    anti_windup: AntiWindup = "back_calculation",
    over: str | None = None,
    follows: Follows = "measurement",
    points: Sequence[float] | None = None,
) -> Controller:
    """Design LQI by Bryson's rule at several operating points, and schedule the gains.

    The largest acceptable errors and moves are the same at all points, those of the operating
    point of the model; the rest is as for `design_gain_scheduled_pid`.

    Parameters
    ----------
    maximum_errors, maximum_moves, anti_windup
        As for `designs.lqi.design_lqi`.
    over, follows, points
        As for `design_gain_scheduled_pid`.

    Raises
    ------
    NotApplicable
        LQI does not apply, there are no other equilibria, or the gains hardly change.
    InputError
        The model has no operating point, a name is unknown, a deviation is not above zero, or
        the points are no 2 to 15 rising numbers within the range.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000,
    1401-1425, doi 10.1016/S0005-1098(00)00058-3.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> controller = design_gain_scheduled_lqi(model, over="level_1", points=[4.0, 8.0])
    >>> from clepsydra.base.signal import elements
    >>> [controller.values[name] for name in elements("schedule.point", 2)]
    [4.0, 8.0]
    """
    plain = design_lqi(
        model,
        maximum_errors=maximum_errors,
        maximum_moves=maximum_moves,
        anti_windup=anti_windup,
    )
    relevant = without_idle_states(model)
    asked = acceptable_deviations(relevant, maximum_errors, maximum_moves)
    process = operating_point_of(model).process

    def values_at(place: LinearModel) -> dict[str, float]:
        found = design_lqi(
            place,
            maximum_errors=asked.errors,
            maximum_moves=asked.moves,
            anti_windup=anti_windup,
        )
        if found.measurements != plain.measurements:
            raise NotApplicable("other states act on the outputs at other points")
        kinds = {p.name: kind(p) for p in found.law.parameters}
        scheduled = ("feedback", "integral_gain", "tracking_time")
        return {name: value for name, value in found.values.items() if kinds[name] in scheduled}

    def law(schedule: Schedule, names: Sequence[str]) -> StepLaw:
        return scheduled_lqi_law(
            [process.signal(name) for name in plain.measurements],
            [process.signal(name) for name in plain.manipulated],
            plain.setpoints,
            schedule,
            anti_windup,
        )

    return _designed(
        model,
        ScheduledDesign(
            plain, values_at, "LQI, gain scheduling",
            f"Bryson's weights, {asked.in_words(process)}",
        ),
        law,
        Wish(over, follows, points),
        every=True,
    )  # fmt: skip


def _designed(
    model: LinearModel,
    scheduled: ScheduledDesign,
    law_of: Callable[[Schedule, Sequence[str]], StepLaw],
    wish: Wish,
    *,
    every: bool = False,
) -> Controller:
    """Return the scheduled controller at rest at the operating point.

    Parameters
    ----------
    every : bool
        Whether parameters that are the same everywhere have tables too.
    """
    plain, process = scheduled.plain, operating_point_of(model).process
    over, plan, between = planned_points(model, scheduled, wish)
    signal = process.signal(over)
    followed = path(over, "pv" if wish.follows == "measurement" else "sp")
    schedule = Schedule(followed, signal, len(plan))
    names = [name for name in plan[0].values if every or largest_change(plan, {name: name}) > 1e-9]
    law = law_of(schedule, names)
    fixed = {p.name for p in law.parameters}
    values = {name: value for name, value in plain.values.items() if name in fixed}
    values |= zip(schedule.places, (point.place for point in plan), strict=True)
    for name in names:
        values |= zip(schedule.values(name), (point.values[name] for point in plan), strict=True)
    kinds = scheduled.kinds
    values["schedule.filter_time"] = _filter_time(plan, kinds, process.sampling_period)
    peaks = ", ".join(f"{point.peak:.2f} at {in_shown_unit(signal, point.place)}" for point in plan)
    highest = max(between, default=max(point.peak for point in plan))
    return controller_at(
        operating_point_of(model),
        scheduled.name,
        FAMILY,
        law,
        values,
        structure=max(plain.structure, Complexity.ADVANCED_LOOPS),
        design=(
            f"{scheduled.words}; designed at {len(plan)} operating points of {over} and "
            f"interpolated linearly over {'its setpoint' if wish.follows == 'setpoint' else 'it'}; "
            f"sensitivity peaks {peaks}, halfway between neighbours at most {highest:.2f}."
        ),
        notes=(
            f"{_listed([kinds[name] for name in names])} follow {over} by tables; a change of "
            "them alone moves no output.",
            *peaks_elsewhere(model, scheduled, over, plan),
        ),
        slowed=plain.slowed,
    )


def _filter_time(plan: Sequence[PlannedPoint], kinds: Mapping[str, str], period: float) -> float:
    times = [
        value
        for point in plan
        for name, value in point.values.items()
        if kinds[name] in ("integral_time", "tracking_time")
    ]
    return max(period, _FILTER * min(times, default=10.0 * period / _FILTER))


def _listed(kinds: Sequence[str]) -> str:
    found = list(dict.fromkeys(kind.replace("_", " ") for kind in kinds))
    words = f"{found[0]}s" if len(found) == 1 else listed(found)
    return words[0].upper() + words[1:]
