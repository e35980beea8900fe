"""Plants known by their numbers, drawn or given, each at its own rest."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from clepsydra.linear.equilibria import Equilibria, ManyEquilibria
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.many_plants import ManyPlants
from clepsydra.process.uncertainty import Uncertainty
from clepsydra.studies.robustness.draws import draw_parameters

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class NumberedPlants(ABC):
    """Plants of one kind, known by their numbers from 1 on; 0 is the plant of the point itself.

    Each rests with its controlled measurements where they are at the point, by inputs of its own.

    Parameters
    ----------
    point : OperatingPoint
    pairing : tuple of (output, input)
        What is held at rest, and by what; without any the inputs stand where they are.
    """

    point: OperatingPoint
    pairing: tuple[tuple[str, str], ...]

    @property
    def alike(self) -> bool:
        """Whether all have the noise of the plant itself."""
        return False

    @abstractmethod
    def values(self, numbers: Numbers) -> dict[str, Array]:
        """Return what varies of some plants, parameters and disturbances, in SI [plants]."""

    @abstractmethod
    def said(self) -> str:
        """Return what tells these plants from others of the same point."""

    def settings(self, numbers: Numbers) -> dict[str, Array]:
        """Return the parameters of the law with some plants, where they differ [plants]."""
        return {}

    def levels(self, numbers: Numbers) -> dict[str, Array]:
        """Return where states of some plants begin, if not at rest [plants]."""
        return {}

    def rest(self, numbers: Numbers, values: Mapping[str, Array]) -> Equilibria:
        """Return where some plants, with their values, rest."""
        return self._equilibria.find(values, len(numbers))

    def plants(self, numbers: Numbers, values: Mapping[str, Array], rest: Equilibria) -> ManyPlants:
        """Return those plants that have a steady state, where they begin."""
        every = ManyPlants(
            self.point, rest.state, rest.inputs, dict(values), self.settings(numbers),
            self.levels(numbers), None if self.alike else numbers,
        )  # fmt: skip
        return every.chosen(rest.feasible)

    @cached_property
    def _equilibria(self) -> ManyEquilibria:
        outputs, inputs = zip(*self.pairing, strict=True) if self.pairing else ((), ())
        return ManyEquilibria(self.point, outputs, inputs)


@dataclass(frozen=True, eq=False)
class DrawnPlants(NumberedPlants):
    """Plants drawn from an uncertainty.

    Parameters
    ----------
    uncertainty : Uncertainty
    seed : int
        Not negative.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> pairing = plant.analysis.pairing
    >>> drawn = DrawnPlants(plant.point, pairing, plant.process.uncertainty, seed=1)
    >>> rest = drawn.rest(np.arange(3), drawn.values(np.arange(3)))
    >>> rest.inputs[0, 0].item(), rest.feasible
    (3.0, array([ True,  True,  True]))
    """

    uncertainty: Uncertainty
    seed: int = 1

    def values(self, numbers: Numbers) -> dict[str, Array]:
        """Return what varies of the plants of some numbers [draws], SI."""
        return draw_parameters(self.point.process, self.uncertainty, self.seed, numbers)

    def said(self) -> str:
        """Return the uncertainty and the seed."""
        return f"{self.seed} {self.uncertainty!r}"


@dataclass(frozen=True, eq=False)
class GivenPlants(NumberedPlants):
    """Plants whose numbers are given, a column of each; number 1 is the first of them.

    Parameters
    ----------
    given : mapping
        Parameter or disturbance to its values [plants], SI.
    given_settings : mapping
        Parameter of the law to its values [plants], SI.
    given_levels : mapping
        State of the process to what it begins at [plants], SI.
    noise_alike : bool
        Whether all have the noise of the plant itself.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> areas = {"tank_1.area": np.array([0.0150, 0.0160])}
    >>> given = GivenPlants(plant.point, plant.analysis.pairing, areas)
    >>> given.values(np.arange(3))["tank_1.area"]
    array([0.0154, 0.015 , 0.016 ])
    """

    given: Mapping[str, Array]
    given_settings: Mapping[str, Array] = field(default_factory=dict)
    given_levels: Mapping[str, Array] = field(default_factory=dict)
    noise_alike: bool = False

    @property
    def count(self) -> int:
        """How many there are, the plant itself not counted."""
        columns = (*self.given.values(), *self.given_settings.values(), *self.given_levels.values())
        return len(columns[0]) if columns else 0

    @property
    def alike(self) -> bool:
        """Whether all have the noise of the plant itself."""
        return self.noise_alike

    def values(self, numbers: Numbers) -> dict[str, Array]:
        """Return the given numbers of some plants [plants]; of 0 those of the plant itself."""
        process = self.point.process
        loads = zip(process.disturbances, self.point.disturbances.tolist(), strict=True)
        own = {s.name: s.initial for s in process.parameters} | {d.name: v for d, v in loads}
        return _chosen(self.given, own, numbers)

    def settings(self, numbers: Numbers) -> dict[str, Array]:
        """Return the settings of some plants; the first ones for the plant itself."""
        return _chosen(self.given_settings, {}, numbers)

    def levels(self, numbers: Numbers) -> dict[str, Array]:
        """Return where some plants begin; the plant itself begins as the first one."""
        return _chosen(self.given_levels, {}, numbers)

    def said(self) -> str:
        """Return all numbers."""
        groups = (self.given, self.given_settings, self.given_levels)
        return repr([{name: column.tolist() for name, column in each.items()} for each in groups])


def _chosen(
    columns: Mapping[str, Array], own: Mapping[str, float], numbers: Numbers
) -> dict[str, Array]:
    found = {}
    for name, column in columns.items():
        chosen = column[np.maximum(numbers - 1, 0)]
        found[name] = np.where(numbers == 0, own.get(name, chosen), chosen)
    return found
