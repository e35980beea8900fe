"""Gain scheduling: a law whose parameters follow a scheduling variable by tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup
from clepsydra.controllers.blocks.schedule import Schedule
from clepsydra.controllers.blocks.varying_gains import Feedback, varying_lqi
from clepsydra.controllers.inner_law import inner_equations
from clepsydra.controllers.linear_quadratic_integral import check_lqi_anti_windup
from clepsydra.controllers.state_reading import StateSignals
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "gain scheduling"


def scheduled_law(law: StepLaw, schedule: Schedule, names: Sequence[str]) -> StepLaw:
    """Return a law with some of its parameters replaced by tables over a scheduling variable.

    A table holds the values of parameter K at the points of the schedule, K.at.1, K.at.2, …; the
    law computes with the value interpolated in each sample. The law itself must bear a change
    of these parameters without a bump, as a multiloop PID does: its integral stands behind the
    gain and takes a change of it up.

    Parameters
    ----------
    law : StepLaw
    schedule : Schedule
    names : sequence of str
        The parameters that are scheduled.

    Returns
    -------
    StepLaw
        Its other parameters, the points and filter_time [s] of the schedule, and the tables;
        its state and variable of the schedule.

    Raises
    ------
    InputError
        A parameter or the scheduling input is none of the law's.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000,
    1401-1425, doi 10.1016/S0005-1098(00)00058-3.

    Examples
    --------
    Halfway between two points the gain is halfway, and the output the one that it was:

    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> schedule = Schedule("level.pv", Signal("level", "V"), 2)
    >>> plain = multiloop_pid_law(["level"], ["pump"])
    >>> law = scheduled_law(plain, schedule, ["level.proportional_gain"])
    >>> [entry.name for entry in law.state][-2:]
    ['pump.last_output', 'schedule.variable']
    """
    known = {parameter.name: parameter for parameter in law.parameters}
    unknown = [name for name in names if name not in known]
    if unknown or not names:
        raise InputError(
            "schedule, parameters",
            ", ".join(unknown) or "none",
            f"some of {', '.join(known)}",
            "correct the names",
        )
    if schedule.variable not in [signal.name for signal in law.inputs]:
        raise InputError(
            "schedule, variable", schedule.variable, "an input of the law", "correct the name"
        )

    def equations(symbols: Symbols) -> Equations:
        at = schedule.followed(symbols)
        found = schedule.interpolated(symbols, at.outputs["followed"], names)
        inner = inner_equations(law, {**symbols, **found})
        scheduled = {path(name, "used"): value for name, value in found.items()}
        return Equations(
            {**inner.next_state, **at.next_state},
            inner.outputs,
            {**scheduled, **inner.intermediates},
        )

    return step_law(
        f"scheduled_{law.name}",
        inputs=law.inputs,
        parameters=[
            *schedule.parameters(),
            *(
                each
                for parameter in law.parameters
                for each in (schedule.table(parameter) if parameter.name in names else [parameter])
            ),
        ],
        state=[*law.state, *schedule.state()],
        outputs=law.outputs,
        equations=equations,
        description=(*law.description, _words(schedule)),
    )


def scheduled_lqi_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    controlled: Sequence[str],
    schedule: Schedule,
    anti_windup: AntiWindup = "back_calculation",
) -> StepLaw:
    """Write the step law of LQI whose gains F and G follow a scheduling variable by tables.

    As `linear_quadratic_integral.lqi_law` without an observer; the integral takes up what a
    change of F makes (`blocks.varying_gains`).

    Parameters
    ----------
    measured, manipulated : sequence of Signal or str
        The measurements show the whole state.
    controlled : sequence of str
        The measurements that have setpoints.
    schedule : Schedule
    anti_windup : {"back_calculation", "conditional_integration", "none"}

    Returns
    -------
    StepLaw
        Parameters as for `lqi_law`, with tables in the place of feedback, integral_gain and
        tracking_time of each output; state integral and last_output of each output, variable of
        the schedule, and feedback, the gains of the last sample.

    Raises
    ------
    InputError
        A setpoint belongs to no measurement, or the anti-windup is unknown or clamping.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000,
    1401-1425, doi 10.1016/S0005-1098(00)00058-3.

    Examples
    --------
    >>> level, pump = Signal("level_1", "V"), Signal("pump_1", "V")
    >>> law = scheduled_lqi_law([level], [pump], ["level_1"], Schedule("level_1.sp", level, 2))
    >>> [entry.name for entry in law.state][2:]
    ['schedule.variable', 'pump_1.feedback.level_1']
    """
    check_lqi_anti_windup(anti_windup)
    state = StateSignals.of(measured, manipulated, controlled, None, "scheduled LQI law")
    rows = [state.feedback_parameters(u) for u in state.manipulated]
    integral_rows = [state.integral_parameters(u) for u in state.manipulated]
    scheduled = [gain for row in rows for gain in row]
    kept = [
        replace(gain, description=f"{gain.description} in the last sample") for gain in scheduled
    ]
    others = state.reference_parameters()
    for u, row in zip(state.manipulated, integral_rows, strict=True):
        scheduled += row
        if anti_windup == "back_calculation":
            scheduled.append(signals.tracking_time(u))
        others += [signals.at_rest(u, "bias"), *signals.limit_parameters(u)]
    names = [parameter.name for parameter in scheduled]

    def equations(symbols: Symbols) -> Equations:
        at = schedule.followed(symbols)
        found = schedule.interpolated(symbols, at.outputs["followed"], names)
        reading = state.read(symbols)
        known = ca.logic_and(reading.signals_are_numbers, reading.sensors_are_good)
        # The gains change with what is known, so that the integral can take the change up.
        now = {k.name: ca.if_else(known, found[k.name], symbols[k.name]) for k in kept}
        stages, named = varying_lqi(
            {**symbols, **found},
            state.manipulated,
            Feedback(
                reading.state, reading.errors, reading.signals_are_numbers, reading.sensors_are_good
            ),
            [[now[gain.name] for gain in row] for row in rows],
            [[symbols[gain.name] for gain in row] for row in rows],
            [[found[gain.name] for gain in row] for row in integral_rows],
            anti_windup,
        )
        used = {path(name, "used"): value for name, value in found.items()}
        ended = state.equations(symbols, reading, stages, used | named)
        return Equations(
            {**ended.next_state, **now, **at.next_state},
            ended.outputs,
            ended.intermediates,
        )

    return step_law(
        "scheduled_lqi",
        inputs=state.inputs(),
        parameters=[
            *schedule.parameters(),
            *others,
            *(each for parameter in scheduled for each in schedule.table(parameter)),
        ],
        state=[*state.states(), *schedule.state(), *kept],
        outputs=state.outputs(),
        equations=equations,
        description=(f"Anti-windup: {IN_WORDS[anti_windup]}.", _words(schedule)),
    )


def _words(schedule: Schedule) -> str:
    return (
        f"Gain scheduling: parameters by tables of {schedule.points} points over "
        f"{schedule.shown}, filtered."
    )
