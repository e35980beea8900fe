"""Warnings of gains that look as if they were given in percent, volts or other units."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from itertools import product

import numpy as np

from clepsydra.base.key import ratio_of_units
from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import to_si
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_keys import GAINS
from clepsydra.controllers.signals import LARGEST_PARAMETER, owners
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.loops.control_authority import largest_proportional_gain
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.poles import origin_radius
from clepsydra.linear.roots import roots_of
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.warnings.loop_response import LoopResponse, loop_response
from clepsydra.studies.warnings.margins import LARGEST_PEAK

_FASTEST_TURN = 0.5
#: A gain of so many times the largest that the room of the input allows is too large.
_TOO_LARGE = 3.0
#: A loop that crosses over below this over the sum of the time constants is left alone.
_TOO_SLOW = 0.2
#: A full range of error that moves an integrating loop's input by less of its range is nothing.
_TOO_WEAK = 0.1
#: Units that differ by less make no mix-up that anyone would see.
_LEAST_FACTOR = 3.0
#: In which units of a signal a gain may be given: what the law takes, what is shown, percent.
_UNITS = ("law", "shown", "percent")
#: Those of the input and of the measurement.
Units = tuple[str, str]


def unit_warnings(
    controller: Controller, model: LinearModel, response: LoopResponse
) -> list[Remark]:
    """Return warnings of proportional gains that would fit if they were in other units.

    A gain is in units of the input per unit of the measurement. It is often written in percent
    of one range or both, or in the units in which the plant is spoken of (V/cm, %/V), and taken
    over as it stands is then wrong by a factor that is known: 10 for 10 V = 100 %, 100 for cm
    and m. Three things have to come together for a warning, so that a loop that is only bold
    or only careful raises none:

    1. The loop as it stands is no good: max|S| is above 2 or the loop unstable, and the gain is
       more than three times the one at which a setpoint step of a tenth of the range uses up
       the room of the input; or it does next to nothing, crossing over below a fifth of the
       inverse sum of the process's time constants, or, where the process integrates, moving its
       input by less than a tenth of its range for an error of a full range.
    2. A known factor between units differs from one by three or more in the right direction.
    3. With the gains of those loops multiplied by it the loop is good: max|S| at most 2, ωc T at
       most 0.5, and neither too large nor next to nothing by the first point.

    Parameters
    ----------
    controller : Controller
        Looked at where each loop of its law moves an output of its own.
    model : LinearModel
        With the measurements of the controller.
    """
    if not _one_output_a_loop(controller.law):
        return []
    process = operating_point_of(model).process
    signals = [
        *map(process.signal, controller.measurements),
        *map(process.signal, controller.manipulated),
    ]
    if not all(math.isfinite(signal.span) for signal in signals):
        return []
    loops = _Loops(controller, model)
    large, weak = loops.too_large(controller), loops.too_weak(controller, response)
    if loops.is_calm(response):
        large = []
    for suspected, upward in ((large, False), (weak, True)):
        for units, factors in loops.conversions(suspected):
            right_way = all((factor > 1.0) == upward for factor in factors.values())
            if right_way and loops.is_good(factors):
                return [
                    loops.warning(units, loop, factor, upward) for loop, factor in factors.items()
                ]
    return []


def _one_output_a_loop(law: StepLaw) -> bool:
    """Whether a law is loops of one measurement each, in the order of the outputs they move."""
    giver = {port: block for block in law.blocks for port in block.ports}
    moving = []
    for output in (block for block in law.blocks if isinstance(block, OutputBlock)):
        source = giver[output.source]
        decoupled = isinstance(source, FeedforwardBlock)
        moving.append(giver[source.source] if decoupled else source)
    loops = [block for block in moving if isinstance(block, PidBlock) and not block.inner]
    names = [loop.measurement.name for loop in loops]
    gains = {path(name, "proportional_gain") for name in names}
    known = {parameter.name for parameter in law.parameters}
    followed, measured = ([*owners(law.inputs, part)] for part in ("sp", "pv"))
    return bool(names) and names == measured == followed and gains <= known


class _Loops:
    """The loops of a multiloop controller, and what they would be with other gains."""

    def __init__(self, controller: Controller, model: LinearModel) -> None:
        self.controller, self.model = controller, model
        point = operating_point_of(model)
        at = point.as_dict()
        names = owners(controller.law.inputs, "pv")
        signal = point.process.signal
        self.pairs = {
            loop: (signal(measurement), signal(manipulated))
            for loop, measurement, manipulated in zip(
                names, controller.measurements, controller.manipulated, strict=True
            )
        }
        self.largest = {
            loop: largest_proportional_gain(measurement, manipulated, at[manipulated.name])
            for loop, (measurement, manipulated) in self.pairs.items()
        }
        seen = model.select(tuple(dict.fromkeys(controller.setpoints)), controller.manipulated)
        roots = roots_of(seen)
        radius = origin_radius(roots.zeros_of.A)
        self.integrates = bool(np.any(roots.poles.real >= -radius))
        decaying = roots.poles[roots.poles.real < -radius]
        self.time_constants = float(np.sum((-1.0 / decaying).real))

    def too_large(self, controller: Controller) -> list[str]:
        return [
            loop
            for loop, largest in self.largest.items()
            if abs(controller.values[path(loop, "proportional_gain")]) > _TOO_LARGE * largest
        ]

    def too_weak(self, controller: Controller, response: LoopResponse) -> list[str]:
        found = []
        for loop, (measurement, manipulated) in self.pairs.items():
            gain = abs(controller.values[path(loop, "proportional_gain")])
            fastest = response.channels[measurement.name].bandwidth
            if self.integrates:
                weak = gain * measurement.span < _TOO_WEAK * manipulated.span
            else:
                weak = fastest * self.time_constants < _TOO_SLOW
            if weak and gain > 0.0:
                found.append(loop)
        return found

    def is_calm(self, response: LoopResponse) -> bool:
        return response.loop.maximum_sensitivity <= LARGEST_PEAK

    def conversions(self, loops: list[str]) -> Iterator[tuple[Units, dict[str, float]]]:
        """Yield the units that gains may be in, and the factor of each loop to those of the law.

        All suspected loops were given in the same way, or one of them by itself.
        """
        groups = [loops, *([loop] for loop in loops)] if len(loops) > 1 else [loops]
        for group in groups if loops else []:
            for units in product(_UNITS, _UNITS):
                factors = {loop: self.factor(loop, units) for loop in group}
                if all(abs(math.log(f)) >= math.log(_LEAST_FACTOR) for f in factors.values()):
                    yield units, factors

    def factor(self, loop: str, units: Units) -> float:
        measurement, manipulated = self.pairs[loop]
        return _size(manipulated, units[0]) / _size(measurement, units[1])

    def is_good(self, factors: dict[str, float]) -> bool:
        values = dict(self.controller.values)
        for loop, factor in factors.items():
            for name in (path(loop, gain) for gain in GAINS):
                if name in values:
                    values[name] *= factor
                    if abs(values[name]) > LARGEST_PARAMETER:
                        return False
        changed = dataclasses.replace(self.controller, values=values)
        response = loop_response(changed, self.model)
        fastest = max(response.channels[name].bandwidth for name in response.outputs)
        return (
            self.is_calm(response)
            and fastest * response.period <= _FASTEST_TURN
            and not set(factors) & {*self.too_large(changed), *self.too_weak(changed, response)}
        )

    def warning(self, units: Units, loop: str, factor: float, upward: bool) -> Remark:
        measurement, manipulated = self.pairs[loop]
        name = path(loop, "proportional_gain")
        gain = self.controller.values[name]
        unit = ratio_of_units(manipulated.unit, measurement.unit)
        unit = "" if unit == "1" else f" {unit}"
        what = "leaves the process nearly alone" if upward else "is far too strong for the process"
        return Remark(
            f"{name} of {gain:.3g}{unit} {what}, but would fit as {gain:.3g} "
            f"{_named(manipulated, units[0])} per {_named(measurement, units[1])}",
            "check its unit",
            f"the law then needs {gain * factor:.3g}{unit}",
        )


def _size(signal: Signal, unit: str) -> float:
    """Return one of these units in the unit of the law."""
    if unit == "percent":
        return signal.percent_span / 100.0
    return 1.0 if unit == "law" else to_si(f"1 {signal.shown_unit}", signal.unit, signal.name)


def _named(signal: Signal, unit: str) -> str:
    if unit == "percent":
        return f"% of {signal.name}"
    name = signal.unit if unit == "law" else signal.shown_unit
    return "unit (100 %)" if name == "1" else name
