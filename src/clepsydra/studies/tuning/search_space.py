"""The space that a search moves in: tuned numbers between bounds, and the law at its points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.studies.tuning.parameters import ROUNDING, TunedParameter


class NumberWords:
    """Tuned numbers as a reader knows them: by their own names and as plain numbers.

    Examples
    --------
    >>> NumberWords().value("inputs.pump_1", 0.123456)
    '0.1235'
    """

    def name(self, parameter: str) -> str:
        """Return what the reader calls a number."""
        return parameter

    def value(self, parameter: str, value: float) -> str:
        """Return a value of it with its unit."""
        return f"{value:.4g}"

    def turns(self, parameter: str, value: float) -> bool:
        """Return whether `value` leaves a negative sign out, and larger is smaller."""
        return False


@dataclass(frozen=True, eq=False)
class SearchSpace(ABC):
    """The unit cube of some tuned numbers, and the parameters of a step law at its points.

    The numbers are parameters of the law themselves (`law_space.LawSpace`), or numbers that a
    design makes them from (`design_space.DesignSpace`).

    Parameters
    ----------
    controller : Controller
        Where the search starts.
    parameters : sequence of TunedParameter

    Raises
    ------
    InputError
        There is no parameter, one is unknown or named twice, or the start lies outside of its
        bounds.
    """

    controller: Controller
    parameters: Sequence[TunedParameter]

    def __post_init__(self) -> None:
        require_type(
            self.controller, Controller, "controller", "a Controller", "design one, or make one"
        )
        sequence_of(
            self.parameters, TunedParameter, "tuning, parameters", "a list of TunedParameter",
            "make them, as by around(controller, [names])",
        )  # fmt: skip
        self._check_names()
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
    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the law's parameters that change by name [n], at points [n, p].

        They are not rounded. Not a number where there is no controller.
        """

    @property
    def words(self) -> NumberWords:
        """The tuned numbers in words."""
        return NumberWords()

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

    def controller_values(self, point: np.ndarray) -> dict[str, float]:
        """Return all parameter values of the law at one point [p]."""
        changed = {name: float(value[0]) for name, value in self.values_at(point).items()}
        return {**self.controller.values, **changed}

    def _check_names(self) -> None:
        known, place = self.numbers, "tuning, parameters"
        if not self.parameters:
            raise InputError(place, "none", "at least one", "name what to tune")
        named: set[str] = set()
        for parameter in self.parameters:
            for name in (parameter.name, *parameter.followers):
                if name not in known:
                    raise InputError(
                        place, name, f"one of {', '.join(known)}",
                        suggestion(name, known, "choose one of them"),
                    )  # fmt: skip
                if name in named:
                    raise InputError(place, name, "each name once", "drop one")
                named.add(name)
