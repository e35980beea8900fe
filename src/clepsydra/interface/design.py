"""Every design as a function of a plant: `cl.design.simc(plant)`.

`dir(cl.design)` lists them, `help(cl.design.simc)` says all about one.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from keyword import iskeyword
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.errors import UnknownName
from clepsydra.base.keywords import keywords_checked
from clepsydra.designs.design import DESIGNS
from clepsydra.interface.controller import Controller, of_plant
from clepsydra.interface.lift import of_model
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.controllers import controller as inner


def _named(name: str, function: Callable[..., Controller]) -> Callable[..., Controller]:
    """Return a function by the name that it has here, by which another process finds it."""
    function.__module__, function.__qualname__ = __name__, name
    return function


@keywords_checked()
def fuzzy(plant: Subject, path: str | Path, *, name: str = "Fuzzy") -> Controller:
    """Return the controller of a fuzzy file, which docs/fuzzy-files.md describes.

    Parameters
    ----------
    plant : Plant, str or Path
    path : str or Path
    name : str
        What the reader sees.

    Raises
    ------
    InputError
        The file cannot be used; the message names the line.
    """
    from clepsydra.controllers.fuzzy.file import WiredFuzzy, load_fuzzy

    plant = plant_of(plant)
    law = WiredFuzzy(load_fuzzy(path), plant.process)
    return of_plant(law.controller(plant.point, name), plant)


@cache
def _own() -> Callable[..., Controller]:
    """Return the design of a law that a user wrote."""
    from clepsydra.designs.own_law import own_controller

    return _named("own", of_model(own_controller))


@cache
def _regulator() -> Callable[..., Controller]:
    """Return the design of a regulator that is given, as matrices or by a file."""
    from clepsydra.designs.arguments.argument import of_quantity
    from clepsydra.designs.regulator import regulator_controller
    from clepsydra.designs.regulators.given import SAMPLING_PERIOD

    period = of_quantity(SAMPLING_PERIOD, "of the regulator")
    return _named("regulator", of_model(regulator_controller, {SAMPLING_PERIOD.name: period}))


_GIVEN = {"own": _own, "regulator": _regulator}


def _designs() -> dict[str, str]:
    """Return what is called a design here; behind a word of Python there is a low line."""
    return {f"{name}_" if iskeyword(name) else name: name for name in DESIGNS}


@cache
def _published(name: str, function: Callable[..., inner.Controller]) -> Callable[..., Controller]:
    """Return a design as a function of a plant, the same one each time."""
    return _named(name, of_model(function, DESIGNS[_designs()[name]].declared))


def __dir__() -> list[str]:
    return sorted([*_GIVEN, "fuzzy", *_designs()])


if not TYPE_CHECKING:  # where a type checker would take any name for known

    def __getattr__(name: str) -> object:
        # What Python itself looks for, __path__ and the like, is no misspelt design.
        if name.startswith("__"):
            raise AttributeError(name)
        if name in _GIVEN:
            return _GIVEN[name]()
        designs = _designs()
        if name not in designs:
            raise UnknownName("cl.design", name, __dir__())
        return _published(name, DESIGNS[designs[name]].function)
