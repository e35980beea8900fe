"""A fuzzy controller of a file, wired to a process at its operating point."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import cast, get_args

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.signal import path
from clepsydra.base.units import to_si
from clepsydra.controllers import signals
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.fuzzy import membership
from clepsydra.controllers.fuzzy.law import FAMILY, fuzzy_law
from clepsydra.controllers.fuzzy.rule import parse_rule
from clepsydra.controllers.fuzzy.system import (
    FEWEST_POINTS,
    MOST_POINTS,
    FuzzySystem,
    LinguisticVariable,
)
from clepsydra.controllers.fuzzy.variables import Action, FuzzyInput, FuzzyOutput, Quantity
from clepsydra.controllers.signals import owners
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.document import Document, parse
from clepsydra.process.known_names import known_name
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader, checked_name, shown_value

_KEYS = ("title", "points", "inputs", "outputs", "rules")
INPUT_KEYS = ("of", "quantity", "unit", "gain", "range", "dead_zone", "filter_time", "sets")
OUTPUT_KEYS = ("moves", "action", "unit", "range", "gain", "rate_limit", "fading_time", "sets")
_RULE = 'write as in R1 = "if e is N and de is ZO then u is PS"'
_SETS = "write as in [inputs.e.sets] and N = { left_shoulder = [-1, 0] }"

#: Shape to its number of points, and what makes it.
_SHAPES: dict[str, tuple[int, Callable[..., membership.Membership]]] = {
    "left_shoulder": (2, membership.left_shoulder),
    "right_shoulder": (2, membership.right_shoulder),
    "triangle": (3, membership.triangle),
    "trapezoid": (4, membership.Trapezoid),
    "gaussian": (2, membership.Gaussian),
}


@dataclass(frozen=True, eq=False)
class FuzzyFile:
    """What a file of a fuzzy controller says.

    `system`: in the units of the file, after the input gains and before the output gains; `inputs`,
    `outputs`: linguistic variable to its table, for what it stands for in a process.
    """

    title: str
    system: FuzzySystem
    inputs: dict[str, TableReader]
    outputs: dict[str, TableReader]


def load_fuzzy(path: str | Path) -> FuzzyFile:
    """Read a file of a fuzzy controller.

    Raises InputError: there is no such file, or something in it is wrong, told with its line.
    """
    content = read_input(Path(path), "a fuzzy file", inside="the .toml file")
    return read_fuzzy(parse(content, str(path), "fuzzy"))


def read_fuzzy(document: Document) -> FuzzyFile:
    """Read a fuzzy controller from a document.

    Raises InputError: something is wrong, told with its line.
    """
    general = TableReader(document, (), _KEYS)
    inputs = _tables(general, "inputs", INPUT_KEYS)
    outputs = _tables(general, "outputs", OUTPUT_KEYS)
    read = _variables(document, "inputs", inputs, (-1.0, 1.0))
    moved = _variables(document, "outputs", outputs, None)
    with _placed(document):
        rows = general.table("rules", "a table of rules", _RULE)
        rules = [parse_rule(name, rows.text(name, "a rule", _RULE)) for name in rows.present]
        system = FuzzySystem(read, moved, tuple(rules), _points(general))
    title = general.text("title", "one line of text", "leave it out for none", default="")
    return FuzzyFile(title, system, inputs, outputs)


@contextmanager
def _placed(document: Document, above: str = "") -> Iterator[None]:
    """Give an error whose place is a path in the system its line in the file."""
    try:
        yield
    except InputError as error:
        if error.place.startswith(f"{document.file}, line "):
            raise
        place = document.place(*f"{above}{error.place}".split("."))
        raise InputError(place, error.value, error.expected, error.remedy) from None


def _tables(general: TableReader, kind: str, keys: tuple[str, ...]) -> dict[str, TableReader]:
    remedy = f"write [{kind}.{'e' if kind == 'inputs' else 'u'}]"
    expected = f"a table for each of the {kind}"
    rows = general.table(kind, expected, remedy)
    if not rows.present:
        raise general.refused(kind, "none", expected, remedy)
    return {
        checked_name(name, rows.place(name)): rows.table(name, "a table", remedy, keys)
        for name in rows.present
    }


def _variables(
    document: Document,
    kind: str,
    tables: dict[str, TableReader],
    default: tuple[float, float] | None,
) -> tuple[LinguisticVariable, ...]:
    found = []
    for name, table in tables.items():
        low, high = default if default and not table.has("range") else table.range("range", "1")
        rows = table.table("sets", "a table of sets", _SETS)
        sets = {checked_name(label, rows.place(label)): _set(rows, label) for label in rows.present}
        with _placed(document, f"{kind}."):
            found.append(LinguisticVariable(name, low, high, sets))
    return tuple(found)


def _set(rows: TableReader, label: str) -> membership.Membership:
    shapes = ", ".join(_SHAPES)
    table = rows.table(label, "a table with one shape", _SETS, tuple(_SHAPES))
    if len(table.present) != 1:
        shown = ", ".join(table.present) or Finding("no shape")
        raise rows.refused(label, shown, f"one shape of {shapes}", _SETS)
    (shape,) = table.present
    count, make = _SHAPES[shape]
    written = table.raw(shape)
    if not isinstance(written, list) or len(written) != count:
        remedy = f"write as in {shape} = {list(range(count))}"
        raise table.wrong(shape, f"a list of {count} numbers", remedy)
    numbers = [to_si(shown_value(number), "1", table.place(shape)) for number in written]
    try:
        return make(*numbers)
    except InputError as error:
        raise table.wrong(shape, error.expected, error.remedy) from None


def _points(general: TableReader) -> int:
    written = general.raw("points") if general.has("points") else 101
    if not isinstance(written, int) or isinstance(written, bool):
        shown = str(written).lower() if isinstance(written, bool) else shown_value(written)
        raise general.refused(
            "points", shown, f"a whole number from {FEWEST_POINTS} to {MOST_POINTS}", "101 is usual"
        )
    return written


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

        `point`: of the process; `name`: what the reader sees.
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
