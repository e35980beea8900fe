"""The space that a search moves in: tuned numbers between bounds, and the law at its points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.studies.tuning.parameters import ROUNDING, TunedParameter


@dataclass(frozen=True, eq=False)
class SearchSpace(ABC):
    """The unit cube of some tuned numbers, and the parameters of a step law at its points.

    The numbers are parameters of the law themselves (`law_space.LawSpace`), or numbers that a
    design makes them from (`weight_space.WeightSpace`); the others stay as they are.

    Raises
    ------
    InputError
        A number is tuned twice, or the start lies outside of its bounds.
    """

    controller: Controller
    parameters: Sequence[TunedParameter]
    _made: dict[bytes, dict[str, float]] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        names = [name for each in self.parameters for name in (each.name, *each.followers)]
        for name in names:
            if names.count(name) > 1:
                raise InputError("tuning, parameters", name, "each name once", "drop one")
        for parameter in self.parameters:
            start = self.numbers[parameter.name]
            if not -ROUNDING <= parameter.share(start) <= 1.0 + ROUNDING:
                raise InputError(
                    f"tuning, {parameter.name}", f"a start at {start:g}",
                    f"a start within its bounds {parameter.low:g} to {parameter.high:g}",
                    "widen the bounds or start elsewhere",
                )  # fmt: skip

    @property
    @abstractmethod
    def numbers(self) -> Mapping[str, float]:
        """All numbers that can be tuned, at the start, by name."""

    @abstractmethod
    def law_values(self, numbers: Mapping[str, float]) -> dict[str, float]:
        """Return the law's parameters that these numbers make, not rounded.

        Raises
        ------
        NotApplicable
            They make none.
        """

    def name_of(self, number: str) -> str:
        """Return what the reader calls a number."""
        return number

    def shown(self, number: str, value: float) -> str:
        """Return a value of a number with its unit."""
        return f"{value:.4g}"

    def turns(self, number: str, value: float) -> bool:
        """Return whether `shown` leaves a negative sign out, and larger is smaller."""
        return False

    def notes(self, tuned: Mapping[str, float]) -> Sequence[str]:
        """Return what is to be known of the numbers that were found."""
        return ()

    @property
    def start(self) -> np.ndarray:
        """Where the controller stands in the cube [p]."""
        numbers = self.numbers
        return np.clip([p.share(numbers[p.name]) for p in self.parameters], 0.0, 1.0)

    def numbers_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the tuned numbers and their followers by name [n], at points [n, p].

        At the start they are the start's own, in every bit.
        """
        points, numbers = np.atleast_2d(points), self.numbers
        at_start = np.all(points == self.start, axis=1)
        return {
            name: np.where(at_start, numbers[name], parameter.value(column))
            for parameter, column in zip(self.parameters, points.T, strict=True)
            for name in (parameter.name, *parameter.followers)
        }

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the law's parameters that change by name [n], at points [n, p].

        Not a number where there is no controller.
        """
        made = [self._values(point) for point in np.atleast_2d(points)]
        names = self._values(self.start)
        return {name: np.array([values.get(name, np.nan) for values in made]) for name in names}

    def controller_values(self, point: np.ndarray) -> dict[str, float]:
        """Return all parameter values of the law at one point [p]."""
        changed = {name: float(value[0]) for name, value in self.values_at(point).items()}
        return {**self.controller.values, **changed}

    def _values(self, point: np.ndarray) -> dict[str, float]:
        """Return what the numbers at a point make; nothing where they make no law."""
        key = point.tobytes()
        if key not in self._made:
            tuned = {name: float(value[0]) for name, value in self.numbers_at(point).items()}
            try:
                self._made[key] = self.law_values({**self.numbers, **tuned})
            except NotApplicable:
                self._made[key] = {}
        return self._made[key]
