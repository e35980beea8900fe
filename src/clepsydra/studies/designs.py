"""The controllers that a study of all designs tries, in their order."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs import design
from clepsydra.designs.applicability import NotApplicable

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.designs.announced import Studied
    from clepsydra.linear.analysis import Analysis


def _designed(name: str, studied: Studied, analysis: Analysis) -> Controller:
    entry = design.DESIGNS[name]
    given = dict(studied.arguments)
    actions = given.pop("actions", None)
    if actions is not None:
        given["form"] = PidForm(actions)
    if "pairing" in entry.arguments:
        given["pairing"] = analysis.pairing
    controller = entry.function(analysis.model, **given)
    return _differentiated(controller, analysis) if actions == "PID" else controller


def _differentiated(controller: Controller, analysis: Analysis) -> Controller:
    """Refuse PID control whose derivative times are below the sampling period.

    It would differentiate the noise of single samples. Who asks for it in a study file gets it,
    with a warning.
    """
    period = analysis.operating_point.process.sampling_period
    law, values = controller.law, controller.values
    times = [values[p.name] for p in law.parameters if p.part == "derivative_time"]
    if max(times) < period:
        raise NotApplicable(
            f"its longest derivative time of {max(times):.3g} s is shorter than the sampling "
            f"period of {period:g} s; sample faster, or use PI control",
        )
    return controller


def studied_designs() -> dict[str, Callable[[Analysis], Controller]]:
    """Return what the reader calls each, and how it is designed; what does not apply says why.

    Examples
    --------
    >>> list(studied_designs())[:2]
    ['PI, arrest time', 'PI, SIMC']
    """
    known = design.DESIGNS.known().items()
    every = [(each, name) for name, announced in known for each in announced.studied]
    every.sort(key=lambda pair: pair[0].place)
    return {each.name: partial(_designed, name, each) for each, name in every}


#: Those that come with Clepsydra.
DESIGNS = studied_designs()
