"""All designs that apply to a plant, without simulating them."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.designs.applicability import NotApplicable
from clepsydra.interface.controller import Controller, of_plant
from clepsydra.interface.plant import Plant
from clepsydra.interface.subject import StudyRequest, plant_of
from clepsydra.studies.designs import studied_designs

if TYPE_CHECKING:
    from collections.abc import Callable

    from clepsydra.controllers import controller as inner


def every_design(
    request: Plant | StudyRequest,
) -> tuple[list[Controller], list[tuple[str, str]]]:
    """Return the controllers of all designs, or of a study file, and why others are left out.

    Those that are found by simulation are left out: it is a study that tunes them.

    Returns
    -------
    controllers : list of Controller
    left_out : list of (name, reason)

    Examples
    --------
    >>> import clepsydra as cl
    >>> found, left_out = every_design(cl.load("three-tanks"))
    >>> found[0].name, left_out[0][0]
    ('PI, SIMC', 'PI, arrest time')
    """
    plant = plant_of(request)
    found: list[Controller] = []
    left_out = [(name, "it is tuned by simulation: name it") for name in _tuned(request)]
    for name in _makers(request, plant):
        try:
            made = _made(request, name, plant)
        except (NotApplicable, InputError) as reason:
            words = str(reason).partition(" is not applicable: ")[2] or str(reason)
            left_out.append((name, words.rstrip(".")))
            continue
        if isinstance(made.law, PythonLaw):
            left_out.append((name, "its law is a function in Python, which a page cannot run"))
        else:
            found.append(made)
    return found, left_out


def designed(request: Plant | StudyRequest, name: str) -> Controller | None:
    """Return the controller of a name by its design alone.

    None where only a study says what it is, or why there is none.
    """
    plant = plant_of(request)
    if name not in _makers(request, plant):
        return None
    try:
        return _made(request, name, plant)
    except NotApplicable:
        return None


def _made(request: Plant | StudyRequest, name: str, plant: Plant) -> Controller:
    return of_plant(_makers(request, plant)[name](), plant).named(name)


def _tuned(request: Plant | StudyRequest) -> list[str]:
    if not isinstance(request, StudyRequest):
        return []
    return [each.name for each in request.controllers if each.tune is not None]


def _makers(
    request: Plant | StudyRequest, plant: Plant
) -> dict[str, Callable[[], inner.Controller]]:
    """Return what makes each controller that is not tuned, by name."""
    named: dict[str, Callable[[], inner.Controller]] = {}
    if isinstance(request, StudyRequest):
        named = {
            each.name: partial(each.make, request.analysis, plant.measured)
            for each in request.controllers
            if each.tune is None
        }
        if not request.tries_every_design:
            return named
    others = {*named, *_tuned(request)}
    designs = studied_designs().items()
    return named | {
        name: partial(design, plant.analysis) for name, design in designs if name not in others
    }
