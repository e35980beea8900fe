"""Settings of a controller, read in the words and units in which its table shows them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import is_finite_number, require_type
from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion, symbol_of
from clepsydra.designs.gain_units import gain_factor, percent_gain
from clepsydra.interface.loop_settings import Setting
from clepsydra.interface.quantities import arguments, with_unit
from clepsydra.process.joined_unit import BESIDE
from clepsydra.process.table_reader import shown_value
from clepsydra.report.facts import gain_unit
from clepsydra.studies.file.law_parameters import (
    GAINS,
    check_law_range,
    key_of,
    law_parameters,
    loops_of,
    new_name,
    parameter_of,
)

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.structure.pid_block import PidBlock

_PLACE = "values"


def values_of(controller: Controller, values: Mapping[str, Any]) -> dict[str, float]:
    """Return the parameters of the law that settings stand for [SI].

    Parameters
    ----------
    controller : Controller
    values : mapping
        As for `clepsydra.interface.controller.Controller.with_values`.

    Raises
    ------
    InputError
    """
    require_type(
        values, Mapping, _PLACE, "loops with their settings", 'write as in {"level_1": {"K": 6.0}}'
    )
    loops = loops_of(controller.law)
    law = {parameter.name: parameter for parameter in controller.law.parameters}
    found: dict[str, float] = {}
    for name, given in values.items():
        if name in loops:
            found |= _of_loop(controller, loops[name], name, given)
        elif name in law and not isinstance(given, Mapping):
            found[name] = _read(controller, _PLACE, name, name, given, law[name].unit)
        else:
            known = (*loops, *(law if not loops else ()))
            now = new_name(str(name), law)
            words = "a loop of this controller" if loops else f"a parameter of {controller.name}"
            raise InputError(
                _PLACE, str(name)[:60], f"{words} ({', '.join(known)})",
                f"write {now}" if now else suggestion(name, known, "choose one of them"),
            )  # fmt: skip
    if controller.law.check is not None:
        controller.law.check(controller.law, {**controller.values, **found}, _PLACE)
    return found


def _of_loop(controller: Controller, loop: PidBlock, name: str, given: Any) -> dict[str, float]:
    place = f"{_PLACE}, {name}"
    require_type(given, Mapping, place, "settings with their values", 'write as in {"K": 6.0}')
    found = {}
    for word, value in given.items():
        value = value.text if isinstance(value, Setting) else value
        key = setting_of(loop, word, place)
        parameter = parameter_of(loop, key)
        unit = unit_of(controller, loop, key)
        if key in GAINS:
            _refuse_without_unit(f"{place}, {word}", loop, key, value)
        number = _read(controller, place, word, parameter, with_unit(value, unit), unit)
        if key in GAINS:
            if number < 0.0:
                raise InputError(
                    f"{place}, {word}", shown_value(value),
                    "a gain from 0: the action of the loop gives it its sign", "leave the sign out",
                )  # fmt: skip
            number = -number if controller.values[parameter] < 0.0 else number
        found[parameter] = number
    time, tracking = (parameter_of(loop, key) for key in ("integral_time", "tracking_time"))
    follows = controller.values.get(tracking) == controller.values.get(time)
    if time in found and tracking in controller.values and tracking not in found and follows:
        found[tracking] = found[time]
    return found


def _refuse_without_unit(place: str, loop: PidBlock, key: str, value: Any) -> None:
    """Refuse a bare gain that would be another one in the units of its signals than in percent."""
    signals = loop.measurement, loop.moved
    if not is_finite_number(value) or not all(signal.has_range for signal in signals):
        return
    shown, percent = gain_factor(*signals), percent_gain(1.0, *signals)
    if value == 0.0 or math.isclose(shown, percent, rel_tol=1e-9):
        return
    beside = BESIDE[GAINS[key]]
    own, of_range = f"{gain_unit(*signals)}{beside}".strip(), f"%/%{beside}"
    raise InputError(
        place, value,
        f"a gain with its unit: {value:g} {own} is {value / shown * percent:.4g} {of_range}, and "
        f"{value:g} {of_range} is {value / percent * shown:.4g} {own}",
        f'write "{value:g} {own}" or "{value:g} {of_range}"',
    )  # fmt: skip


def setting_of(loop: PidBlock, word: object, place: str) -> str:
    """Return the key of study files for a word of the table; refuse what is none of the loop."""
    keys = keys_of(loop)
    by_word = {symbol_of(key): key for key in keys}
    key = by_word.get(str(word), str(word))
    if key in keys:
        return key
    raise InputError(
        place, str(word)[:60], f"a setting of this loop ({', '.join(by_word)})",
        suggestion(word, [*by_word, *keys], "choose one of them"),
    )  # fmt: skip


def unit_of(controller: Controller, loop: PidBlock, key: str) -> str:
    """Return the unit in which the table shows a setting."""
    if key in GAINS:
        return table_unit(loop) + BESIDE[GAINS[key]]
    law = {parameter.name: parameter for parameter in controller.law.parameters}
    return law[parameter_of(loop, key)].shown_unit


def keys_of(loop: PidBlock) -> list[str]:
    """Return the keys of study files that a loop has as parameters of its law."""
    return [key_of(parameter) for parameter in loop.parameters()]


def table_unit(loop: PidBlock) -> str:
    """Return the unit in which the table shows K: %/%, or that of the signals without a range."""
    if loop.measurement.has_range and loop.moved.has_range:
        return "%/%"
    above, below = (f"({s.shown_unit})" for s in (loop.moved, loop.measurement))
    return f"{above}/{below}"


def _read(
    controller: Controller, place: str, word: str, parameter: str, value: Any, unit: str
) -> float:
    """Return a setting, whose unit is this one where it is a bare number."""
    parameters = law_parameters(controller.law)
    table = arguments(place, {word: with_unit(value, unit)})
    remedy = "give a number" if unit == "1" else f"give text with a unit, or a number in {unit}"
    # A bare number is one of `Controller.values`, in every bit and also where no unit has a name.
    found = (
        float(value)
        if is_finite_number(value)
        else parameters.read(table, word, parameter, "a setting", remedy)
    )
    check_law_range(table, word, parameters.known[parameter], found)
    return found
