"""The right numbers of a lesson, computed from the rig as it was drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible
from clepsydra.linear.equilibrium import NoEquilibrium, find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.linear.relative_gain_array import relative_gains
from clepsydra.linear.zeros import zeros
from clepsydra.process import told
from clepsydra.process.process import Process
from clepsydra.process.signal_values import read_value
from clepsydra.process.table_reader import TableReader

_REMEDY = 'write as in answer = { parameter = "outlet_1.area" }'
_VALUES = told.by_name("values by name")
#: What a table of an answer may say, for editors.
TOLD = told.table(
    {
        "value": told.quantity("the number itself"),
        "parameter": told.text("a parameter of the process, as it was drawn"),
        "at_rest": told.text("a level, measurement or input where the process rests"),
        "inputs": _VALUES,
        "outputs": _VALUES,
        "relative_gain": told.names("a controlled measurement and an input"),
        "zero": {"description": "rightmost: the real part of that zero", "enum": ["rightmost"]},
    }
)


@dataclass(frozen=True)
class Answer:
    """A right number.

    Parameters
    ----------
    value : float
        [unit]
    unit : str
        SI.
    """

    value: float
    unit: str


def read_answer(table: TableReader, key: str, process: Process, unit: str) -> Answer | None:
    """Read what the answer to a figure is; None where any number is taken.

    That is so where none is given, and where a rig that was drawn has no such point of rest.

    Parameters
    ----------
    unit : str
        In which the figure is told.

    Raises
    ------
    InputError
        It names what the process does not have, or is in another unit than the figure.
    """
    if not table.has(key):
        return None
    rows = table.table(key, "a table that says what the answer is", _REMEDY, TOLD["properties"])
    ways = [way for way in _WAYS if rows.has(way)]
    if len(ways) != 1:
        raise table.wrong(key, f"one of {', '.join(_WAYS)}", _REMEDY)
    answer = _WAYS[ways[0]](rows, process, unit)
    if answer is None:
        return None
    if unit != answer.unit and not convertible(unit, answer.unit):
        remedy = f"give the figure a unit such as {answer.unit}"
        raise table.refused("unit", unit, f"a unit of its answer, [{answer.unit}]", remedy)
    return answer


def _value(rows: TableReader, process: Process, unit: str) -> Answer:
    return Answer(rows.quantity("value", unit, "a quantity", f"give it in {unit}"), unit)


def _parameter(rows: TableReader, process: Process, unit: str) -> Answer:
    signal = _named(rows, "parameter", process.parameters, process)
    return Answer(signal.initial, signal.unit)


def _at_rest(rows: TableReader, process: Process, unit: str) -> Answer | None:
    known = (*process.state, *process.measurements, *process.inputs)
    signal = _named(rows, "at_rest", known, process)
    inputs = _given(rows, "inputs", process.inputs)
    outputs = _given(rows, "outputs", process.measurements)
    try:
        point = find_equilibrium(process, inputs or None, outputs or None)
    except NoEquilibrium as error:
        if process.drawn:  # a rig that was drawn may be one that does not rest there
            return None
        raise InputError(
            rows.place("at_rest"), signal.name, "where the process rests with these values",
            f"choose others: {str(error).rstrip('.')}",
        ) from None  # fmt: skip
    return Answer(point.as_dict()[signal.name], signal.unit)


def _relative_gain(rows: TableReader, process: Process, unit: str) -> Answer:
    key, remedy = "relative_gain", 'write as in relative_gain = ["level_1", "pump_1"]'
    expected = f"a controlled measurement and an input of {process.name}"
    names, model = rows.names(key, expected, remedy), _controlled(process)
    if len(names) != 2 or names[0] not in model.outputs or names[1] not in model.inputs:
        raise rows.wrong(key, expected, remedy)
    row, column = model.outputs.index(names[0]), model.inputs.index(names[1])
    return Answer(float(relative_gains(model)[row, column]), "1")


def _zero(rows: TableReader, process: Process, unit: str) -> Answer:
    rows.choice("zero", ["rightmost"], "rightmost")
    found = zeros(_controlled(process))
    if not len(found):
        raise rows.wrong("zero", f"a process with a zero; {process.name} has none", "leave it out")
    return Answer(float(np.max(found.real)), "rad/s")


def _controlled(process: Process) -> LinearModel:
    return linearise(find_equilibrium(process)).select(outputs=process.controlled)


def _named(rows: TableReader, key: str, signals: Sequence[Signal], process: Process) -> Signal:
    known = {signal.name: signal for signal in signals}
    name = rows.text(key, "a name", _REMEDY)
    require_known(rows.place(key), name, list(known), f"one of {process.name}")
    return known[name]


def _given(rows: TableReader, key: str, signals: Sequence[Signal]) -> dict[str, float]:
    if not rows.has(key):
        return {}
    table = rows.table(key, "values by name", f'write as in {key} = {{ pump_1 = "50 %" }}')
    known = {signal.name: signal for signal in signals}
    for name in table.present:
        require_known(table.place(name), name, list(known), f"one of its {key}")
    return {
        name: read_value(table, name, known[name], "a value of", "give it with its unit")
        for name in table.present
    }


_WAYS: dict[str, Callable[[TableReader, Process, str], Answer | None]] = {
    "value": _value,
    "parameter": _parameter,
    "at_rest": _at_rest,
    "relative_gain": _relative_gain,
    "zero": _zero,
}
