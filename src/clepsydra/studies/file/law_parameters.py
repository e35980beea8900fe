"""The parameters of a controller's law as a study file calls them."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from clepsydra.base.signal import Signal, path
from clepsydra.base.units import split_quantity
from clepsydra.controllers import pid_keys
from clepsydra.controllers.pid_keys import SHORT_NAMES
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.process.gains import read_gain
from clepsydra.process.joined_unit import has_units_of, unit_of_gain
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import StepLaw

#: What a key of a loop is called among the parameters of a law, where it is not the same.
LAW_NAMES = {key: law for law, key in SHORT_NAMES.items()}
#: The gains of a loop, with what their unit has beside those of the signals.
GAINS = {SHORT_NAMES.get(law, law): time for law, time in pid_keys.GAINS.items()}


def loops_of(law: StepLaw) -> dict[str, PidBlock]:
    """Return the PID loops of a law by what a study file calls them."""
    return {block.owner: block for block in law.blocks if isinstance(block, PidBlock)}


def parameter_of(loop: PidBlock, key: str) -> str:
    """Return the law's name for a key of a loop.

    Examples
    --------
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> parameter_of(PidBlock.of(Signal("level", "m"), PidForm(), Signal("pump", "V")), "gain")
    'level.proportional_gain'
    """
    return path(loop.owner, LAW_NAMES.get(key, key))


def key_of(parameter: Signal) -> str:
    """Return what a study file calls a parameter of a loop."""
    return SHORT_NAMES.get(parameter.part, parameter.part)


@dataclass(frozen=True)
class LawParameters:
    """How the parameters of one law are named and written in a study file.

    Parameters
    ----------
    known : mapping
        Parameter of the law to its signal.
    loops : mapping
        As of `loops_of`.
    """

    known: Mapping[str, Signal]
    loops: Mapping[str, PidBlock] = field(default_factory=dict)

    def read(self, table: TableReader, key: str, name: str, expected: str, remedy: str) -> float:
        """Return the value at a key of a table, which is one of the law's parameter `name`."""
        for loop in self.loops.values():
            for gain, time in GAINS.items():
                if parameter_of(loop, gain) == name:
                    return read_gain(
                        table, key, loop.moved, loop.measurement,
                        expected=expected, remedy=remedy, time=time,
                    )  # fmt: skip
        parameter = self.known[name]
        # The law's "V/V" is a number, but not every number is in V/V.
        unit = unit_of_gain(parameter, Signal(""))
        parts = split_quantity(table.raw(key))
        if parts is not None and parts[1] and not has_units_of(parts[1], parameter.unit):
            raise table.wrong(
                key,
                f"{expected} in {parameter.unit}" if parameter.unit != "1" else expected,
                f"{parts[1]!r} is no unit of it: {remedy}",
            )
        return table.quantity(key, unit, expected, remedy)


def law_parameters(law: StepLaw) -> LawParameters:
    """Return the parameters of a law, with its loops."""
    return LawParameters({parameter.name: parameter for parameter in law.parameters}, loops_of(law))


def new_name(old: str, known: Collection[str]) -> str:
    """Return what a numbered name of a parameter is called now; empty where that is unknown.

    A parameter of former versions, "integral_time_2", was that of the second of its kind.

    Examples
    --------
    >>> new_name("integral_time_2", ["level_1.integral_time", "level_2.integral_time"])
    'level_2.integral_time'
    >>> new_name("feedback_1_2", ["pump.feedback.level_1", "pump.feedback.level_2"])
    'pump.feedback.level_2'
    """
    found = re.fullmatch(r"(\w+?)_(?:(\d+)_)?(\d+)", old)
    if found is None:
        return ""
    kind, row, place = found[1], int(found[2] or 1), int(found[3])
    whole, divided = {kind}, set(kind.split("_", 1))
    owned = {name: set(name.split(".")) for name in known}
    alike = [name for name, parts in owned.items() if whole <= parts or divided <= parts]
    columns = len(alike)
    if found[2]:
        # Those of a matrix stand row by row; a row is of one owner.
        columns = sum(name.split(".")[0] == alike[0].split(".")[0] for name in alike)
    number = (row - 1) * columns + place - 1
    return alike[number] if 0 < place <= columns and number < len(alike) else ""


def check_law_range(table: TableReader, key: str, parameter: Signal, value: float) -> None:
    """Refuse the value of a parameter [its unit], read at a key, outside of what its law takes.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> table = TableReader(parse(b"lag = '1e6 h'", "a.toml"), (), None)
    >>> check_law_range(table, "lag", Signal("feedforward.rain.lag", "s", low=0.0, high=1e9), 3.6e9)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: a.toml, line 1, lag: got '1e6 h', expected a value from 0 to \
2.778e+05 h; correct the number or its unit.
    """
    if parameter.low <= value <= parameter.high:
        return
    if value:
        ends = parameter.low, parameter.high
        low, high = (in_written_unit(table, key, value, end) for end in ends)
    else:  # zero does not tell the size of its unit
        port = at_port(parameter)
        low, high = (f"{end:g} {port.unit}".removesuffix(" 1") for end in (port.low, port.high))
    if parameter.low == -parameter.high:
        expected = f"a size of at most {high.lstrip('-')}"
    else:
        expected = f"a value from {low.partition(' ')[0]} to {high}"
    raise table.wrong(key, expected, "correct the number or its unit")


def in_written_unit(table: TableReader, key: str, value: float, shown: float) -> str:
    """Return a number in the unit of the quantity at a key, which was read as `value`, not zero."""
    written = table.raw(key)
    parts = split_quantity(written if isinstance(written, str) else repr(written))
    assert parts is not None  # a quantity was read of it
    number, unit = parts
    return f"{shown * float(number) / value:.4g} {unit}".strip()
