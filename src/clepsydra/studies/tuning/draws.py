"""Drawn plants over whose scores a tuning takes a quantile: the same ones for every candidate."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.equilibria import Equilibria
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.pairing import paired_gains
from clepsydra.loop.many_plants import ManyPlants
from clepsydra.studies.robustness.drawn_plants import DrawnPlants
from clepsydra.studies.robustness.quantiles import places

#: What share of the drawn plants is to be at least as good as what is tuned for.
QUANTILE = 0.95
#: Most drawn plants; the chance of one in a thousand needs 2,000.
MOST_DRAWS = 10_000
_PLACE = "tuning, draws"


@dataclass(frozen=True, eq=False)
class Draws:
    """The draws 1 to `count` of some plants, without those that have no admissible steady state.

    Parameters
    ----------
    plants : DrawnPlants
    count : int
        From 1 to 10,000.
    quantile : float
        Inside of (0, 1).

    Raises
    ------
    InputError
        The number or the quantile is none.
    NotApplicable
        None of the plants has an admissible steady state.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> draws = draws_at(plant.linear, 64)
    >>> draws.place, draws.bearable, draws.words
    (61, 3, 'the 95 % quantile over 64 drawn plants')
    """

    plants: DrawnPlants
    count: int
    quantile: float = QUANTILE

    def __post_init__(self) -> None:
        whole = isinstance(self.count, (int, np.integer)) and not isinstance(self.count, bool)
        if not whole or not 1 <= self.count <= MOST_DRAWS:
            expected = f"a whole number from 1 to {MOST_DRAWS:,}"
            raise InputError(_PLACE, self.count, expected, "64 will do for a quantile of 95 %")
        if not 0.0 < self.quantile < 1.0:
            raise InputError(
                "tuning, quantile", self.quantile, "a share above 0 and below 1", "as 0.95 for 95 %"
            )
        if not self.able:
            (reason, *_) = self.left_out
            raise NotApplicable(
                f"none of {self.count} drawn plants has an admissible steady state: {reason}"
            )

    @property
    def able(self) -> int:
        """How many have an admissible steady state, and count."""
        return int(np.count_nonzero(self._rest.feasible))

    @property
    def left_out(self) -> dict[str, int]:
        """Why plants have no admissible steady state, and how many for each reason."""
        return self._rest.counts

    @property
    def place(self) -> int:
        """Which score, in ascending order from 1, is the quantile."""
        return places(self.able, self.quantile).quantile

    @property
    def bearable(self) -> int:
        """How many plants may fail without the quantile being one of theirs."""
        return self.able - self.place

    @property
    def words(self) -> str:
        """What is taken of a score, as a phrase."""
        return f"the {100.0 * self.quantile:g} % quantile over {self.able} drawn plants"

    @cached_property
    def every(self) -> ManyPlants:
        """The plants that count, where they rest, all with the noise of the plant itself."""
        found = self.plants.plants(self._numbers, self._values, self._rest)
        return replace(found, numbers=None)

    @cached_property
    def digest(self) -> str:
        """What tells these plants and this quantile from any others."""
        said = hashlib.sha256(repr((self.count, self.quantile, self.plants.seed)).encode())
        for name, column in sorted(self.every.values.items()):
            said.update(name.encode())
            said.update(np.ascontiguousarray(column).tobytes())
        for rows in (self.every.state, self.every.inputs):
            said.update(np.ascontiguousarray(rows).tobytes())
        return said.hexdigest()

    @cached_property
    def _values(self) -> dict[str, np.ndarray]:
        return self.plants.values(self._numbers)

    @cached_property
    def _rest(self) -> Equilibria:
        return self.plants.rest(self._numbers, self._values)

    @property
    def _numbers(self) -> np.ndarray:
        return np.arange(1, self.count + 1)


def draws_at(model: LinearModel, count: int, quantile: float = QUANTILE, seed: int = 1) -> Draws:
    """Return draws of the plant of a model, each at rest where the plant itself is.

    They are of what its process file says of its uncertainty.

    Raises
    ------
    InputError
        Nothing in the process varies, or as `Draws`.
    NotApplicable
        As `Draws`.
    """
    point = operating_point_of(model)
    process = point.process
    if not process.uncertainty.about(process).distributions:
        raise InputError(
            _PLACE, count, f"a process with an uncertain parameter, and {process.name} has none",
            "leave draws out, or say in [uncertainty] of its file what varies",
        )  # fmt: skip
    try:
        pairs = paired_gains(model.select(outputs=process.controlled))
    except InputError:  # outputs that hang together: the inputs stay where they are
        pairs = []
    pairing = tuple((pair.output, pair.input) for pair in pairs)
    return Draws(DrawnPlants(point, pairing, process.uncertainty, seed), count, quantile)
