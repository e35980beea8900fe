"""Gain scheduling: a law whose parameters follow a scheduling variable by tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
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

    A table holds the values of parameter K at the points of the schedule, K_at_1, K_at_2, …; the
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
        Its other parameters, schedule_point_k, schedule_filter_time [s] and the tables; its
        state and scheduling_variable.

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
    >>> schedule = Schedule("measurement_1", Signal("level_1", "V"), 2)
    >>> law = scheduled_law(multiloop_pid_law(1), schedule, ["proportional_gain_1"])
    >>> [entry.name for entry in law.state][-2:]
    ['last_output_1', 'scheduling_variable']
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
        scheduled = {f"{name}_used": value for name, value in found.items()}
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
    measured: Sequence[Signal],
    manipulated: Sequence[Signal],
    controlled: Sequence[int],
    schedule: Schedule,
    anti_windup: AntiWindup = "back_calculation",
) -> StepLaw:
    """Write the step law of LQI whose gains F and G follow a scheduling variable by tables.

    As `linear_quadratic_integral.lqi_law` without an observer; the integral takes up what a
    change of F makes (`blocks.varying_gains`).

    Parameters
    ----------
    measured, manipulated : sequence of Signal
        The measurements show the whole state.
    controlled : sequence of int
        For setpoint_1, setpoint_2, … the number (from 1) of its measurement.
    schedule : Schedule
    anti_windup : {"back_calculation", "conditional_integration", "none"}

    Returns
    -------
    StepLaw
        Parameters as for `lqi_law`, with tables in the place of feedback_i_j, integral_gain_i_j
        and tracking_time_i; state integral_i, last_output_i, scheduling_variable and
        feedback_i_j, the gains of the last sample.

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
    >>> law = scheduled_lqi_law([level], [pump], [1], Schedule("setpoint_1", level, 2))
    >>> [entry.name for entry in law.state]
    ['integral_1', 'last_output_1', 'scheduling_variable', 'feedback_1_1']
    """
    check_lqi_anti_windup(anti_windup)
    state = StateSignals(tuple(measured), tuple(manipulated), tuple(controlled))
    rows = range(1, len(manipulated) + 1)
    columns, errors = range(1, len(measured) + 1), range(1, len(controlled) + 1)
    fed_back = [signal for i in rows for signal in state.feedback_parameters(i)[:-1]]
    scheduled = list(fed_back)
    for i, output in enumerate(manipulated, start=1):
        for j, number in enumerate(controlled, start=1):
            shown = measured[number - 1]
            unit = signals.ratio_of_units(output.unit, shown.unit, "s")
            words = f"integral gain from the error of {shown.name} to {output.name}"
            scheduled.append(signals.gain(f"integral_gain_{i}_{j}", unit, 0.0, words))
        if anti_windup == "back_calculation":
            scheduled.append(signals.tracking_time(i))
    names = [parameter.name for parameter in scheduled]
    others = [*state.reference_parameters()]
    for i, output in enumerate(manipulated, start=1):
        others += [state.feedback_parameters(i)[-1], *signals.limit_parameters(i, output)]
    kept = [
        replace(gain, description=f"{gain.description} in the last sample") for gain in fed_back
    ]

    def equations(symbols: Symbols) -> Equations:
        at = schedule.followed(symbols)
        found = schedule.interpolated(symbols, at.outputs["followed"], names)
        reading = state.read(symbols)
        known = ca.logic_and(reading.signals_are_numbers, reading.sensors_are_good)
        # The gains change with what is known, so that the integral can take the change up.
        now = [
            [
                ca.if_else(known, found[f"feedback_{i}_{j}"], symbols[f"feedback_{i}_{j}"])
                for j in columns
            ]
            for i in rows
        ]
        deviations = [
            setpoint - reading.measurements[number - 1]
            for setpoint, number in zip(reading.setpoints, controlled, strict=True)
        ]
        stages, named = varying_lqi(
            {**symbols, **found},
            manipulated,
            Feedback(
                reading.state, deviations, reading.signals_are_numbers, reading.sensors_are_good
            ),
            now,
            [[symbols[f"feedback_{i}_{j}"] for j in columns] for i in rows],
            [[found[f"integral_gain_{i}_{j}"] for j in errors] for i in rows],
            anti_windup,
        )
        used = {f"{name}_used": value for name, value in found.items()}
        ended = state.equations(symbols, reading, stages, used | named)
        following = {f"feedback_{i}_{j}": now[i - 1][j - 1] for i in rows for j in columns}
        return Equations(
            {**ended.next_state, **following, **at.next_state},
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
