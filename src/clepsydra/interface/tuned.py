"""What a tuning came to: the controller, and how it was found."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from clepsydra.base.section import Line, Section
from clepsydra.interface.controller import Controller
from clepsydra.interface.shown import Answered
from clepsydra.studies.tuning.result import TuningResult


class Tuned(Answered, TuningResult):
    """How a tuning came out: `objective`, `scores`, `binding`, `front` and what it started from."""

    def answer(self) -> Section:
        """Return what was achieved, what was found and on which limits it stands."""
        return Section("", (Line(self.controller.design), self.line()))

    def line(self) -> Line:
        """Return what was achieved, in a sentence."""
        words = (
            f"Tuned by {self.evaluations} simulations: objective {self.objective:.3g} from "
            f"{self.start_objective:.3g}, max|S| {self.maximum_sensitivity:.2f} from "
            f"{self.start_maximum_sensitivity:.2f}"
        )
        return Line(words + (f"; it stands on {', '.join(self.binding)}." if self.binding else "."))


@dataclass(frozen=True, eq=False, repr=False)
class TunedController(Controller):
    """A controller that was tuned by simulation, and how.

    Parameters
    ----------
    tuning : Tuned
        `objective`, `scores` and `maximum_sensitivity`, each also of the start, `binding` limits,
        `evaluations` and the `front` of score against robustness.
    """

    tuning: Tuned = field(kw_only=True)

    def answer(self) -> Section:
        """Return name, what the tuning achieved, and settings."""
        made = super().answer()
        return replace(made, parts=(*made.parts, self.tuning.line()))
