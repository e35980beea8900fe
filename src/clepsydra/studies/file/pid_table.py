"""One PID loop of a control scheme, read key by key."""

from __future__ import annotations

import math
from typing import Any, get_args

from clepsydra.base.signal import Signal, path
from clepsydra.base.units import from_si
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.pid_form import (
    Actions,
    Algorithm,
    DerivativeOn,
    ErrorShape,
    PidForm,
)
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.gains import check_in_range, read_gain, read_rate, read_value
from clepsydra.studies.file.law_parameters import GAINS, key_of
from clepsydra.studies.file.law_range import check_law_range
from clepsydra.studies.file.placed import placed

_FORM = {
    "actions": get_args(Actions),
    "algorithm": get_args(Algorithm),
    "derivative_on": get_args(DerivativeOn),
    "error": get_args(ErrorShape),
    "anti_windup": get_args(AntiWindup),
}
#: Actions without the one that a time belongs to.
_WITHOUT = {
    "integral_time": {"PI": "P", "PID": "PD"},
    "derivative_time": {"PD": "P", "PID": "PI"},
}
_WIRING_KEYS = ("measurement", "setpoint", "output", "action", "remote_setpoint")
_SETTINGS = (
    "gain",
    "integral_time",
    "derivative_time",
    "derivative_filter",
    "integral_gain",
    "derivative_gain",
    "filter_time",
    "setpoint_weight",
    "gap",
    "gap_gain",
    "squared_error_scale",
    "setpoint_ramp",
    "tracking_time",
    "setpoint_low",
    "setpoint_high",
)
LOOP_KEYS = (*_WIRING_KEYS, *_FORM, *_SETTINGS)


def read_form(table: TableReader) -> PidForm:
    """Return the form of a loop; only its actions must be written.

    Raises
    ------
    InputError
        There are no actions, a word is unknown, or the options contradict each other.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> text = b"actions = 'PI'\\nsetpoint_ramp = '1 %/min'"
    >>> read_form(TableReader(parse(text, "study.toml"), (), LOOP_KEYS)).setpoint_ramp
    True
    """
    if not table.has("actions"):
        raise table.refused(
            "actions", "no actions", "one of P, PI, PD, PID", 'write as in actions = "PI"'
        )
    chosen: dict[str, Any] = {
        key: table.choice(key, words, words[0]) for key, words in _FORM.items() if table.has(key)
    }
    with placed(table):
        return PidForm(
            **chosen,
            setpoint_ramp=table.has("setpoint_ramp"),
            remote_setpoint=table.flag("remote_setpoint", default=False),
        )


