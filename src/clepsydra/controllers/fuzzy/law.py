"""The step law of a Mamdani controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import tracking_share
from clepsydra.controllers.blocks.derivative import filtered_derivative
from clepsydra.controllers.blocks.error_shape import gap_error
from clepsydra.controllers.blocks.final_element import FinalElement, final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.integral import applied_ports, integral
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
    system: FuzzySystem,
    inputs: Sequence[FuzzyInput],
    outputs: Sequence[FuzzyOutput],
    *,
    measured: Sequence[Signal],
    manipulated: Sequence[Signal],
    name: str = "fuzzy",
) -> StepLaw:
    """Write the step law of a Mamdani controller.

    Linguistic input i is x = k D(q): q the error r − y, the measurement y or the derivative of
    one of them, D a dead zone, k its gain; the range of its variable clips it. With the centroid
    c of linguistic output j, in automatic::

        u = min(high limit, max(low limit, g c + b))      position
        u = min(high limit, max(low limit, u + Δt g c))      increment, u from the last sample

    and no faster than the rate limit. A position has no integral action. Its b makes a change of
    mode bumpless and fades, b⁺ = b − min(Δt/Tf, 1) b, but not further into saturation. An
    increment moves on from what was applied, in every mode, so it neither bumps nor winds up.

    Where no rule fires the output is held. A fault of a sensor, or a value that is no number,
    holds the outputs whose rules read it; the others go on.

    Parameters
    ----------
    system : FuzzySystem
    inputs : sequence of FuzzyInput
        One for each input of the system.
    outputs : sequence of FuzzyOutput
        One for each output of the system; output j moves manipulated j.
    measured, manipulated : sequence of Signal
        The process signals: they lend their units and ranges.
    name : str
        An identifier.

    Returns
    -------
    StepLaw
        Inputs setpoint_j (one for each measurement whose error is used, in their order),
        measurement_j, sensor_j, mode_j, manual_j, tracking_j, time_step [s]; parameters
        input_gain_i, dead_zone_i, filter_time_i [s] of a rate, output_gain_j, fading_time_j [s]
        of a position, low_limit_j, high_limit_j, rate_limit_j; state filtered_i of a rate,
        offset_j of a position, last_output_j; outputs manipulated_j, status_j.

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
    ...     FuzzySystem((error,), (opening,), tuple(rules)), [FuzzyInput("error", 1)],
    ...     [FuzzyOutput()], measured=[Signal("level", "m")], manipulated=[Signal("pump", "V")])
    >>> [parameter.name for parameter in law.parameters]
    ['input_gain_1', 'dead_zone_1', 'output_gain_1', 'fading_time_1', 'low_limit_1', 'high_limit_1']
    """
    _check(system, inputs, outputs, measured, manipulated)
    writer = _Writer(system, tuple(inputs), tuple(outputs), tuple(measured), tuple(manipulated))
    followed = [measured[number - 1] for number in writer.followed]
    return step_law(
        name,
        inputs=[
            *signals.setpoint_inputs(followed),
            *signals.measurement_inputs(measured),
            *signals.output_inputs(manipulated),
        ],
        parameters=writer.parameters(),
        state=writer.state(),
        outputs=[s for j, u in enumerate(manipulated, 1) for s in signals.output_signals(j, u)],
        equations=writer.equations,
        description=[f"{rule.name}: {rule}" for rule in system.rules],
    )


def _check(
    system: FuzzySystem,
    inputs: Sequence[FuzzyInput],
    outputs: Sequence[FuzzyOutput],
    measured: Sequence[Signal],
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
        if not 1 <= each.measurement <= len(measured):
            raise InputError(
                "fuzzy law, inputs", each.measurement,
                f"the number of a measurement, 1 to {len(measured)}", "correct it",
            )  # fmt: skip


@dataclass(frozen=True)
class _Writer:
    system: FuzzySystem
    inputs: tuple[FuzzyInput, ...]
    outputs: tuple[FuzzyOutput, ...]
    measured: tuple[Signal, ...]
    manipulated: tuple[Signal, ...]

    @property
    def followed(self) -> tuple[int, ...]:
        return followed_measurements(self.inputs)

    def parameters(self) -> list[Signal]:
        found: list[Signal] = []
        for i, (each, variable) in enumerate(zip(self.inputs, self.system.inputs, strict=True), 1):
            unit = self._unit(each)
            name = f"{variable.name}, {each.quantity.replace('_', ' ')} of {self._of(each).name}"
            found += [
                signals.gain(
                    f"input_gain_{i}", signals.ratio_of_units("1", unit), 1.0, f"gain of {name}"
                ),
                Signal(
                    f"dead_zone_{i}", unit, low=0.0, high=signals.LARGEST_PARAMETER,
                    description=f"half width of the dead zone of {name}",
                ),
            ]  # fmt: skip
            if each.is_rate:
                found.append(
                    Signal(
                        f"filter_time_{i}", "s", low=0.0, high=signals.LARGEST_PARAMETER,
                        description=f"time constant of the filter of {name}",
                    )
                )  # fmt: skip
        for j, (output, moved) in enumerate(zip(self.outputs, self.manipulated, strict=True), 1):
            per = () if output.action == "position" else ("s",)
            unit = signals.ratio_of_units(moved.unit, *per)
            found.append(signals.gain(f"output_gain_{j}", unit, 1.0, f"gain to {moved.name}"))
            if output.action == "position":
                words = f"time in which a bumpless start of {moved.name} fades"
                found.append(signals.duration(f"fading_time_{j}", words))
            found += signals.limit_parameters(j, moved)
            if output.rate_limited:
                found.append(
                    Signal(
                        f"rate_limit_{j}", signals.ratio_of_units(moved.unit, "s"), low=0.0,
                        high=signals.LARGEST_PARAMETER, initial=signals.LARGEST_PARAMETER,
                        description=f"largest rate of change of {moved.name}",
                    )
                )  # fmt: skip
        return found

    def state(self) -> list[Signal]:
        filtered = [
            Signal(
                f"filtered_{i}",
                self._of(each).unit,
                description=f"filtered {each.quantity.removesuffix('_rate')} behind {v.name}",
            )
            for i, (each, v) in enumerate(zip(self.inputs, self.system.inputs, strict=True), 1)
            if each.is_rate
        ]
        offsets = [
            Signal(f"offset_{j}", u.unit, description=f"what a bumpless start adds to {u.name}")
            for j, (output, u) in enumerate(zip(self.outputs, self.manipulated, strict=True), 1)
            if output.action == "position"
        ]
        last = [signals.last_output(j, u) for j, u in enumerate(self.manipulated, start=1)]
        return [*filtered, *offsets, *last]

    def _of(self, each: FuzzyInput) -> Signal:
        return self.measured[each.measurement - 1]

    def _unit(self, each: FuzzyInput) -> str:
        unit = self._of(each).unit
        return signals.ratio_of_units(unit, "s") if each.is_rate else unit

    def equations(self, symbols: Symbols) -> Equations:
        time_step_good = is_time_step(symbols["time_step"])
        time_step = ca.if_else(time_step_good, symbols["time_step"], 1)
        readings = {
            variable.name: self._reading(symbols, i, each, time_step, time_step_good)
            for i, (each, variable) in enumerate(
                zip(self.inputs, self.system.inputs, strict=True), start=1
            )
        }
        values = {name: reading.value for name, reading in readings.items()}
        state: dict[str, ca.SX] = {}
        named: dict[str, ca.SX] = {"time_step_good": time_step_good}
        for name, reading in readings.items():
            state |= reading.state
            named |= reading.named | {f"scaled_{name}": reading.value}
        written: dict[str, ca.SX] = {}
        crisp, fires = surface(self.system)(ca.vertcat(*values.values()))
        for j, variable in enumerate(self.system.outputs, start=1):
            centroid = Centroid(crisp[j - 1], fires[j - 1])
            read = [readings[v.name] for v in self.system.used_by(variable.name)]
            numbers = all_of([reading.numbers for reading in read])
            sensors = all_of([reading.sensor for reading in read])
            element = self._moved(symbols, j, centroid, numbers, sensors, time_step, state)
            state[f"last_output_{j}"] = element.manipulated
            written |= {f"manipulated_{j}": element.manipulated, f"status_{j}": element.status}
            named |= element.named | {f"centroid_{variable.name}": centroid.value}
        return Equations(state, written, named)

    def _reading(
        self, symbols: Symbols, i: int, each: FuzzyInput, time_step: ca.SX, time_step_good: ca.SX
    ) -> _Reading:
        """Return a crisp input: zero, and not to be used, where it is no number."""
        raw = [symbols[f"measurement_{each.measurement}"]]
        if each.is_of_error:
            number = self.followed.index(each.measurement) + 1
            raw.append(symbols[f"setpoint_{number}"])
        valid = all_of([is_number(value) for value in raw])
        known = [value_or_zero(value, valid) for value in raw]
        value = known[1] - known[0] if each.is_of_error else known[0]
        sensor = symbols[f"sensor_{each.measurement}"]
        state, named = {}, {}
        if each.is_rate:
            kept = symbols[f"filtered_{i}"]
            found = filtered_derivative(value, kept, symbols[f"filter_time_{i}"], time_step)
            sound = all_of([valid, sensor, time_step_good, is_number(found.filtered)])
            state[f"filtered_{i}"] = ca.if_else(sound, found.filtered, kept)
            value = found.rate
            named[f"rate_{i}"] = value
        scaled = symbols[f"input_gain_{i}"] * gap_error(value, symbols[f"dead_zone_{i}"], ca.SX(0))
        # Met where a parameter was changed to something unusable at run time, too.
        numbers = ca.logic_and(valid, is_number(scaled))
        return _Reading(value_or_zero(scaled, numbers), numbers, sensor, state, named)

    def _moved(
        self, symbols: Symbols, j: int, centroid: Centroid, numbers: ca.SX, sensors: ca.SX,
        time_step: ca.SX, state: dict[str, ca.SX],
    ) -> FinalElement:  # fmt: skip
        """Return the final element of an output; an offset's next value goes into the state."""
        output, last = self.outputs[j - 1], symbols[f"last_output_{j}"]
        usable = all_of([numbers, sensors, centroid.fires])
        wish = symbols[f"output_gain_{j}"] * centroid.value
        position = output.action == "position"
        asked = wish + symbols[f"offset_{j}"] if position else last + time_step * wish
        element = final_element(
            symbols,
            j,
            self.manipulated[j - 1],
            Asked(asked, usable, numbers, sensors),
            rate_limited=output.rate_limited,
        )
        if position:
            share = tracking_share(time_step, symbols[f"fading_time_{j}"])
            fading = {
                "integral": symbols[f"offset_{j}"],
                "proportional": wish,
                "increment": -share * symbols[f"offset_{j}"],
                "known": usable,
                "last_applied": last,
                **applied_ports(element.applied),
            }
            name = f"{self.manipulated[j - 1].identifier}_offset"
            found = integral("conditional_integration")(name, fading, {})
            state[f"offset_{j}"] = found.outputs["following"]
        return element
