"""The parameters of a controller's law as a study file calls them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from clepsydra.base.signal import Signal
from clepsydra.base.units import split_quantity
from clepsydra.controllers.controller import Controller
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.gains import read_gain
from clepsydra.studies.file.joined_unit import Time, has_units_of, unit_of_gain

#: What a key of a loop is called among the parameters of a law, where it is not the same.
LAW_NAMES = {
    "gain": "proportional_gain",
    "setpoint_low": "setpoint_low_limit",
    "setpoint_high": "setpoint_high_limit",
}
#: The gains of a loop, with what their unit has beside those of the signals.
GAINS: dict[str, Time] = {"gain": "1", "integral_gain": "1/s", "derivative_gain": "s"}


@dataclass(frozen=True)
class LoopSignals:
    """The number of a PID loop in its law, what it measures, and what it moves.

    Examples
    --------
    >>> LoopSignals(1, Signal("level", "m"), Signal("pump", "V")).parameter("gain")
    'proportional_gain_1'
    """

    number: int
    measurement: Signal
    moved: Signal

    def parameter(self, key: str) -> str:
        """Return the law's name for a key of the loop."""
        return f"{LAW_NAMES.get(key, key)}_{self.number}"


@dataclass(frozen=True)
class LawParameters:
    """How the parameters of one law are named and written in a study file.

    Parameters
    ----------
    known : mapping
        Parameter of the law to its signal.
    loops : mapping
        Loop of the law, as a study file calls it, to its signals.

    Examples
    --------
    >>> level, pump = Signal("level", "m"), Signal("pump", "V")
    >>> names = LawParameters({}, {"level": LoopSignals(1, level, pump)})
    >>> names.loops["level"].parameter("integral_time")
    'integral_time_1'
    """

    known: Mapping[str, Signal]
    loops: Mapping[str, LoopSignals] = field(default_factory=dict)

    def read(self, table: TableReader, key: str, name: str, expected: str, remedy: str) -> float:
        """Return the value at a key of a table, which is one of the law's parameter `name`."""
        for loop in self.loops.values():
            for gain, time in GAINS.items():
                if loop.parameter(gain) == name:
                    return read_gain(
                        table, key, loop.moved, loop.measurement,
                        expected=expected, remedy=remedy, time=time,
                    )  # fmt: skip
        parameter = self.known[name]
        # The law's "V/V" is a number, but not every number is in V/V.
        unit = unit_of_gain(parameter, Signal(""))
        parts = split_quantity(table.raw(key))
        if parts is not None and parts[1] and not has_units_of(parts[1], parameter.unit):
            raise table.refused(
                key,
                table.written(key),
                f"{expected} in {parameter.unit}" if parameter.unit != "1" else expected,
                f"{parts[1]!r} is no unit of it: {remedy}",
            )
        return table.quantity(key, unit, expected, remedy)


def law_parameters(
    controller: Controller, process: Process, loops: Mapping[str, LoopSignals] | None = None
) -> LawParameters:
    """Return the parameters of a controller's law; of multiloop control with its loops.

    Parameters
    ----------
    controller : Controller
    process : Process
    loops : mapping, optional
        Those of a control scheme. A multiloop controller calls each loop by its measurement.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> names = law_parameters(controller, plant.process)
    >>> names.loops["level_2"].parameter("gain")
    'proportional_gain_2'
    """
    known = {parameter.name: parameter for parameter in controller.law.parameters}
    if loops is None and controller.family.startswith("multiloop"):
        pairs = zip(controller.measurements, controller.manipulated, strict=True)
        loops = {
            output: LoopSignals(number, process.signal(output), process.signal(moved))
            for number, (output, moved) in enumerate(pairs, start=1)
        }
    return LawParameters(known, loops or {})
