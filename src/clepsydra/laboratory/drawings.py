"""Which controllers of a rig a page draws: of those that look alike one."""

from __future__ import annotations

from clepsydra.controllers.controller import Controller
from clepsydra.laboratory.free_laws import TypedLoops
from clepsydra.laboratory.rig import Rig
from clepsydra.report.drawing.control_functions import ControlFunction, control_functions


def drawn(rig: Rig) -> tuple[list[Controller], list[int]]:
    """Return the controllers that are drawn, and of each station the number of its drawing.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> designs = [cl.design.simc(plant), cl.design.lqi(plant), cl.design.amigo(plant)]
    >>> controllers, numbers = drawn(Rig(plant.linear, designs))
    >>> len(controllers), numbers[:3]
    (4, [0, 1, 0])
    """
    controllers: list[Controller] = []
    numbers: list[int] = []
    alike: dict[tuple[ControlFunction, ...], int] = {}
    for controller in rig.controllers:
        functions = control_functions(controller)
        if functions not in alike:
            alike[functions] = len(controllers)
            controllers.append(controller)
        numbers.append(alike[functions])
    known: dict[tuple[tuple[str, str], ...], int] = {}
    for free in rig.free:
        pairs = free.pairs if isinstance(free, TypedLoops) else ()
        if pairs not in known:
            known[pairs] = len(controllers)
            controllers.append(free.controller)
        numbers.append(known[pairs])
    return controllers, numbers
