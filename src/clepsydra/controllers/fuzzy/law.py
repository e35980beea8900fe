"""The step law of a Mamdani controller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.derivative import filtered_derivative
from clepsydra.controllers.blocks.error_shape import gap_error
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.integral import next_integral
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step, value_or_zero
from clepsydra.controllers.control_law import control_law
from clepsydra.controllers.fuzzy.inference import surface
from clepsydra.controllers.fuzzy.kinds import FuzzyInput, FuzzyOutput
from clepsydra.controllers.fuzzy.system import FuzzySystem
from clepsydra.program.step_law import StepLaw

FAMILY = "fuzzy"


def fuzzy_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    system: FuzzySystem,
    inputs: Sequence[FuzzyInput],
    outputs: Sequence[FuzzyOutput],
    *,
    name: str = "fuzzy",
) -> StepLaw:
    """Write the step law of a Mamdani controller.

    A linguistic input is x = k D(q): q the error r − y, the measurement y or the derivative of
    one of them, D a dead zone, k its gain; the range of its variable clips it. With the centroid
    c of a linguistic output, in automatic::

        u = min(high limit, max(low limit, g c + b))      position
        u = min(high limit, max(low limit, u + Δt g c))      increment, u from the last sample

    and no faster than the rate limit. A position has no integral action. Its b makes a change of
    mode bumpless and fades, b⁺ = b − min(Δt/Tf, 1) b, but not further into saturation. An
    increment moves on from what was applied, in every mode, so it neither bumps nor winds up.

    Where no rule fires the output is held. A fault of a sensor, or a value that is no number,
    holds the outputs whose rules read it; the others go on.

    Parameters
    ----------
    measured, manipulated : sequence of Signal or str
        The process signals, a manipulated one for each output of the system: they lend their
        names, units and ranges.
    system : FuzzySystem
    inputs : sequence of FuzzyInput
        One for each input of the system.
    outputs : sequence of FuzzyOutput
        One for each output of the system.
    name : str
        An identifier.

    Returns
    -------
    StepLaw
        Inputs sp of each measurement whose error is used, pv and good of each measurement, mode,
        manual and tracking of each output, and time_step [s]; parameters gain, dead_zone and, of
        a rate, filter_time [s] of each linguistic input, output_gain, fading_time [s] of a
        position, low_limit, high_limit and rate_limit of each output; state filtered of a rate,
        offset of a position, and last_output; outputs out and status of each output.

    Raises
    ------
    InputError
        There is not one description for each variable, or one signal for each output, or a
        measurement is not there.

    References
    ----------
    E. H. Mamdani, Application of fuzzy algorithms for control of simple dynamic plant,
    Proceedings of the IEE 121(12), 1974, 1585-1588, doi 10.1049/piee.1974.0328.

    Examples
    --------
    Two rules on the error of a level; in the middle both fire by a half:

    >>> from clepsydra.controllers.fuzzy.membership import left_shoulder, right_shoulder
    >>> from clepsydra.controllers.fuzzy.rule import parse_rule
    >>> from clepsydra.controllers.fuzzy.system import LinguisticVariable
    >>> halves = {"N": left_shoulder(-1.0, 1.0), "P": right_shoulder(-1.0, 1.0)}
    >>> error = LinguisticVariable("e", -1.0, 1.0, halves)
    >>> opening = LinguisticVariable("u", 0.0, 10.0, halves | {"P": right_shoulder(0.0, 10.0)})
    >>> rules = [parse_rule(s, f"if e is {s} then u is {s}") for s in halves]
    >>> law = fuzzy_law(
    ...     ["level"], ["pump"], FuzzySystem((error,), (opening,), tuple(rules)),
    ...     [FuzzyInput("error", "level")], [FuzzyOutput()])
    >>> [parameter.name for parameter in law.parameters][:4]
    ['e.gain', 'e.dead_zone', 'pump.output_gain', 'pump.fading_time']
    """
    known = signals.process_signals(measured, "fuzzy law, measured")
    moved = signals.process_signals(manipulated, "fuzzy law, manipulated")
    by_name = {signal.name: signal for signal in known}
    _check(system, inputs, outputs, by_name, moved)
    read = [
        (each, variable.name, by_name[each.measurement])
        for each, variable in zip(inputs, system.inputs, strict=True)
    ]
    followed = {each.measurement for each in inputs if each.is_of_error}
    written = list(zip(outputs, moved, strict=True))

    def equations(sample: Sample) -> None:
        good = is_time_step(sample["time_step"])
        sample.named["time_step_good"] = good
        time_step = ca.if_else(good, sample["time_step"], 1)
        crisp = {name: _crisp(sample, each, name, time_step, good) for each, name, _ in read}
        values, fires = surface(system)(ca.vertcat(*(found.value for found in crisp.values())))
        for j, (output, u) in enumerate(written):
            name = system.outputs[j].name
            used = [crisp[variable.name] for variable in system.used_by(name)]
            sample.name(name, {"centroid": values[j]})
            wish = sample[path(u, "output_gain")] * values[j]
            _move(sample, output, u, wish, fires[j], used, time_step)

    return control_law(
        name,
        equations,
        measured=known,
        controlled=[y for y in known if y.name in followed],
        manipulated=moved,
        parameters=[
            *(signal for each, name, y in read for signal in each.parameters(name, y)),
            *(signal for output, u in written for signal in output.parameters(u)),
        ],
        state=[
            *(signal for each, name, y in read for signal in each.state(name, y)),
            *(signal for output, u in written for signal in output.state(u)),
            *map(signals.last_output, moved),
        ],
        description=tuple(f"{rule.name}: {rule}" for rule in system.rules),
    )


def _check(
    system: FuzzySystem,
    inputs: Sequence[FuzzyInput],
    outputs: Sequence[FuzzyOutput],
    measured: Mapping[str, Signal],
    manipulated: Sequence[Signal],
) -> None:
    for what, given, wanted in (
        ("inputs", inputs, system.inputs),
        ("outputs", outputs, system.outputs),
        ("manipulated", manipulated, system.outputs),
    ):
        if len(given) != len(wanted):
            raise InputError(
                f"fuzzy law, {what}", len(given), f"{len(wanted)}, one for each of the system",
                "give one for each",
            )  # fmt: skip
    for each in inputs:
        if each.measurement not in measured:
            raise InputError(
                "fuzzy law, inputs", each.measurement,
                f"a measurement ({', '.join(measured)})", "correct it",
            )  # fmt: skip


class _Crisp(NamedTuple):
    """The value of a linguistic input, and whether it may be used."""

    value: ca.SX
    numbers: ca.SX
    sensor: ca.SX


def _crisp(
    sample: Sample, each: FuzzyInput, name: str, time_step: ca.SX, time_step_good: ca.SX
) -> _Crisp:
    """Read a linguistic input: zero, and not to be used, where it is no number."""
    shown = sample.of(each.measurement, "pv", *(["sp"] if each.is_of_error else []))
    valid = all_of([is_number(value) for value in shown])
    value, *setpoint = (value_or_zero(value, valid) for value in shown)
    if setpoint:
        value = setpoint[0] - value
    sensor = sample[path(each.measurement, "good")]
    if each.is_rate:
        kept, filter_time = sample.of(name, "filtered", "filter_time")
        value, filtered = filtered_derivative(value, kept, filter_time, time_step)
        sound = all_of([valid, sensor, time_step_good, is_number(filtered)])
        sample.next_state[path(name, "filtered")] = ca.if_else(sound, filtered, kept)
        sample.name(name, {"rate": value})
    gain, width = sample.of(name, "gain", "dead_zone")
    scaled = gain * gap_error(value, width, ca.SX(0))
    # Met where a parameter was changed to something unusable at run time, too.
    numbers = ca.logic_and(valid, is_number(scaled))
    scaled = value_or_zero(scaled, numbers)
    sample.name(name, {"scaled": scaled})
    return _Crisp(scaled, numbers, sensor)


def _move(
    sample: Sample, output: FuzzyOutput, moved: Signal, wish: ca.SX, fires: ca.SX,
    used: Sequence[_Crisp], time_step: ca.SX,
) -> None:  # fmt: skip
    """Write an output, and the next offset of a position."""
    last = sample[path(moved, "last_output")]
    offset = sample[path(moved, "offset")] if output.is_position else None
    asked = last + time_step * wish if offset is None else wish + offset
    numbers = all_of([crisp.numbers for crisp in used])
    sensors = all_of([crisp.sensor for crisp in used])
    usable = all_of([numbers, sensors, fires])
    wanted = Asked(asked, usable, numbers, sensors)
    applied = final_element(sample, moved, wanted, rate_limited=output.rate_limited)
    if offset is not None:
        share = tracking_share(time_step, sample[path(moved, "fading_time")])
        fading = {"integral_used": offset, "proportional": wish, "increment": -share * offset}
        sample.next_state[path(moved, "offset")], _ = next_integral(
            "conditional_integration", fading, applied, known=usable, last_applied=last
        )
