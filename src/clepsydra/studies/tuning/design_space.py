"""A search space of numbers that a design makes a step law's parameters from: weights, say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Protocol

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.process.process import Process
from clepsydra.studies.tuning.parameters import (
    TunedParameter,
    check_names,
    check_start,
    shares,
    values_of,
)
from clepsydra.studies.tuning.search_space import NumberWords


class NumberDesign(Protocol):
    """A design by some numbers.

    Examples
    --------
    See `clepsydra.studies.tuning.lqi_weights.LqiWeights`.
    """

    @property
    def numbers(self) -> Mapping[str, float]:
        """The numbers at the start by name."""

    def values(self, numbers: Mapping[str, float]) -> dict[str, float]:
        """Return the law's parameters that these numbers make.

        They are not rounded: a search takes differences of what they score.

        Raises
        ------
        NotApplicable
            They make none.
        """

    def words(self, process: Process) -> NumberWords:
        """Return the numbers in words."""


@dataclass(frozen=True, eq=False)
class DesignSpace:
    """The unit cube of tuned design numbers; the law's parameters follow by the design.

    Parameters
    ----------
    controller : Controller
        Made with the numbers of the start.
    parameters : tuple of TunedParameter
        Numbers of the design; the others stay as they are.
    design : NumberDesign

    Raises
    ------
    InputError
        There is no parameter, one is named twice or is none of the design, or the start lies
        outside of the bounds.

    Examples
    --------
    See `clepsydra.studies.tuning.tuned_lqi.tuned_lqi`.
    """

    controller: Controller
    parameters: tuple[TunedParameter, ...]
    design: NumberDesign
    _made: dict[bytes, dict[str, float]] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        known = self.design.numbers
        check_names(self.parameters, known, "one of ")
        for parameter in self.parameters:
            check_start(parameter, known[parameter.name])

    @property
    def start(self) -> np.ndarray:
        """Where the numbers of the start stand in the cube [p]."""
        return shares(self.parameters, self.design.numbers)

    def numbers_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the tuned numbers by name [n], at points [n, p]."""
        return values_of(self.parameters, self.design.numbers, points)

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the law's parameters that the design makes by name [n], at points [n, p].

        Not a number where the design does not apply.
        """
        made = [self._values(point) for point in np.atleast_2d(points)]
        return {
            name: np.array([values.get(name, np.nan) for values in made]) for name in self._names
        }

    def controller_values(self, point: np.ndarray) -> dict[str, float]:
        """Return all parameter values of the law at one point [p]."""
        values = self._values(point)
        return {
            **self.controller.values,
            **{name: values.get(name, np.nan) for name in self._names},
        }

    def identity(self) -> dict[str, object]:
        """Return what tells this space from any other, for JSON."""
        return {
            "parameters": [asdict(parameter) for parameter in self.parameters],
            "numbers": dict(self.design.numbers),
        }

    def words(self, process: Process) -> NumberWords:
        """Return the numbers in words."""
        return self.design.words(process)

    @property
    def _names(self) -> tuple[str, ...]:
        """The law's parameters that the design makes."""
        return tuple(self._values(self.start))

    def _values(self, point: np.ndarray) -> dict[str, float]:
        """Return what the design makes at a point; nothing where it does not apply."""
        key = point.tobytes()
        if key not in self._made:
            numbers = {**self.design.numbers}
            numbers |= {name: float(value[0]) for name, value in self.numbers_at(point).items()}
            try:
                made = self.design.values(numbers)
            except NotApplicable:
                made = {}
            self._made[key] = made
        return self._made[key]
