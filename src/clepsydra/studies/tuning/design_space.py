"""A search space of numbers that a design makes a step law's parameters from: weights, say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.search_space import NumberWords, SearchSpace


class NumberDesign(Protocol):
    """A design by some numbers."""

    @property
    def numbers(self) -> Mapping[str, float]:
        """The numbers at the start by name."""

    @property
    def words(self) -> NumberWords:
        """The numbers in words."""

    def values(self, numbers: Mapping[str, float]) -> dict[str, float]:
        """Return the law's parameters that these numbers make.

        They are not rounded: a search takes differences of what they score.

        Raises
        ------
        NotApplicable
            They make none.
        """

    def notes(
        self, parameters: Sequence[TunedParameter], tuned: Mapping[str, float]
    ) -> Sequence[str]:
        """Return what is to be known of the numbers that a search found."""


@dataclass(frozen=True, eq=False)
class DesignSpace(SearchSpace):
    """The unit cube of tuned design numbers; the law's parameters follow by the design.

    Parameters
    ----------
    controller : Controller
        Made with the numbers of the start.
    parameters : sequence of TunedParameter
        Numbers of the design; the others stay as they are.
    design : NumberDesign
    """

    design: NumberDesign
    _made: dict[bytes, dict[str, float]] = field(default_factory=dict, repr=False)

    @property
    def numbers(self) -> Mapping[str, float]:
        """The numbers of the design."""
        return self.design.numbers

    @property
    def words(self) -> NumberWords:
        """The numbers in words."""
        return self.design.words

    def notes(self, tuned: Mapping[str, float]) -> Sequence[str]:
        """Return what the design has to say of the numbers that were found."""
        return self.design.notes(self.parameters, tuned)

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the law's parameters that the design makes by name [n], at points [n, p].

        Not a number where the design does not apply.
        """
        made = [self._values(point) for point in np.atleast_2d(points)]
        names = self._values(self.start)
        return {name: np.array([values.get(name, np.nan) for values in made]) for name in names}

    def _values(self, point: np.ndarray) -> dict[str, float]:
        """Return what the design makes at a point; nothing where it does not apply."""
        key = point.tobytes()
        if key not in self._made:
            tuned = {name: float(value[0]) for name, value in self.numbers_at(point).items()}
            try:
                self._made[key] = self.design.values({**self.numbers, **tuned})
            except NotApplicable:
                self._made[key] = {}
        return self._made[key]
