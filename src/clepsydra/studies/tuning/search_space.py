"""What a search needs to know of the space that it moves in."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.process.process import Process
from clepsydra.studies.tuning.parameters import TunedParameter


class NumberWords(Protocol):
    """Tuned numbers as a reader knows them.

    Examples
    --------
    See `clepsydra.studies.tuning.parameter_words.ParameterWords`.
    """

    def name(self, parameter: str) -> str:
        """Return what the reader calls a number."""

    def value(self, parameter: str, value: float) -> str:
        """Return a value of it with its unit."""

    def turns(self, parameter: str, value: float) -> bool:
        """Return whether `value` leaves a negative sign out, and larger is smaller."""


class SearchSpace(Protocol):
    """The unit cube of some tuned numbers, and the parameters of a step law at its points.

    The numbers are parameters of the law themselves (`parameters.LawSpace`), or numbers that a
    design makes them from (`design_space.DesignSpace`).

    Examples
    --------
    See `clepsydra.studies.tuning.parameters.LawSpace`.
    """

    @property
    def controller(self) -> Controller:
        """The controller that the search starts from."""

    @property
    def parameters(self) -> tuple[TunedParameter, ...]:
        """The tuned numbers with their bounds."""

    @property
    def start(self) -> np.ndarray:
        """Where the controller stands in the cube [p]."""

    def numbers_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the tuned numbers by name [n], at points [n, p]."""

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the law's parameters that change by name [n], at points [n, p].

        They are not rounded. Not a number where there is no controller.
        """

    def controller_values(self, point: np.ndarray) -> dict[str, float]:
        """Return all parameter values of the law at one point [p]."""

    def identity(self) -> dict[str, object]:
        """Return what tells this space from any other, for JSON."""

    def words(self, process: Process) -> NumberWords:
        """Return the tuned numbers in words."""
