"""A fuzzy controller of a file, wired to a process at its operating point."""

from __future__ import annotations

from typing import cast, get_args

from clepsydra.base.signal import path
from clepsydra.base.units import to_si
from clepsydra.controllers import signals
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.complexity import Complexity
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import FuzzyFile
from clepsydra.controllers.fuzzy.fuzzy_input import FuzzyInput, Quantity
from clepsydra.controllers.fuzzy.fuzzy_output import Action, FuzzyOutput
from clepsydra.controllers.fuzzy.law import FAMILY, fuzzy_law
from clepsydra.controllers.signals import owners
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.known_names import known_name
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader

#: Samples in which the bump that a bumpless start saves has faded to 1/e.
_FADING_SAMPLES = 10.0


class WiredFuzzy:
    """What a file of a fuzzy controller means for a process.

    Raises InputError: A sensor, an input or a unit is none of the process, or a number is out of
    range.
    """

    def __init__(self, file: FuzzyFile, process: Process) -> None:
        self.file, self.process = file, process
        inputs = {name: _input(table, process) for name, table in file.inputs.items()}
        outputs = [_output(table, process) for table in file.outputs.values()]
        moved = [output.moved.name for output in outputs]
        for table, name in zip(file.outputs.values(), moved, strict=True):
            if moved.count(name) > 1:
                expected = "each manipulated variable once"
                raise table.refused("moves", name, expected, "correct it")
        self._outputs = dict(zip(moved, outputs, strict=True))
        self.law = fuzzy_law(file.system, list(inputs.values()), outputs)
        self.measurements, self.setpoints = (owners(self.law.inputs, part) for part in ("pv", "sp"))
        self.values = {parameter.name: parameter.initial for parameter in self.law.parameters}
        for name, each in inputs.items():
            table = file.inputs[name]
            self._set(table, name, _input_values(table, name, each))
        for table, output in zip(file.outputs.values(), outputs, strict=True):
            self._set(table, output.moved.name, self._output_values(table, output))

    def controller(self, point: OperatingPoint, name: str) -> Controller:
        """Return the controller, whose outputs start at the operating point.

        Parameters
        ----------
        point : OperatingPoint
            Of the process.
        name : str
            What the reader sees.
        """
        system = self.file.system
        return Controller(
            name=name,
            family=FAMILY,
            structure=Complexity.ADVANCED_LOOPS,
            design=(
                f"Written out: {len(system.rules)} rules, centroid on {system.points} points"
                + (f"; {self.file.title}." if self.file.title else ".")
            ),
            law=self.law,
            values=self.values,
            initial_state=state_at_rest(self.law, self.values, point.as_dict()),
            measurements=self.measurements,
            setpoints=self.setpoints,
            manipulated=tuple(self._outputs),
            notes=self._notes(),
        )

    def _notes(self) -> tuple[str, ...]:
        positions = [moved for moved, output in self._outputs.items() if output.is_position]
        if not positions:
            return ()
        moved, have = " and ".join(positions), "has" if len(positions) == 1 else "have"
        return (f"{moved} {have} no integral action: a load leaves an offset.",)

    def _output_values(self, table: TableReader, output: FuzzyOutput) -> dict[str, float]:
        factor = _factor(table, output.crisp.unit)
        gain = table.quantity("gain", "1", "a number", "leave it out for 1", default=1.0)
        found = {"output_gain": gain * factor}
        if output.rate_limited:
            rate = signals.per(output.moved, "s").unit
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
            table.refuse(["fading_time"], "a fading time of a position only", remedy)
        return found

    def _set(self, table: TableReader, owner: str, values: dict[str, float]) -> None:
        """Set parameters of the law, which must be within what they may be."""
        parameters = {parameter.name: parameter for parameter in self.law.parameters}
        for part, value in values.items():
            parameter = parameters[path(owner, part)]
            if not parameter.low <= value <= parameter.high:
                key = part.removeprefix("output_")
                raise table.wrong(
                    key,
                    f"what makes {parameter.low:g} to {parameter.high:g} {parameter.unit}",
                    "check the number and the unit",
                )
            self.values[parameter.name] = value


def _input(table: TableReader, process: Process) -> FuzzyInput:
    of = _one_of(table, "of", [signal.name for signal in process.measurements], "a sensor")
    quantity = cast(Quantity, table.choice("quantity", get_args(Quantity), "error"))
    found = FuzzyInput(quantity, process.signal(of))
    if found.is_of_error and of not in process.controlled:
        raise table.refused(
            "of", of, f"for an error, a controlled sensor ({', '.join(process.controlled)})",
            'it has no setpoint: write quantity = "measurement"',
        )  # fmt: skip
    return found


def _output(table: TableReader, process: Process) -> FuzzyOutput:
    actuators = [signal.name for signal in process.inputs]
    moved = process.signal(_one_of(table, "moves", actuators, "a manipulated variable"))
    action = cast(Action, table.choice("action", get_args(Action), "position"))
    return FuzzyOutput(moved, action, table.has("rate_limit"))


def _input_values(table: TableReader, name: str, each: FuzzyInput) -> dict[str, float]:
    factor = _factor(table, each.crisp(name).unit)
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
        table.refuse(["filter_time"], "a filter of a rate only", remedy)
    return found


def _one_of(table: TableReader, key: str, known: list[str], what: str) -> str:
    expected = f"{what} ({', '.join(known)})"
    name = table.text(key, expected, f'write as in {key} = "{known[0]}"')
    return known_name(table, key, name, known, what)


def _factor(table: TableReader, unit: str) -> float:
    """Return how many of the process's unit are one of the table's unit."""
    written = table.text("unit", f"a unit convertible to {unit}", f'write as in unit = "{unit}"')
    if written.strip() == "1":
        written = ""
    return to_si(f"1 {written}", unit, table.place("unit"))
