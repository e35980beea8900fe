"""The step law of a Mamdani controller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, owned, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.derivative import filtered_derivative
from clepsydra.controllers.blocks.error_shape import gap_error
from clepsydra.controllers.blocks.final_element import FinalElement, final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.integral import applied_ports, integral
from clepsydra.controllers.blocks.ports import as_parts
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step, value_or_zero
from clepsydra.controllers.fuzzy.inference import Centroid, surface
from clepsydra.controllers.fuzzy.kinds import FuzzyInput, FuzzyOutput, followed_measurements
from clepsydra.controllers.fuzzy.system import FuzzySystem
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "fuzzy"


class _Reading(NamedTuple):
    """A crisp input: its value, whether it may be used, and what is kept of it."""

    value: ca.SX
    numbers: ca.SX
    sensor: ca.SX
    state: dict[str, ca.SX]
    named: dict[str, ca.SX]


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
    writer = _Writer(system, tuple(inputs), tuple(outputs), by_name, moved)
    followed = [by_name[each] for each in followed_measurements(tuple(by_name), inputs)]
    return step_law(
        name,
        inputs=[
            *signals.setpoint_inputs(followed),
            *signals.measurement_inputs(known),
            *signals.output_inputs(moved),
        ],
        parameters=writer.parameters(),
        state=writer.state(),
        outputs=[signal for u in moved for signal in signals.output_signals(u)],
        equations=writer.equations,
        description=[f"{rule.name}: {rule}" for rule in system.rules],
    )


def _check(
    system: FuzzySystem,
    inputs: Sequence[FuzzyInput],
    outputs: Sequence[FuzzyOutput],
    measured: Mapping[str, Signal],
    manipulated: Sequence[Signal],
) -> None:
    for what, given, wanted in (
        ("inputs", len(inputs), len(system.inputs)),
        ("outputs", len(outputs), len(system.outputs)),
        ("manipulated", len(manipulated), len(system.outputs)),
    ):
        if given != wanted:
            raise InputError(
                f"fuzzy law, {what}", given, f"{wanted}, one for each of the system",
                "give one for each",
            )  # fmt: skip
    for each in inputs:
        if each.measurement not in measured:
            raise InputError(
                "fuzzy law, inputs", each.measurement,
                f"a measurement ({', '.join(measured)})", "correct it",
            )  # fmt: skip


@dataclass(frozen=True)
class _Writer:
    system: FuzzySystem
    inputs: tuple[FuzzyInput, ...]
    outputs: tuple[FuzzyOutput, ...]
    measured: Mapping[str, Signal]
    manipulated: tuple[Signal, ...]

    def parameters(self) -> list[Signal]:
        found: list[Signal] = []
        for each, variable in zip(self.inputs, self.system.inputs, strict=True):
            unit = self._unit(each)
            name = f"{variable.name}, {each.quantity.replace('_', ' ')} of {each.measurement}"
            own = [
                signals.gain("gain", signals.per(Signal(""), unit), 1.0, f"gain of {name}"),
                _not_negative("dead_zone", unit, f"half width of the dead zone of {name}"),
            ]
            if each.is_rate:
                words = f"time constant of the filter of {name}"
                own.append(_not_negative("filter_time", "s", words))
            found += owned(variable.name, own)
        for output, moved in zip(self.outputs, self.manipulated, strict=True):
            per = () if output.action == "position" else ("s",)
            unit = signals.per(moved, *per)
            name = path(moved, "output_gain")
            found.append(signals.gain(name, unit, 1.0, f"gain to {moved.name}"))
            if output.action == "position":
                words = f"time in which a bumpless start of {moved.name} fades"
                found.append(signals.duration(path(moved, "fading_time"), words))
            found += signals.limit_parameters(moved)
            if output.rate_limited:
                words = f"largest rate of change of {moved.name}"
                found.append(signals.largest_rate(path(moved, "rate_limit"), moved, words))
        return found

    def state(self) -> list[Signal]:
        filtered = [
            Signal(
                path(v.name, "filtered"),
                self.measured[each.measurement].unit,
                description=f"filtered {each.quantity.removesuffix('_rate')} behind {v.name}",
            )
            for each, v in zip(self.inputs, self.system.inputs, strict=True)
            if each.is_rate
        ]
        offsets = [
            Signal(path(u, "offset"), u.unit, description=f"what a bumpless start adds to {u.name}")
            for output, u in zip(self.outputs, self.manipulated, strict=True)
            if output.action == "position"
        ]
        return [*filtered, *offsets, *map(signals.last_output, self.manipulated)]

    def _unit(self, each: FuzzyInput) -> Signal:
        return signals.per(self.measured[each.measurement], *(["s"] if each.is_rate else []))

    def equations(self, symbols: Symbols) -> Equations:
        time_step_good = is_time_step(symbols["time_step"])
        time_step = ca.if_else(time_step_good, symbols["time_step"], 1)
        readings = {
            variable.name: _reading(symbols, variable.name, each, time_step, time_step_good)
            for each, variable in zip(self.inputs, self.system.inputs, strict=True)
        }
        values = {name: reading.value for name, reading in readings.items()}
        state: dict[str, ca.SX] = {}
        named: dict[str, ca.SX] = {"time_step_good": time_step_good}
        for name, reading in readings.items():
            state |= reading.state
            named |= reading.named | {path(name, "scaled"): reading.value}
        written: dict[str, ca.SX] = {}
        crisp, fires = surface(self.system)(ca.vertcat(*values.values()))
        for j, variable in enumerate(self.system.outputs):
            centroid, moved = Centroid(crisp[j], fires[j]), self.manipulated[j]
            read = [readings[v.name] for v in self.system.used_by(variable.name)]
            numbers = all_of([reading.numbers for reading in read])
            sensors = all_of([reading.sensor for reading in read])
            element = self._moved(symbols, j, centroid, numbers, sensors, time_step, state)
            state[path(moved, "last_output")] = element.manipulated
            written |= as_parts(moved, {"out": element.manipulated, "status": element.status})
            named |= element.named | {path(variable.name, "centroid"): centroid.value}
        return Equations(state, written, named)

    def _moved(
        self, symbols: Symbols, j: int, centroid: Centroid, numbers: ca.SX, sensors: ca.SX,
        time_step: ca.SX, state: dict[str, ca.SX],
    ) -> FinalElement:  # fmt: skip
        """Return the final element of an output; an offset's next value goes into the state."""
        output, moved = self.outputs[j], self.manipulated[j]
        last = symbols[path(moved, "last_output")]
        usable = all_of([numbers, sensors, centroid.fires])
        wish = symbols[path(moved, "output_gain")] * centroid.value
        offset = symbols.get(path(moved, "offset"))
        asked = last + time_step * wish if offset is None else wish + offset
        element = final_element(
            symbols,
            moved,
            Asked(asked, usable, numbers, sensors),
            rate_limited=output.rate_limited,
        )
        if offset is not None:
            share = tracking_share(time_step, symbols[path(moved, "fading_time")])
            fading = {
                "integral": offset,
                "proportional": wish,
                "increment": -share * offset,
                "known": usable,
                "last_applied": last,
                **applied_ports(element.applied),
            }
            name = path(moved, "offset")
            found = integral("conditional_integration")(name, fading, {})
            state[path(moved, "offset")] = found.outputs["following"]
        return element


