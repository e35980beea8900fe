"""Plants drawn from an uncertainty, each at its own rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from clepsydra.linear.equilibria import Equilibria, ManyEquilibria
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.many_plants import ManyPlants
from clepsydra.process.uncertainty import Uncertainty
from clepsydra.studies.robustness.draws import draw_parameters

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrawnPlants:
    """Plants of one kind, known by their numbers; 0 is the plant of the point itself.

    Each rests with its controlled measurements where they are at the point, by inputs of its own.

    Parameters
    ----------
    point : OperatingPoint
    pairing : tuple of (output, input)
        What is held at rest, and by what.
    uncertainty : Uncertainty
    seed : int
        Not negative.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> pairing = plant.analysis.pairing
    >>> drawn = DrawnPlants(plant.point, pairing, plant.process.uncertainty, seed=1)
    >>> rest = drawn.rest(drawn.values(np.arange(3)))
    >>> rest.inputs[0, 0].item(), rest.feasible
    (3.0, array([ True,  True,  True]))
    """

    point: OperatingPoint
    pairing: tuple[tuple[str, str], ...]
    uncertainty: Uncertainty
    seed: int = 1

    def values(self, numbers: NDArray[np.int64]) -> dict[str, Array]:
        """Return what varies of the plants of some numbers [draws], SI."""
        return draw_parameters(self.point.process, self.uncertainty, self.seed, numbers)

    def rest(self, values: Mapping[str, Array]) -> Equilibria:
        """Return where plants of some values rest."""
        return self._equilibria.find(values)

    def plants(self, values: Mapping[str, Array], rest: Equilibria) -> ManyPlants:
        """Return those plants that have a steady state, where they begin."""
        every = ManyPlants(self.point, rest.state, rest.inputs, dict(values))
        return every.chosen(rest.feasible)

    @cached_property
    def _equilibria(self) -> ManyEquilibria:
        outputs, inputs = zip(*self.pairing, strict=True)
        return ManyEquilibria(self.point, outputs, inputs)
