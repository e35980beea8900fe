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
from clepsydra.controllers.fuzzy.kinds import Action, FuzzyInput, FuzzyOutput, Quantity
from clepsydra.controllers.fuzzy.law import FAMILY, fuzzy_law
from clepsydra.controllers.signals import owners
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader

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
        inputs = {name: _input(table, process) for name, table in file.inputs.items()}
        actuators = [signal.name for signal in process.inputs]
        self._outputs: dict[str, tuple[TableReader, FuzzyOutput]] = {}
        for table in file.outputs.values():
            moved = _one_of(table, "moves", actuators, "a manipulated variable")
            if moved in self._outputs:
                first, _ = self._outputs[moved]
                raise first.refused("moves", moved, "each manipulated variable once", "correct it")
            action = cast(Action, table.choice("action", get_args(Action), "position"))
            self._outputs[moved] = table, FuzzyOutput(action, table.has("rate_limit"))
        outputs = [output for _, output in self._outputs.values()]
        read = dict.fromkeys(each.measurement for each in inputs.values())
        known, driven = (
            [process.signal(name) for name in names] for names in (read, self._outputs)
        )
        self.law = fuzzy_law(known, driven, file.system, list(inputs.values()), outputs)
        self.measurements, self.setpoints = (owners(self.law.inputs, part) for part in ("pv", "sp"))
        self.values = {parameter.name: parameter.initial for parameter in self.law.parameters}
        for name, each in inputs.items():
            table = file.inputs[name]
            self._set(table, name, self._read_input(name, table, each))
        for moved, (table, output) in self._outputs.items():
            self._set(table, moved, self._read_output(table, output, process.signal(moved)))

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
        at_rest = (each for each in self.law.inputs if each.part in ("sp", "pv", "tracking"))
        inputs = {signal.name: at[signal.owner] for signal in at_rest}
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
            manipulated=tuple(self._outputs),
            notes=self._notes(),
        )

    def _notes(self) -> tuple[str, ...]:
        positions = [moved for moved, (_, output) in self._outputs.items() if output.is_position]
        if not positions:
            return ()
        moved, have = " and ".join(positions), "has" if len(positions) == 1 else "have"
        return (f"{moved} {have} no integral action: a load leaves an offset.",)

    def _read_input(self, name: str, table: TableReader, each: FuzzyInput) -> dict[str, float]:
        signal = self.process.signal(each.measurement)
        factor = _factor(table, each.crisp(name, signal).unit)
        gain = table.quantity("gain", "1", "a number", "give the factor to the range", default=1.0)
        width = table.quantity(
            "dead_zone", "1", "a number in the unit of the input", "leave it out for none",
            at_least=0.0, default=0.0,
        )  # fmt: skip
        found = {"gain": gain / factor, "dead_zone": width * factor}
        if each.is_rate:
            found["filter_time"] = table.quantity(
                "filter_time", "s", "a time", "leave it out for none", at_least=0.0, default=0.0
            )
        else:
            remedy = "leave it out, or take the rate of the quantity"
            _refuse(table, "filter_time", "a filter of a rate only", remedy)
        return found

    def _read_output(
        self, table: TableReader, output: FuzzyOutput, signal: Signal
    ) -> dict[str, float]:
        factor = _factor(table, output.crisp(signal).unit)
        gain = table.quantity("gain", "1", "a number", "leave it out for 1", default=1.0)
        found = {"output_gain": gain * factor}
        if output.rate_limited:
            rate = signals.per(signal, "s").unit
            found["rate_limit"] = table.quantity(
                "rate_limit", rate, "a rate", "leave it out for none", above=0.0
            )
        if output.is_position:
            found["fading_time"] = table.quantity(
                "fading_time", "s", "a time", "leave it out for ten samples",
                above=0.0, default=_FADING_SAMPLES * self.process.sampling_period,
            )  # fmt: skip
        else:
            remedy = "leave it out: an increment starts without a bump"
            _refuse(table, "fading_time", "a fading time of a position only", remedy)
        return found

    def _set(self, table: TableReader, owner: str, values: dict[str, float]) -> None:
        """Set parameters of the law, which must be within what they may be."""
        parameters = {parameter.name: parameter for parameter in self.law.parameters}
        for part, value in values.items():
            parameter = parameters[path(owner, part)]
            if not parameter.low <= value <= parameter.high:
                key = part.removeprefix("output_")
                raise table.refused(
                    key, table.written(key),
                    f"what makes {parameter.low:g} to {parameter.high:g} {parameter.unit}",
                    "check the number and the unit",
                )  # fmt: skip
            self.values[parameter.name] = value


def _input(table: TableReader, process: Process) -> FuzzyInput:
    of = _one_of(table, "of", [signal.name for signal in process.measurements], "a sensor")
    found = FuzzyInput(cast(Quantity, table.choice("quantity", get_args(Quantity), "error")), of)
    if found.is_of_error and of not in process.controlled:
        raise table.refused(
            "of", of, f"for an error, a controlled sensor ({', '.join(process.controlled)})",
            'it has no setpoint: write quantity = "measurement"',
        )  # fmt: skip
    return found


def _refuse(table: TableReader, key: str, expected: str, remedy: str) -> None:
    if table.has(key):
        raise table.refused(key, table.written(key), expected, remedy)


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
