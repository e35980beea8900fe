"""What a tuning came to: the controller, and how it was found."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from clepsydra.base.section import Line, Section
from clepsydra.interface.controller import Controller
from clepsydra.interface.shown import Answered
from clepsydra.scores.score_key import score_key
from clepsydra.studies.tuning.over_draws import OverDraws, TunedOverDraws
from clepsydra.studies.tuning.result import TuningResult


class Tuned(Answered, TuningResult):
    """How a tuning came out: `objective`, `scores`, `binding`, `front` and what it started from."""

    def answer(self) -> Section:
        """Return what was achieved, what was found and on which limits it stands."""
        return Section("", (Line(self.controller.design), *self.lines()))

    def lines(self) -> tuple[Line, ...]:
        """Return what was achieved, in sentences; over drawn plants with what they keep."""
        words = (
            f"Tuned by {self.evaluations} simulations: objective {self.objective:.3g} from "
            f"{self.start_objective:.3g}, max|S| {self.maximum_sensitivity:.2f} from "
            f"{self.start_maximum_sensitivity:.2f}"
        )
        first = Line(
            words + (f"; it stands on {', '.join(self.binding)}." if self.binding else ".")
        )
        return (first,) if self.over_draws is None else (first, self._kept(self.over_draws))

    def _kept(self, over: TunedOverDraws) -> Line:
        """Return what most of the drawn plants keep, after, before and with the plant's best."""
        names = over.tuned.scores
        said = [f"{over.share}: {'; '.join(self._of_score(over, name) for name in names)}."]
        if over.tuned.failed or over.start.failed:
            said.append(
                f"It fails on {_failed(over.tuned)} of them, before on {_failed(over.start)}."
            )
        if alone := over.of_plant_alone:
            reached = [
                f"{score_key(name).title} at most {_shown(over, name, value)}"
                for name, value in alone.scores.items()
            ]
            fails = f", and it fails on {_failed(alone)} of them" if alone.failed else ""
            said.append(f"Tuned for the plant itself alone: {', '.join(reached)}{fails}.")
        for reason, count in over.left_out.items():
            said.append(f"{count} more do not count: {reason}.")
        return Line(" ".join(said))

    def _of_score(self, over: TunedOverDraws, name: str) -> str:
        own = (_shown(over, name, each[name]) for each in (self.scores, self.start_scores))
        many = (_shown(over, name, each.scores[name]) for each in (over.tuned, over.start))
        return "{} at most {}, before {} (the plant itself {}, before {})".format(
            score_key(name).title, *many, *own
        )


def _failed(over: OverDraws) -> str:
    """Return on how many plants a controller fails, and what happens."""
    why = ", ".join(f"{what} on {count}" for what, count in over.failures.items())
    return f"{over.failed} ({why})" if why else f"{over.failed}"


def _shown(over: TunedOverDraws, name: str, value: float) -> str:
    """Return a score with its unit; it is ∞ where too many plants fail."""
    from clepsydra.report.score_tables import score_text

    key = score_key(name)
    shown = score_text(over.process, key.signal, value, key.declared, over.duration)
    return " ".join(shown).strip()


@dataclass(frozen=True, eq=False, repr=False)
class TunedController(Controller):
    """A controller that was tuned by simulation, and how.

    Parameters
    ----------
    tuning : Tuned
        `objective`, `scores` and `maximum_sensitivity`, each also of the start, `binding` limits,
        `evaluations`, the `front` of score against robustness, and `over_draws`, what it came to
        on drawn plants.
    """

    tuning: Tuned = field(kw_only=True)

    def answer(self) -> Section:
        """Return name, what the tuning achieved, and settings."""
        made = super().answer()
        return replace(made, parts=(*made.parts, *self.tuning.lines()))
