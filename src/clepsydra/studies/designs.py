"""The controllers that a study of all designs tries, in their order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs import design
from clepsydra.designs.applicability import NotApplicable

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.designs.announced import Studied
    from clepsydra.linear.analysis import Analysis


@dataclass(frozen=True)
class StudiedDesign:
    """A controller that a study of all designs tries.

    Parameters
    ----------
    method : str
        The name of the design that makes it.
    studied : Studied
        What the reader calls it, and with which arguments it is made.
    """

    method: str
    studied: Studied

    def __call__(self, analysis: Analysis) -> Controller:
        """Return the controller of a plant.

        Raises
        ------
        NotApplicable
            The design does not apply; it says why.
        """
        entry = design.DESIGNS[self.method]
        given = dict(self.studied.arguments)
        actions = given.pop("actions", None)
        if actions is not None:
            given["form"] = PidForm(actions)
        if "pairing" in entry.arguments:
            given["pairing"] = analysis.pairing
        controller = entry.function(analysis.model, **given)
        return _differentiated(controller, analysis) if actions == "PID" else controller

    @property
    def asked(self) -> object:
        """What tells it from any other of the same plant; None where a user's own code makes it."""
        return (self.method, self.studied) if design.DESIGNS.is_own(self.method) else None


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


def studied_designs() -> dict[str, StudiedDesign]:
    """Return what the reader calls each, and how it is designed.

    Examples
    --------
    >>> list(studied_designs())[:2]
    ['PI, arrest time', 'PI, SIMC']
    """
    known = design.DESIGNS.known().items()
    every = [(each, name) for name, announced in known for each in announced.studied]
    every.sort(key=lambda pair: pair[0].place)
    return {each.name: StudiedDesign(name, each) for each, name in every}


#: Those that come with Clepsydra.
DESIGNS = studied_designs()