def _reading(
    symbols: Symbols, name: str, each: FuzzyInput, time_step: ca.SX, time_step_good: ca.SX
) -> _Reading:
    """Return a crisp input: zero, and not to be used, where it is no number."""
    shown = [symbols[path(each.measurement, "pv")]]
    if each.is_of_error:
        shown.append(symbols[path(each.measurement, "sp")])
    valid = all_of([is_number(value) for value in shown])
    known = [value_or_zero(value, valid) for value in shown]
    value = known[1] - known[0] if each.is_of_error else known[0]
    sensor = symbols[path(each.measurement, "good")]
    state, named = {}, {}
    if each.is_rate:
        kept = symbols[path(name, "filtered")]
        found = filtered_derivative(value, kept, symbols[path(name, "filter_time")], time_step)
        sound = all_of([valid, sensor, time_step_good, is_number(found.filtered)])
        state[path(name, "filtered")] = ca.if_else(sound, found.filtered, kept)
        value = found.rate
        named[path(name, "rate")] = value
    width = symbols[path(name, "dead_zone")]
    scaled = symbols[path(name, "gain")] * gap_error(value, width, ca.SX(0))
    # Met where a parameter was changed to something unusable at run time, too.
    numbers = ca.logic_and(valid, is_number(scaled))
    return _Reading(value_or_zero(scaled, numbers), numbers, sensor, state, named)


def _not_negative(name: str, of: Signal | str, description: str) -> Signal:
    return replace(signals.gain(name, of, 0.0, description), low=0.0)
