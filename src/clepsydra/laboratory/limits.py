"""Between which limits a controller keeps what it moves, for the faceplates of a page."""

from __future__ import annotations

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.controllers.wiring import controller_name

_LOW, _HIGH = "low_limit", "high_limit"


def output_limits(controller: Controller) -> dict[str, list[str]]:
    """Return the parameters that limit each output below and above, as a loop calls them.

    Examples
    --------
    >>> import clepsydra as cl
    >>> limits = output_limits(cl.design.simc(cl.load("quadruple-tank")))
    >>> limits["pump_1"]
    ['controller.pump_1.low_limit', 'controller.pump_1.high_limit']
    """
    found = {}
    moved = zip(owners(controller.law.outputs, "out"), controller.manipulated, strict=True)
    for owner, name in moved:
        ends = [f"{owner}.{end}" for end in (_LOW, _HIGH)]
        if all(end in controller.values for end in ends):
            found[name] = [controller_name(end) for end in ends]
    return found
