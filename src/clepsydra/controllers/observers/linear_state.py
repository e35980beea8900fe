"""The state of a linear model: measured as a whole, or estimated by an observer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.matrix import Matrix
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.observers.observer import Observer, Values, surprises
from clepsydra.controllers.observers.state_source import StateSource
from clepsydra.program.step_law import Symbols

#: More quantities than this make a law that nobody can read or check on a plant.
MOST_ESTIMATES = 64


@dataclass(frozen=True, eq=False)
class ObserverStructure:
    """What an observer estimates, and where its matrices may differ from zero.

    A number of a matrix that is always zero is no parameter of the law: eight tanks in series
    have 8 × 8 numbers in Φ, of which half are zero. Structures of the same content are equal, so
    that a search for gains, which finds other numbers at each try, writes its law once.

    Parameters
    ----------
    estimated : tuple of Signal [N]
        The quantities, with their units; first the states of the process.
    transition : ndarray of bool [N, N]
        Where Φ has numbers.
    moved : ndarray of bool [N, m]
        Where Γ has numbers.
    shown : ndarray of bool [p, N]
        Where C has numbers.
    corrected : ndarray of bool [N, p]
        Where M has numbers.

    Raises InputError: there is nothing to estimate, or more than 64 quantities.
    """

    estimated: tuple[Signal, ...]
    transition: np.ndarray
    moved: np.ndarray
    shown: np.ndarray
    corrected: np.ndarray

    def __post_init__(self) -> None:
        if not 1 <= len(self.estimated) <= MOST_ESTIMATES:
            raise InputError(
                "observer, estimated",
                len(self.estimated),
                f"1 to {MOST_ESTIMATES} quantities",
                "estimate fewer states, or sample more slowly where dead time needs many",
            )

    @cached_property
    def _content(self) -> tuple[object, ...]:
        places = self.transition, self.moved, self.shown, self.corrected
        return self.estimated, *((each.shape, each.tobytes()) for each in places)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ObserverStructure) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)


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
        numbers = [number for matrix in self.matrices for number in matrix.signals()]
        super().__init__(x, y, u, numbers)

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


class LinearState(StateSource):
    """The measurements themselves, or what an observer estimates from them.

    `measured`, `manipulated`: a signal that has but a name is of unit 1; `controlled`: the
    measurements that have setpoints; `structure`: None where the measurements show the whole state.
    """

    from_rest = True

    def __init__(
        self,
        measured: Sequence[Signal | str],
        manipulated: Sequence[Signal | str],
        controlled: Sequence[str],
        structure: ObserverStructure | None,
    ) -> None:
        shown, moved = signals.process_signals(measured), signals.process_signals(manipulated)
        known = {signal.name: signal for signal in shown}
        self.observer = structure and CurrentObserver(structure, shown, moved)
        fed_back = structure.estimated if structure else shown
        super().__init__(shown, [known[name] for name in controlled], moved, fed_back)

    def known(self, sample: Sample, reading: Reading) -> list[ca.SX]:
        """Return the deviations of the state from the operating point."""
        at_rest = sample.parameters(*(signals.at_rest(y, "reference") for y in self.measured))
        shown = reading.measurements.values()
        found = [value - reference for value, reference in zip(shown, at_rest, strict=True)]
        return self.observer.correct(sample, found, reading.known) if self.observer else found

    def move_on(self, sample: Sample, known: Sequence[ca.SX], applied: Sequence[ca.SX]) -> None:
        """Write the next estimate, under the inputs that were applied."""
        if self.observer:
            pairs = zip(self.manipulated, applied, strict=True)
            moves = [output - sample[path(u, "bias")] for u, output in pairs]
            self.observer.predict(sample, known, moves)
