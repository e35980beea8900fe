"""A fuzzy controller of a file, wired to a process at its operating point."""

from __future__ import annotations

from typing import cast, get_args

from clepsydra.base.signal import Signal, path
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import to_si
from clepsydra.controllers import signals
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import FuzzyFile
from clepsydra.controllers.fuzzy.kinds import (
    Action,
    FuzzyInput,
    FuzzyOutput,
    Quantity,
    followed_measurements,
)
from clepsydra.controllers.fuzzy.law import FAMILY, fuzzy_law
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader

_QUANTITIES = get_args(Quantity)
_ACTIONS = get_args(Action)
#: Samples in which the bump that a bumpless start saves has faded to 1/e.
_FADING_SAMPLES = 10.0


class WiredFuzzy:
    """What a file of a fuzzy controller means for a process.

    Parameters
    ----------
    file : FuzzyFile
    process : Process

    Raises
    ------
    InputError
        A sensor, an input or a unit is none of the process, or a number is out of range.

    Examples
    --------
    >>> from clepsydra.controllers.fuzzy.file import read_fuzzy
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> text = b'''
    ... [inputs.e]
    ... of = "level_1"
    ... unit = "V"
    ... gain = 0.5
    ... [inputs.e.sets]
    ... N = { left_shoulder = [-1, 1] }
    ... P = { right_shoulder = [-1, 1] }
    ... [outputs.u]
    ... moves = "pump_1"
    ... unit = "V"
    ... range = [0, 10]
    ... [outputs.u.sets]
    ... S = { left_shoulder = [0, 10] }
    ... L = { right_shoulder = [0, 10] }
    ... [rules]
    ... R1 = "if e is N then u is S"
    ... R2 = "if e is P then u is L"
    ... '''
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> wired = WiredFuzzy(read_fuzzy(parse(text, "halves.toml")), point.process)
    >>> controller = wired.controller(point, "halves")
    >>> controller.values["e.gain"], controller.measurements, controller.manipulated
    (0.5, ('level_1',), ('pump_1',))
    """

    def __init__(self, file: FuzzyFile, process: Process) -> None:
        self.file, self.process = file, process
        sensors = [signal.name for signal in process.measurements]
        of = {
            name: _one_of(table, "of", sensors, "a sensor") for name, table in file.inputs.items()
        }
        self.measurements = tuple(dict.fromkeys(of.values()))
        inputs = []
        for name, table in file.inputs.items():
            quantity = table.choice("quantity", _QUANTITIES, "error")
            if quantity.startswith("error") and of[name] not in process.controlled:
                raise table.refused(
                    "of", of[name],
                    f"for an error, a controlled sensor ({', '.join(process.controlled)})",
                    'it has no setpoint: write quantity = "measurement"',
                )  # fmt: skip
            inputs.append(FuzzyInput(cast(Quantity, quantity), of[name]))
        known = [signal.name for signal in process.inputs]
        self.manipulated = tuple(
            _one_of(table, "moves", known, "a manipulated variable")
            for table in file.outputs.values()
        )
        for table, moved in zip(file.outputs.values(), self.manipulated, strict=True):
            if self.manipulated.count(moved) > 1:
                raise table.refused("moves", moved, "each manipulated variable once", "correct it")
        outputs = [
            FuzzyOutput(
                cast(Action, table.choice("action", _ACTIONS, "position")),
                table.has("rate_limit"),
            )
            for table in file.outputs.values()
        ]
        self.setpoints = followed_measurements(self.measurements, inputs)
        driven = [process.signal(name) for name in self.manipulated]
        self.law = fuzzy_law(
            [process.signal(name) for name in self.measurements],
            driven,
            file.system,
            inputs,
            outputs,
        )
        self.values = {parameter.name: parameter.initial for parameter in self.law.parameters}
        for (name, table), each in zip(file.inputs.items(), inputs, strict=True):
            self._read_input(name, table, each)
        for table, output, signal in zip(file.outputs.values(), outputs, driven, strict=True):
            self._read_output(table, output, signal)

    def controller(self, point: OperatingPoint, name: str) -> Controller:
        """Return the controller, whose outputs start at the operating point.

        Parameters
        ----------
        point : OperatingPoint
            Of the process.
        name : str
            What the reader sees.
        """
        at = point.as_dict()
        inputs = {path(y, "sp"): at[y] for y in self.setpoints}
        inputs |= {path(y, "pv"): at[y] for y in self.measurements}
        inputs |= {path(u, "tracking"): at[u] for u in self.manipulated}
        system = self.file.system
        return Controller(
            name=name,
            family=FAMILY,
            design=(
                f"Written out: {len(system.rules)} rules, centroid on {system.points} points"
                + (f"; {self.file.title}." if self.file.title else ".")
            ),
            law=self.law,
            values=self.values,
            initial_state=state_at_rest(self.law, self.values, inputs),
            measurements=self.measurements,
            setpoints=self.setpoints,
            manipulated=self.manipulated,
            notes=self._notes(),
        )

    def _notes(self) -> tuple[str, ...]:
        positions = [
            moved
            for moved, table in zip(self.manipulated, self.file.outputs.values(), strict=True)
            if table.choice("action", _ACTIONS, "position") == "position"
        ]
        if not positions:
            return ()
        moved, have = " and ".join(positions), "has" if len(positions) == 1 else "have"
        return (f"{moved} {have} no integral action: a load leaves an offset.",)

    def _read_input(self, name: str, table: TableReader, each: FuzzyInput) -> None:
        signal = self.process.signal(each.measurement)
        unit = signals.ratio_of_units(signal.unit, "s") if each.is_rate else signal.unit
        factor = _factor(table, unit)
        gain = table.quantity("gain", "1", "a number", "give the factor to the range", default=1.0)
        self._set(table, "gain", path(name, "gain"), gain / factor)
        if table.has("dead_zone"):
            width = table.quantity(
                "dead_zone", "1", "a number in the unit of the input", "leave it out for none",
                at_least=0.0,
            )  # fmt: skip
            self._set(table, "dead_zone", path(name, "dead_zone"), width * factor)
        if not table.has("filter_time"):
            return
        if not each.is_rate:
            raise table.refused(
                "filter_time", table.written("filter_time"), "a filter of a rate only",
                "leave it out, or take the rate of the quantity",
            )  # fmt: skip
        time = table.quantity("filter_time", "s", "a time", "leave it out for none", at_least=0.0)
        self._set(table, "filter_time", path(name, "filter_time"), time)

    def _read_output(self, table: TableReader, output: FuzzyOutput, signal: Signal) -> None:
        rate = signals.ratio_of_units(signal.unit, "s")
        factor = _factor(table, signal.unit if output.action == "position" else rate)
        gain = table.quantity("gain", "1", "a number", "leave it out for 1", default=1.0)
        self._set(table, "gain", path(signal, "output_gain"), gain * factor)
        if output.rate_limited:
            limit = table.quantity("rate_limit", rate, "a rate", "leave it out for none", above=0.0)
            self._set(table, "rate_limit", path(signal, "rate_limit"), limit)
        if output.action == "position":
            default = _FADING_SAMPLES * self.process.sampling_period
            time = table.quantity(
                "fading_time", "s", "a time", "leave it out for ten samples",
                above=0.0, default=default,
            )  # fmt: skip
            self._set(table, "fading_time", path(signal, "fading_time"), time)
        elif table.has("fading_time"):
            raise table.refused(
                "fading_time", table.written("fading_time"), "a fading time of a position only",
                "leave it out: an increment starts without a bump",
            )  # fmt: skip

    def _set(self, table: TableReader, key: str, name: str, value: float) -> None:
        """Set a parameter of the law, which must be within what it may be."""
        (parameter,) = (p for p in self.law.parameters if p.name == name)
        if not parameter.low <= value <= parameter.high:
            raise table.refused(
                key, table.written(key),
                f"what makes {parameter.low:g} to {parameter.high:g} {parameter.unit}",
                "check the number and the unit",
            )  # fmt: skip
        self.values[name] = value


def _one_of(table: TableReader, key: str, known: list[str], what: str) -> str:
    expected = f"{what} ({', '.join(known)})"
    name = table.text(key, expected, f'write as in {key} = "{known[0]}"')
    if name not in known:
        raise table.refused(key, name[:60], expected, suggestion(name, known, "choose one of them"))
    return name


def _factor(table: TableReader, unit: str) -> float:
    """Return how many of the process's unit are one of the table's unit."""
    written = table.text("unit", f"a unit convertible to {unit}", f'write as in unit = "{unit}"')
    if written.strip() == "1":
        written = ""
    return to_si(f"1 {written}", unit, table.place("unit"))
