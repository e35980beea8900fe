"""One PID loop of a control scheme, read key by key."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.pid_keys import PARAMETERS
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.request import in_shown_unit
from clepsydra.process import told
from clepsydra.process.declared import read_fields
from clepsydra.process.errors_at import errors_at
from clepsydra.process.gains import read_gain
from clepsydra.process.signal_values import read_in_range, read_rate, read_value
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.law_parameters import GAINS, LAW_NAMES, check_law_range, key_of

_ENDS = ("setpoint_low", "setpoint_high")
_GAINS = 'of the parallel algorithm, in place of the times, as in `"0.1 %/%/min"` and `"3 %/% min"`'
_PARALLEL = 'remove it, or write algorithm = "parallel"'
_SETPOINTS = "of an inner loop: between which values its setpoint may be asked for"
_GAP = "of gap action: half the width of the gap, and the share of the error that acts within it"


@dataclass(frozen=True)
class Setting:
    """What a loop may be set to, beside its quantity in `PARAMETERS`.

    Parameters
    ----------
    words : str
        What it is, in the words of a study file.
    elsewhere : str
        What to do with it where a loop of this form has none.
    without : mapping
        Actions that it belongs to, to those that do without it.
    usual : bool
        Whether it is taken as usual where it is not written.
    """

    words: str
    elsewhere: str = "remove it, or change actions or error"
    without: Mapping[str, str] = field(default_factory=dict)
    usual: bool = False

    def told(self, key: str) -> dict[str, Any]:
        """Return its schema: text where its quantity must have a unit."""
        unit = PARAMETERS[LAW_NAMES.get(key, key)].unit if key not in _ENDS else ""
        if unit in ("s", "{measurement}/s"):
            return told.text(self.words)
        return told.quantity(self.words)


#: All but the rate of saturation, which belongs to laws of variable structure.
_SETTINGS = {
    "gain": Setting("K, above zero: the action gives it its sign"),
    "integral_gain": Setting(_GAINS, _PARALLEL),
    "derivative_gain": Setting(_GAINS, _PARALLEL),
    "integral_time": Setting("Ti [s], with I", without={"PI": "P", "PID": "PD"}),
    "derivative_time": Setting("Td [s], with D", without={"PD": "P", "PID": "PI"}),
    "filter_time": Setting("of the parallel algorithm with D [s]", _PARALLEL),
    "derivative_filter": Setting("Td over the time constant of its filter", usual=True),
    "setpoint_weight": Setting(
        "share of the setpoint in the proportional part, 0 to 1", usual=True
    ),
    "gap": Setting(_GAP, 'remove it, or write error = "gap"'),
    "gap_gain": Setting(_GAP, 'remove it, or write error = "gap"'),
    "squared_error_scale": Setting(
        "of squared action: the error at which the gain is K",
        'remove it, or write error = "squared"',
    ),
    "setpoint_ramp": Setting('fastest change of the setpoint, `"5 %/min"`'),
    "tracking_time": Setting(
        "of back-calculation [s]",
        'remove it, or write anti_windup = "back_calculation"',
        usual=True,
    ),
    **dict.fromkeys(
        _ENDS,
        Setting(
            _SETPOINTS, "remove it: it limits what an outer loop may ask for, and here is none"
        ),
    ),
}
SETTINGS = {
    "action": told.choice(
        '`"reverse"`: the output rises when the measurement falls; `"direct"`: it falls',
        ("reverse", "direct"),
    ),
    **{key: setting.told(key) for key, setting in _SETTINGS.items()},
}


def read_form(table: TableReader, key: str, known: Mapping[str, Any]) -> PidForm:
    """Return the form of a loop; only its actions must be written.

    Raises
    ------
    InputError
        There are no actions, a word is unknown, or the options contradict each other.
    """
    if not table.has("actions"):
        raise table.wrong("actions", "one of P, PI, PD, PID", 'write as in actions = "PI"')
    with errors_at(table):
        return PidForm(**read_fields(PidForm, table))


class PidTable:
    """The settings of one loop.

    Parameters
    ----------
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
    """

    def __init__(self, table: TableReader, block: PidBlock) -> None:
        self.table, self.block = table, block
        self.values: dict[str, float] = {}
        self.places: dict[str, str] = {}
        self.assumed: list[str] = []
        keys = {key_of(parameter): parameter for parameter in block.parameters()}
        for key in table.present:
            if key in _SETTINGS and key not in keys:
                raise table.wrong(
                    key,
                    f"a setting of this {_words(block)} ({', '.join(keys)})",
                    _remedy(key, block),
                )
        self._sign = self._action()
        for key, parameter in keys.items():
            value = self.values[parameter.name] = self._value(key, parameter)
            if table.has(key):
                check_law_range(table, key, parameter, value)
            self.places[parameter.name] = table.place(key)
        low, high = (path(block.owner, f"{end}_limit") for end in _ENDS)
        if low in self.values and not self.values[low] < self.values[high]:
            key = next(filter(table.has, _ENDS), _ENDS[1])
            raise table.wrong(
                key, "a low limit of the setpoint below the high one", "exchange or correct them"
            )

    def _action(self) -> float:
        remedy = (
            f'write action = "reverse" if {self.block.moved.name} has to rise when '
            f'{self.block.measurement.name} falls, else action = "direct"'
        )
        if not self.table.has("action"):
            raise self.table.wrong("action", "reverse or direct", remedy)
        found = self.table.choice("action", ("reverse", "direct"), "reverse")
        return 1.0 if found == "reverse" else -1.0

    def _value(self, key: str, parameter: Signal) -> float:
        """Return what is written at a key, read as the unit that its quantity has."""
        table, block = self.table, self.block
        if key in _ENDS:
            return self._end(key)
        if _SETTINGS[key].usual and not table.has(key):
            usual = self._tracking_time() if key == "tracking_time" else parameter.initial
            return self._taken(key, usual, parameter)
        unit = PARAMETERS[parameter.part].unit
        if unit == "s":
            return table.quantity(key, "s", "a time", self._without(key), above=0.0)
        if unit == "1":
            low, high = parameter.low, parameter.high
            remedy = f"give one from {low:g} to {high:g}"
            return table.quantity(key, "1", "a number", remedy, at_least=low, at_most=high)
        if unit == "{measurement}/s":
            remedy = "give the fastest of the setpoint"
            return read_rate(table, key, block.measurement, "a rate of change", remedy)
        if unit == "{measurement}":
            remedy = "give it in the unit of the measurement"
            value = read_value(table, key, block.measurement, "a deviation", remedy, change=True)
            if not value > 0.0:
                raise table.wrong(key, "a deviation above 0", "correct it")
            return value
        return self._sign * read_gain(
            table, key, block.moved, block.measurement,
            expected=f"a {key.replace('_', ' ')}",
            remedy="write it above zero; its sign is that of the action",
            time=GAINS[key], above=0.0,
        )  # fmt: skip

    def _without(self, key: str) -> str:
        """Return what to do where a time is missing."""
        if key == "tracking_time":
            return "leave it out"
        without = _SETTINGS[key].without.get(self.block.form.actions)
        if without:
            return f'without this action write actions = "{without}"'
        return "give the time constant of the derivative's filter"

    def _end(self, key: str) -> float:
        """Return an end of what an outer loop may ask for."""
        table, signal = self.table, self.block.measurement
        if table.has(key):
            return read_in_range(table, key, signal, "a limit", "give a value of the measurement")
        end = signal.low if key == _ENDS[0] else signal.high
        if not math.isfinite(end):
            raise table.wrong(key, f"a limit, since {signal.name} has no finite range", "add it")
        return self._taken(key, end, signal)

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
        self.assumed.append(f"{key} = {in_shown_unit(signal, value, digits=4)}")
        return value


def _words(block: PidBlock) -> str:
    form = block.form
    error = "" if form.error == "linear" else f" with {form.error} error"
    return f"{form.algorithm} {form.actions} loop{error}"


def _remedy(key: str, block: PidBlock) -> str:
    """Return what makes a setting one of a loop."""
    found = _SETTINGS[key].elsewhere
    usual = found == Setting.elsewhere and key != "setpoint_weight"
    if usual and block.form.algorithm == "parallel":
        return "remove it: the parallel algorithm has a gain for each action"
    return found
