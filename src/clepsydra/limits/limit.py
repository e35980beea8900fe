"""The physical limit of an event, with the figures that prove it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clepsydra.limits.course import Course
from clepsydra.limits.event import Event
from clepsydra.limits.replay import Replayed, replay
from clepsydra.limits.transcription import Transcription
from clepsydra.linear.linear_model import LinearModel
from clepsydra.optimal_control.grid import growing_grid
from clepsydra.optimal_control.plant_model import PlantModel
from clepsydra.optimal_control.search import NoCourse

#: What a proof may change a limit by.
TOLERANCE = 0.005
#: A horizon is doubled so many times until the limit stands.
_DOUBLINGS = 4


@dataclass(frozen=True)
class Proofs:
    """What a limit changes by, as a share of it; None where that was not found out.

    Parameters
    ----------
    grid : float or None
        With each block of the input cut in two.
    horizon : float or None
        With the horizon doubled.
    starts : float or None
        From another start of the search.
    replay : float
        In our own kernel, which runs the found input open loop.
    smoothing : float or None
        With the kinks of the equations rounded half as much; 0 where they have none.
    """

    grid: float | None
    horizon: float | None
    starts: float | None
    replay: float
    smoothing: float | None

    @property
    def named(self) -> dict[str, float | None]:
        """Name to figure."""
        return {
            "grid": self.grid,
            "horizon": self.horizon,
            "starts": self.starts,
            "replay": self.replay,
            "smoothing": self.smoothing,
        }

    @property
    def failed(self) -> tuple[str, ...]:
        """The names of those that are not within half a percent."""
        return tuple(
            name for name, value in self.named.items() if value is None or not value <= TOLERANCE
        )


@dataclass(frozen=True, eq=False)
class Limit:
    """The least error that any input within its limits can leave of an event.

    Parameters
    ----------
    event : Event
    index : float
        Sum of the integrals of the absolute errors, each over its step [s]: that of the course
        below, as the kernel runs it, which no input is known to beat by half a percent.
    errors : dict
        Output to the integral of its absolute error [its unit s].
    horizon : float
        From the event to the rest at the end [s].
    proofs : Proofs
    best : Replayed
        The course that reaches it.
    """

    event: Event
    index: float
    errors: dict[str, float]
    horizon: float
    proofs: Proofs
    best: Replayed

    @property
    def accepted(self) -> bool:
        """Whether all proofs hold."""
        return not self.proofs.failed


def limit_of(event: Event, linear: LinearModel, *, extend: bool = True) -> Limit:
    """Return the limit of an event.

    Parameters
    ----------
    event : Event
    linear : LinearModel
        Of the process.
    extend : bool
        Whether the horizon may be longer than the segment where the limit asks for it.

    Raises
    ------
    NoCourse
        No input within its limits ends at rest, or none was found.

    Examples
    --------
    >>> import clepsydra as cl
    >>> found = cl.limit("quadruple-tank", [cl.step("level_1", "+1 V")])
    >>> round(found.index, 2)
    1.78
    """
    model = event.model()
    samples, longest = event.samples, event.samples * (2**_DOUBLINGS if extend else 1)
    asked = _transcribed(event, model, samples)
    found, longer = _found(asked), _found(_transcribed(event, model, 2 * samples))
    while not _stands(found, longer) and (found or longer) and samples < longest:
        samples *= 2
        asked, found = _transcribed(event, model, samples), longer
        longer = _found(_transcribed(event, model, 2 * samples))
    if found is None:
        found = asked.solve(_guesses(asked)[0])  # which says why there is none
    fine = Transcription(event, model, asked.grid.halved())
    finer = _found(fine)
    smoothing: float | None = 0.0
    if model.kinks:
        sharper = replace(model, smoothing=model.smoothing / 2)
        smoothing = _apart(found, _found(Transcription(event, sharper, asked.grid)))
    best = finer or found
    replayed = replay(event, model, best, linear)
    proofs = Proofs(
        grid=_apart(found, finer),
        horizon=_apart(found, longer),
        starts=_apart(found, _found(asked, _others(asked))),
        replay=abs(replayed.index / best.index - 1.0),
        smoothing=smoothing,
    )
    return Limit(event, replayed.index, replayed.errors, best.grid.horizon, proofs, replayed)


def _transcribed(event: Event, model: PlantModel, samples: int) -> Transcription:
    grid = growing_grid(samples, event.samples, event.process.sampling_period)
    return Transcription(event, model, grid)


def _guesses(asked: Transcription) -> list[Course]:
    """Return two guesses: that the plant rests from the beginning where it is to go, or stays."""
    model = asked.model
    before = model.input_shares(model.before.inputs)
    return [
        asked.resting(model.target[0], model.target_inputs),
        asked.resting(model.start[0], before),
    ]


def _others(asked: Transcription) -> list[Course]:
    """Return two others, whose inputs stand in the middle of their ranges."""
    middle = np.full(asked.model.sizes[1], 0.5)
    return [asked.resting(rest[0], middle) for rest in (asked.model.target, asked.model.start)]


def _found(asked: Transcription, guesses: list[Course] | None = None) -> Course | None:
    """Return the best course from the first guess from which the search comes to an end."""
    for guess in guesses or _guesses(asked):
        try:
            return asked.solve(guess)
        except NoCourse as none:
            if none.impossible:
                return None
    return None


def _stands(found: Course | None, longer: Course | None) -> bool:
    """Whether a longer horizon makes no difference."""
    apart = None if found is None else _apart(found, longer)
    return apart is not None and apart <= TOLERANCE


def _apart(one: Course, other: Course | None) -> float | None:
    """Return how far another optimum is from one, as a share of it."""
    return None if other is None else abs(other.index / one.index - 1.0)
