"""The designs of a linear model as functions of a plant."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec

from clepsydra.base.keywords import check_keywords
from clepsydra.controllers import controller as inner
from clepsydra.designs.arguments.of_model import OfModel
from clepsydra.interface.controller import Controller, of_plant
from clepsydra.interface.quantities import arguments, with_unit
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.designs.arguments.argument import Argument
    from clepsydra.interface.plant import Plant
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.process.process import Process

P = ParamSpec("P")

_MODEL = re.compile(r"^    model : LinearModel\n(?:        .*\n)*", re.MULTILINE)
#: What designs share is said once: an argument where a design does not tell of its own.
_PAIRED = "    Returns\n    -------\n    Controller\n        Loop i for the i-th pair.\n\n"
_SHARED = {
    "pairing": "    pairing : sequence of (output, input), or mapping, optional\n"
    "        The one that the relative gains suggest if left out.\n",
    "form": "    form : PidForm, optional\n        PI in ISA form if left out.\n",
}
_OTHERS = re.compile(r"`designs\.[a-z_.]*design_(\w+)`")
_PLANT = "    plant : Plant, str or Path\n        Or as for `cl.load`.\n"
_QUANTITIES = """
    Times, angles and rates may be text with a unit, "20 s", "60 deg", or a number in the unit in
    [brackets]; what belongs to a signal text with a unit, "5 cm" or "10 %" of its range, or a
    number in its display unit, the one that the printed plant shows.
"""


def of_model(
    design: Callable[Concatenate[LinearModel, P], inner.Controller],
    declared: Mapping[str, Argument] = MappingProxyType({}),
) -> Callable[Concatenate[Subject, P], Controller]:
    """Return a design as a function of a plant; its other arguments stay.

    Those that it declares may be what people write as well: text with a unit besides numbers.
    """
    signature = inspect.signature(design)
    place, (_, *known) = _called(design), signature.parameters

    @functools.wraps(design)
    def designed(plant: Subject, *args: P.args, **kwargs: P.kwargs) -> Controller:
        check_keywords(place, kwargs, known)
        own = plant_of(plant)
        _, *given_ones = signature.bind(None, *args, **kwargs).arguments.items()
        given = dict(given_ones)
        found = {
            name: _read(place, declared[name], value, given, own) if name in declared else value
            for name, value in given.items()
        }
        return of_plant(design(own.linear, **found), own)  # type: ignore[call-arg]

    first, *others = signature.parameters.values()
    of_plant_ = first.replace(name="plant", annotation="Subject")
    designed.__signature__ = signature.replace(parameters=[of_plant_, *others])  # type: ignore[attr-defined]
    designed.declared = declared  # type: ignore[attr-defined]
    designed.__doc__ = _documented(inspect.getdoc(design) or "", signature.parameters)
    return designed


def _called(design: Callable[..., Any]) -> str:
    """Return what messages call a design."""
    return design.__name__.removeprefix("design_").replace("_", " ")


def _read(
    place: str, argument: Argument, value: Any, given: Mapping[str, Any], plant: Plant
) -> Any:
    """Return an argument as the design takes it, from text or a number in display units."""
    if isinstance(value, inner.Controller) or value is None:
        return value
    if argument.given == "of signals":
        value = _with_units(value, given, plant.process)
    elif argument.given == "table" and isinstance(value, Mapping):
        value = {what: dict(weights) for what, weights in value.items()}
    elif argument.given != "quantity" or not _has_text(value):
        return value
    table = arguments(place, {**given, argument.name: value})
    found = argument.read(table, argument.name, plant.process)
    return found.of(plant.linear) if isinstance(found, OfModel) else found


def _has_text(value: Any) -> bool:
    entries = value if isinstance(value, list) else [value]
    return any(isinstance(each, str) for each in entries)


def _with_units(value: Any, given: Mapping[str, Any], process: Process) -> Any:
    """Return numbers that belong to signals with the display units of these."""
    if isinstance(value, Mapping):
        units = {s.name: s.shown_unit for s in (*process.inputs, *process.measurements)}
        return {key: with_unit(each, units.get(key, "1")) for key, each in value.items()}
    over = given.get("over", process.controlled[0])
    unit = next((s.shown_unit for s in process.measurements if s.name == over), "1")
    if isinstance(value, (list, tuple)):
        return [with_unit(each, unit) for each in value]
    return with_unit(value, unit)


def _documented(text: str, arguments: Iterable[str]) -> str:
    """Return the help of a design with a plant in the place of its model, and what all share."""
    text = "\n".join(f"    {line}" if line else "" for line in text.splitlines()) + "\n"
    text = _OTHERS.sub(r"`cl.design.\1`", _MODEL.sub("", text, count=1))
    text, _, _ = text.partition("    Examples\n    --------")
    head, line, rest = text.partition("    Parameters\n    ----------\n")
    if "pairing" in arguments and "    Returns\n" not in rest:
        rest = rest.replace("    Raises\n", f"{_PAIRED}    Raises\n", 1)
    named = [name for name in arguments if name in _SHARED and f"    {name} :" not in rest]
    line += _PLANT + "".join(_SHARED[name] for name in named)
    return inspect.cleandoc(f"{head.rstrip()}\n{_QUANTITIES}\n{line}{rest}")
