"""Gain scheduling: a law whose parameters follow a scheduling variable by tables."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.schedule import Schedule
from clepsydra.controllers.inner_law import inner_equations
from clepsydra.controllers.linear_quadratic_integral import output_parameters, varying_lqi
from clepsydra.controllers.observers.linear_state import LinearState
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
    names : sequence of str
        The parameters that are scheduled.

    Returns
    -------
    StepLaw
        Its other parameters, the points and filter_time [s] of the schedule, and the tables;
        its state and variable of the schedule.

    Raises InputError: A parameter or the scheduling input is none of the law's.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000,
    1401-1425, doi 10.1016/S0005-1098(00)00058-3.
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
        sample = Sample(symbols)
        found = schedule.interpolated(sample, schedule.followed(sample), names)
        inner = inner_equations(law, {**symbols, **found})
        return Equations(
            {**inner.next_state, **sample.next_state},
            inner.outputs,
            {**sample.named, **inner.intermediates},
        )

    return step_law(
        f"scheduled_{law.name}",
        inputs=law.inputs,
        parameters=[
            *schedule.parameters(),
            *(p for p in law.parameters if p.name not in names),
            *schedule.tables(known[name] for name in names),
        ],
        state=[*law.state, *schedule.state()],
        outputs=law.outputs,
        equations=equations,
        description=(*law.description, schedule.words),
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
    change of F makes (`linear_quadratic_integral.varying_lqi`).

    Parameters
    ----------
    measured, manipulated : sequence of Signal or str
        The measurements show the whole state.
    controlled : sequence of str
        The measurements that have setpoints.

    Returns
    -------
    StepLaw
        Parameters as for `lqi_law`, with tables in the place of feedback, integral_gain and
        tracking_time of each output; state integral and last_output of each output, variable of
        the schedule, and feedback, the gains of the last sample.

    Raises InputError: A setpoint belongs to no measurement, or the anti-windup is unknown or
    clamping.

    References
    ----------
    W. J. Rugh and J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000,
    1401-1425, doi 10.1016/S0005-1098(00)00058-3.
    """
    state = LinearState(measured, manipulated, controlled, None, "scheduled LQI law")
    outputs = output_parameters(state.manipulated, anti_windup)
    scheduled = [*state.feedback.signals(), *state.integral_gain.signals()]
    scheduled += [each for each in outputs if each.part == "tracking_time"]
    kept = state.feedback.last()

    def gains(sample: Sample, reading: Reading, _: Sequence[ca.SX]) -> dict[str, ca.SX]:
        at = schedule.followed(sample)
        found = schedule.interpolated(sample, at, [parameter.name for parameter in scheduled])
        # The gains change with what is known, so that the integral can take the change up.
        known = ca.logic_and(reading.numbers, reading.sensors)
        for gain in kept:
            found[gain.name] = ca.if_else(known, found[gain.name], sample[gain.name])
            sample.next_state[gain.name] = found[gain.name]
        sample.symbols = {**found, **sample.symbols}
        return found

    plain = [each for each in outputs if each not in scheduled]
    tables = schedule.tables(scheduled)
    return varying_lqi(
        "scheduled_lqi",
        state,
        anti_windup,
        [*schedule.parameters(), *state.parameters(), *plain, *tables],
        state=[*schedule.state(), *kept],
        gains=gains,
        words=[schedule.words],
    )