class PidTable:
    """The settings of one loop.

    Parameters
    ----------
    table : TableReader
    block : PidBlock
        It says which parameters there are.

    Attributes
    ----------
    values : dict
        Parameter of the law to its value.
    places : dict
        Parameter of the law to where it was written.
    assumed : list of str
        What was not written, with the value taken for it.

    Raises
    ------
    InputError
        A setting is missing, wrong, or none of this form of loop.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> level = Signal("level", "m", low=0.0, high=5.0)
    >>> pump = Signal("pump", "V", low=0.0, high=10.0)
    >>> text = b'''actions = "PI"
    ... action = "direct"
    ... gain = "2 %/%"
    ... integral_time = "5 min"
    ... '''
    >>> table = TableReader(parse(text, "study.toml"), (), LOOP_KEYS)
    >>> read = PidTable(table, PidBlock.of(level, read_form(table), pump))
    >>> read.values["level.proportional_gain"], read.values["level.integral_time"], read.assumed
    (-4.0, 300.0, ['setpoint_weight = 1', 'tracking_time = 300 s'])
    """

    def __init__(self, table: TableReader, block: PidBlock) -> None:
        self.table, self.block = table, block
        self.values: dict[str, float] = {}
        self.places: dict[str, str] = {}
        self.assumed: list[str] = []
        keys = {key_of(parameter): parameter for parameter in block.parameters()}
        for key in table.present:
            if key in _SETTINGS and key not in keys:
                raise table.refused(
                    key,
                    table.written(key),
                    f"a setting of this {_words(block)} ({', '.join(keys)})",
                    _remedy(key, block),
                )
        self._sign = self._action()
        for key, parameter in keys.items():
            value = self.values[parameter.name] = self._value(key, parameter)
            if table.has(key):
                check_law_range(table, key, parameter, value)
            self.places[parameter.name] = table.place(key)
        low, high = (path(block.owner, f"setpoint_{end}_limit") for end in ("low", "high"))
        if low in self.values and not self.values[low] < self.values[high]:
            raise table.refused(
                "setpoint_low" if table.has("setpoint_low") else "setpoint_high",
                table.written("setpoint_low" if table.has("setpoint_low") else "setpoint_high"),
                "a low limit of the setpoint below the high one",
                "exchange or correct them",
            )

    def _action(self) -> float:
        remedy = (
            f'write action = "reverse" if {self.block.moved.name} has to rise when '
            f'{self.block.measurement.name} falls, else action = "direct"'
        )
        if not self.table.has("action"):
            raise self.table.refused("action", "no action", "reverse or direct", remedy)
        found = self.table.choice("action", ("reverse", "direct"), "reverse")
        return 1.0 if found == "reverse" else -1.0

    def _value(self, key: str, parameter: Signal) -> float:
        table, block = self.table, self.block
        if key in GAINS:
            expected = f"a {key.replace('_', ' ')}"
            remedy = "write it above zero; its sign is that of the action"
            return self._sign * read_gain(
                table, key, block.moved, block.measurement,
                expected=expected, remedy=remedy, time=GAINS[key], above=0.0,
            )  # fmt: skip
        if key in ("integral_time", "derivative_time", "filter_time"):
            without = _WITHOUT.get(key, {}).get(block.form.actions)
            remedy = (
                f'without this action write actions = "{without}"'
                if without
                else "give the time constant of the derivative's filter"
            )
            return table.quantity(key, "s", "a time", remedy, above=0.0)
        if key == "tracking_time":
            if table.has(key):
                return table.quantity(key, "s", "a time", "leave it out", above=0.0)
            return self._taken(key, self._tracking_time(), parameter)
        if key in ("setpoint_weight", "derivative_filter"):
            if not table.has(key):
                return self._taken(key, parameter.initial, parameter)
            return self._number(key, parameter)
        if key == "gap_gain":
            return self._number(key, parameter)
        if key == "setpoint_ramp":
            return read_rate(
                table,
                key,
                block.measurement,
                "a rate of change",
                "give the fastest of the setpoint",
            )
        if key in ("setpoint_low", "setpoint_high"):
            return self._limit(key, parameter)
        value = read_value(
            table, key, block.measurement, "a deviation", "give it in the unit of the measurement",
            change=True,
        )  # fmt: skip
        if not value > 0.0:
            raise table.refused(key, table.written(key), "a deviation above 0", "correct it")
        return value

    def _number(self, key: str, parameter: Signal) -> float:
        return self.table.quantity(
            key,
            "1",
            "a number",
            f"give one from {parameter.low:g} to {parameter.high:g}",
            at_least=parameter.low,
            at_most=parameter.high,
        )

    def _limit(self, key: str, parameter: Signal) -> float:
        """Return an end of what an outer loop may ask for."""
        signal = self.block.measurement
        if not self.table.has(key):
            end = signal.low if key == "setpoint_low" else signal.high
            if not math.isfinite(end):
                raise self.table.refused(
                    key, f"no {key}", f"a limit, since {signal.name} has no finite range", "add it"
                )
            return self._taken(key, end, signal)
        value = read_value(self.table, key, signal, "a limit", "give a value of the measurement")
        check_in_range(self.table, key, signal, value, "a limit")
        return value

    def _tracking_time(self) -> float:
        """Return Ti, or √(Ti Td) with derivative action."""
        values = {Signal(name).part: value for name, value in self.values.items()}
        if self.block.form.algorithm == "parallel":
            gain = values["proportional_gain"]
            integral_time = gain / values["integral_gain"]
            derivative_time = values.get("derivative_gain", 0.0) / gain
        else:
            integral_time = values["integral_time"]
            derivative_time = values.get("derivative_time", 0.0)
        return math.sqrt(integral_time * derivative_time) if derivative_time else integral_time

    def _taken(self, key: str, value: float, signal: Signal) -> float:
        shown = from_si(value, signal.unit, signal.shown_unit)
        unit = "" if signal.shown_unit == "1" else f" {signal.shown_unit}"
        self.assumed.append(f"{key} = {shown:.4g}{unit}")
        return value


def _words(block: PidBlock) -> str:
    form = block.form
    error = "" if form.error == "linear" else f" with {form.error} error"
    return f"{form.algorithm} {form.actions} loop{error}"


def _remedy(key: str, block: PidBlock) -> str:
    """Return what makes a setting one of a loop."""
    form = block.form
    if key.startswith("setpoint_") and key.endswith(("low", "high")):
        return "remove it: it limits what an outer loop may ask for, and here is none"
    if key == "tracking_time":
        return 'remove it, or write anti_windup = "back_calculation"'
    if key in ("gap", "gap_gain"):
        return 'remove it, or write error = "gap"'
    if key == "squared_error_scale":
        return 'remove it, or write error = "squared"'
    if key in ("integral_gain", "derivative_gain", "filter_time"):
        return 'remove it, or write algorithm = "parallel"'
    if form.algorithm == "parallel" and key != "setpoint_weight":
        return "remove it: the parallel algorithm has a gain for each action"
    return "remove it, or change actions or error"
