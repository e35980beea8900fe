"""The settings of a controller in the words and units in which its table shows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import from_si
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.gain_units import has_range, percent_gain
from clepsydra.interface.quantities import arguments, with_unit
from clepsydra.process.process import Process
from clepsydra.process.table_reader import shown_value
from clepsydra.report.analysis_tables import Grid
from clepsydra.report.facts import gain_factor, gain_unit, known_signal
from clepsydra.report.quantities import number_text, unit_text
from clepsydra.studies.file.law_parameters import GAINS, LAW_NAMES, LoopSignals, law_parameters
from clepsydra.studies.file.law_range import check_law_range

#: What the table calls a key of a study file, where it has a symbol.
SYMBOLS = {"gain": "K", "integral_time": "Ti", "derivative_time": "Td", "setpoint_weight": "b"}
_PLACE = "values"
_REMEDY = "give text with a unit, or a number in the unit of the table"


def loops_of(controller: Controller, process: Process) -> dict[str, LoopSignals]:
    """Return the PID loops of a controller by the names that a user calls them.

    A loop of a control scheme has a name of its own, any other that of its measurement.
    """
    found = {}
    for block in controller.law.blocks:
        if isinstance(block, PidBlock):
            measurement, moved = (
                known_signal(process, signal) for signal in (block.measurement, block.moved)
            )
            name = measurement.name if block.name.startswith("loop ") else block.name
            found[name] = LoopSignals(block.number, measurement, moved)
    return found


def values_of(
    controller: Controller, process: Process, values: Mapping[str, Any]
) -> dict[str, float]:
    """Return the parameters of the law that settings stand for [SI].

    Parameters
    ----------
    controller : Controller
    process : Process
        Lends display units and ranges.
    values : mapping
        As for `clepsydra.interface.controller.Controller.with_values`.

    Raises
    ------
    InputError
    """
    require_type(
        values, Mapping, _PLACE, "loops with their settings", 'write as in {"level_1": {"K": 6.0}}'
    )
    loops = loops_of(controller, process)
    law = {parameter.name: parameter for parameter in controller.law.parameters}
    found: dict[str, float] = {}
    for name, given in values.items():
        if name in loops:
            found |= _of_loop(controller, process, loops, name, given)
        elif name in law and not isinstance(given, Mapping):
            found[name] = _read(controller, process, loops, _PLACE, name, name, given)
        else:
            known = (*loops, *(law if not loops else ()))
            words = "a loop of this controller" if loops else f"a parameter of {controller.name}"
            raise InputError(
                _PLACE, str(name)[:60], f"{words} ({', '.join(known)})",
                suggestion(name, known, "choose one of them"),
            )  # fmt: skip
    return found


def _of_loop(
    controller: Controller,
    process: Process,
    loops: dict[str, LoopSignals],
    name: str,
    given: Any,
) -> dict[str, float]:
    place, loop = f"{_PLACE}, {name}", loops[name]
    require_type(given, Mapping, place, "settings with their values", 'write as in {"K": 6.0}')
    found = {}
    for word, value in given.items():
        key = key_of(controller, loop, word, place)
        parameter = loop.parameter(key)
        text = with_unit(value, unit_of(controller, loop, key))
        number = _read(controller, process, loops, place, word, parameter, text)
        if key in GAINS:
            if number < 0.0:
                raise InputError(
                    f"{place}, {word}", shown_value(value),
                    "a gain from 0: the action of the loop gives it its sign", "leave the sign out",
                )  # fmt: skip
            number = -number if controller.values[parameter] < 0.0 else number
        found[parameter] = number
    time, tracking = (loop.parameter(key) for key in ("integral_time", "tracking_time"))
    follows = controller.values.get(tracking) == controller.values.get(time)
    if time in found and tracking in controller.values and tracking not in found and follows:
        found[tracking] = found[time]
    return found


def key_of(controller: Controller, loop: LoopSignals, word: object, place: str) -> str:
    """Return the key of study files for a word of the table; refuse what is none of the loop."""
    keys = keys_of(controller, loop)
    by_word = {SYMBOLS.get(key, key): key for key in keys}
    key = by_word.get(str(word), str(word))
    if key in keys:
        return key
    raise InputError(
        place, str(word)[:60], f"a setting of this loop ({', '.join(by_word)})",
        suggestion(word, by_word, "choose one of them"),
    )  # fmt: skip


def unit_of(controller: Controller, loop: LoopSignals, key: str) -> str:
    """Return the unit in which the table shows a setting."""
    if key in GAINS:
        return table_unit(loop) + {"1": "", "1/s": "/s", "s": " s"}[GAINS[key]]
    law = {parameter.name: parameter for parameter in controller.law.parameters}
    return law[loop.parameter(key)].shown_unit


def keys_of(controller: Controller, loop: LoopSignals) -> list[str]:
    """Return the keys of study files that a loop has as parameters of its law."""
    keys = {parameter: key for key, parameter in LAW_NAMES.items()}
    ending = f"_{loop.number}"
    own = {parameter.name for block in controller.law.blocks if isinstance(block, PidBlock)
           and block.number == loop.number for parameter in block.parameters()}  # fmt: skip
    stems = [name.removesuffix(ending) for name in controller.values if name in own]
    return [keys.get(stem, stem) for stem in stems]


def table_unit(loop: LoopSignals) -> str:
    """Return the unit in which the table shows K: %/%, or that of the signals without a range."""
    if has_range(loop.measurement) and has_range(loop.moved):
        return "%/%"
    above, below = (f"({s.shown_unit})" for s in (loop.moved, loop.measurement))
    return f"{above}/{below}"


def _read(
    controller: Controller,
    process: Process,
    loops: dict[str, LoopSignals],
    place: str,
    word: str,
    parameter: str,
    value: Any,
) -> float:
    parameters = law_parameters(controller, process, loops)
    signal = parameters.known[parameter]
    unit = signal.shown_unit if "/" not in signal.shown_unit else "1"
    table = arguments(place, {word: with_unit(value, unit)})
    found = parameters.read(table, word, parameter, "a setting", _REMEDY)
    check_law_range(table, word, signal, found)
    return found


def settings_grid(controller: Controller, process: Process) -> Grid | None:
    """Return the settings of each loop in the words and units of `values_of`; None for none."""
    loops = loops_of(controller, process)
    if not loops:
        return None
    law = {parameter.name: parameter for parameter in controller.law.parameters}
    keys = list(dict.fromkeys(key for loop in loops.values() for key in keys_of(controller, loop)))
    rows = []
    for name, loop in loops.items():
        own = keys_of(controller, loop)
        cells = [_cell(controller, loop, key, law) if key in own else "" for key in keys]
        rows.append((name, loop.moved.name, *cells))
    return Grid(
        "Settings", ("loop", "moves", *(SYMBOLS.get(key, key) for key in keys)), tuple(rows)
    )


def _cell(controller: Controller, loop: LoopSignals, key: str, law: Mapping[str, Signal]) -> str:
    parameter = loop.parameter(key)
    value = controller.values[parameter]
    if key not in GAINS:
        signal = law[parameter]
        shown = from_si(value, signal.unit, signal.shown_unit)
        return f"{number_text(shown, 4)} {unit_text(signal.shown_unit)}".strip()
    time = {"1": "", "1/s": "/s", "s": " s"}[GAINS[key]]
    if table_unit(loop) == "%/%":
        return f"{number_text(abs(percent_gain(value, loop.measurement, loop.moved)), 4)} %/%{time}"
    shown = abs(value) * gain_factor(loop.measurement, loop.moved)
    return f"{number_text(shown, 4)} {gain_unit(loop.measurement, loop.moved)}{time}".strip()
