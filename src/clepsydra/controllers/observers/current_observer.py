"""The current observer: an estimate that uses the measurement of the same sample."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.observers.observer import Observer, Values, surprises
from clepsydra.controllers.observers.structure import ObserverStructure
from clepsydra.program.step_law import Symbols

_ESTIMATE = Key("estimate", "{x}", "expected deviation of {x} from the operating point")


class CurrentObserver(Observer):
    """An observer by a linear model: h(x̂) = C x̂, and Φ x̂ + Γ u in the next sample.

    Φ and Γ are those of one sampling period. Everything is a deviation from the operating point.
    """

    _reads, _hears = "deviation", "move"

    def __init__(
        self, structure: ObserverStructure, measured: Sequence[Signal], moved: Sequence[Signal]
    ) -> None:
        self.estimated, x, y, u = structure.estimated, structure.estimated, measured, moved
        self.matrices = [
            Matrix(name, to, by, f"what {{by}} {when} does to {{to}}", used=used, digits=9)
            for name, to, by, when, used in (
                ("transition", x, x, "a sample before", structure.transition),
                ("input_effect", x, u, "held for a sample", structure.moved),
                ("observation", y, x, "at once", structure.shown),
                ("correction", x, y, "not as estimated", structure.corrected),
            )
        ]
        super().__init__(x, y, u, self.parameters())

    def parameters(self) -> list[Signal]:
        """Return the numbers of transition, input_effect, observation and correction."""
        return [number for matrix in self.matrices for number in matrix.signals()]

    def state(self) -> list[Signal]:
        """Return estimates, the deviations from the operating point expected next."""
        return [_ESTIMATE.of(x, x=x) for x in self.estimated]

    def _corrected(self, s: Symbols, before: Values, shown: Values) -> tuple[Values, Values]:
        *_, observation, correction = self.matrices
        surprise = surprises(s["known"], shown, observation.times(s, before))
        added = correction.times(s, surprise)
        return [x + more for x, more in zip(before, added, strict=True)], surprise

    def _following(self, s: Symbols, estimate: Values, inputs: Values) -> Values:
        transition, input_effect, *_ = self.matrices
        pairs = zip(transition.times(s, estimate), input_effect.times(s, inputs), strict=True)
        return [own + moved for own, moved in pairs]
