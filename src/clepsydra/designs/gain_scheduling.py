"""Gain scheduling: a design at each of several operating points, interpolated between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from clepsydra.base.errors import InputError
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
from clepsydra.designs.loops.multiloop import Detuned, MultiloopPid, checked_form, law_settings
from clepsydra.designs.loops.pairing import Pairing, checked_pairing
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.words import by_pair
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.operating_plan import (
    Along,
    Follows,
    Plan,
    largest_change,
    planned_points,
)
from clepsydra.designs.request import in_shown_unit
from clepsydra.designs.simc import simc_loop
from clepsydra.designs.states.bryson_rule import DEVIATIONS, acceptable_deviations
from clepsydra.designs.states.linear_quadratic import ANTI_WINDUP
from clepsydra.designs.states.measured_states import without_idle_states
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.program.step_law import StepLaw

METHOD = "gain-scheduled SIMC"
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
    pairs, chosen = list(zip(outputs, inputs, strict=True)), form

    def found_at(
        place: LinearModel, times: Sequence[float] | None = None
    ) -> tuple[MultiloopPid, Detuned, list[float]]:
        together = MultiloopPid(place, pairs, chosen, METHOD)
        loops = together.each(lambda loop: simc_loop(loop, together.delay, actions))

        def settings_at(times: Sequence[float]) -> list[PidSettings]:
            return [loop.settings_at(time) for loop, time in zip(loops, times, strict=True)]

        shortest = times or [loop.shortest for loop in loops]
        return together, *together.timed(settings_at, shortest, None)

    together, found, times = found_at(model)
    plain = together.controller(found, "SIMC (Skogestad 2003)", [])

    def values_at(place: LinearModel) -> dict[str, float]:
        _, found, _ = found_at(place, times)
        return {
            name: value
            for output, setting in zip(outputs, found.design, strict=True)
            for part, value in law_settings(setting, chosen).items()
            if (name := path(output, part)) in plain.values
        }

    constants = (f"closed-loop time constant {time_text(time)}" for time in times)
    words = by_pair(together.loops, constants)
    return _scheduled(
        planned_points(model, plain, values_at, over, points),
        f"{actions}, gain scheduling",
        words,
        lambda schedule, names: scheduled_law(plain.law, schedule, names),
        follows,
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

    return _scheduled(
        planned_points(model, plain, values_at, over, points),
        "LQI, gain scheduling",
        f"Bryson's weights, {asked.in_words(process)}",
        law,
        follows,
        every=True,
    )


def _scheduled(
    planned: tuple[Along, Plan, list[float]],
    name: str,
    words: str,
    law_of: Callable[[Schedule, Sequence[str]], StepLaw],
    follows: Follows,
    *,
    every: bool = False,
) -> Controller:
    """Return the scheduled controller at rest at the operating point.

    `law_of` makes the law of a schedule and the names of the parameters that follow it: those
    that change, or every one that was designed at the points.
    """
    along, plan, between = planned
    over, plain, signal, kinds = along.over, along.plain, along.signal, along.kinds
    schedule = Schedule(path(over, "pv" if follows == "measurement" else "sp"), signal, len(plan))
    names = [each for each in plan[0].values if every or largest_change(plan, {each: each}) > 1e-9]
    if not names:
        places = [point.place for point in plan]
        remedy = "choose others, or gains without a schedule"
        raise InputError("points", places, "points between which a gain changes", remedy)
    law = law_of(schedule, names)
    fixed = {p.name for p in law.parameters}
    values = {each: value for each, value in plain.values.items() if each in fixed}
    values |= zip(schedule.places, (point.place for point in plan), strict=True)
    for each in names:
        values |= zip(schedule.values(each), (point.values[each] for point in plan), strict=True)
    # The variable is filtered over a share of the shortest time that the gains act in.
    times = [
        value
        for point in plan
        for each, value in point.values.items()
        if kinds[each] in ("integral_time", "tracking_time")
    ]
    period = along.point.process.sampling_period
    shortest = min(times, default=10.0 * period / _FILTER)
    values["schedule.filter_time"] = max(period, _FILTER * shortest)
    peaks = ", ".join(f"{point.peak:.2f} at {in_shown_unit(signal, point.place)}" for point in plan)
    highest = max(between, default=max(point.peak for point in plan))
    said = list(dict.fromkeys(kinds[each].replace("_", " ") for each in names))
    gains = f"{said[0]}s" if len(said) == 1 else listed(said)
    return controller_at(
        along.point,
        name,
        FAMILY,
        law,
        values,
        structure=max(plain.structure, Complexity.ADVANCED_LOOPS),
        design=(
            f"{words}; designed at {len(plan)} operating points of {over} and interpolated "
            f"linearly over {'its setpoint' if follows == 'setpoint' else 'it'}; sensitivity peaks "
            f"{peaks}, halfway between neighbours at most {highest:.2f}."
        ),
        notes=(
            f"{gains[0].upper()}{gains[1:]} follow {over} by tables; a change of them alone moves "
            "no output.",
            *along.elsewhere(plan),
        ),
        slowed=plain.slowed,
    )
