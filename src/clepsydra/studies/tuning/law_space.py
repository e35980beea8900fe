"""A search space of the parameters of a step law themselves: gains and times, say."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.studies.tuning.parameter_words import ParameterWords
from clepsydra.studies.tuning.search_space import SearchSpace


class LawSpace(SearchSpace):
    """The unit cube of the tuned parameters of one controller, whose values are the start.

    Raises
    ------
    InputError
        As `SearchSpace`, or a bound lies outside of what the law takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.tuning.parameters import TunedParameter
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> space = LawSpace(controller, (TunedParameter("level_1.proportional_gain", 0.3, 30.0),))
    >>> space.start.round(6), space.values_at(np.array([0.25]))
    (array([0.5]), {'level_1.proportional_gain': array([0.9486833])})
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        law = {p.name: p for p in self.controller.law.parameters}
        for parameter in self.parameters:
            for own in (law[name] for name in (parameter.name, *parameter.followers)):
                if not (own.low <= parameter.low and parameter.high <= own.high):
                    raise InputError(
                        f"tuning, {parameter.name}",
                        f"bounds {parameter.low:g} to {parameter.high:g}",
                        f"bounds for {own.name} within {own.low:g} to {own.high:g} {own.unit}",
                        "narrow the bounds",
                    )

    @property
    def numbers(self) -> Mapping[str, float]:
        """The parameters of the law with the controller's values."""
        return self.controller.values

    @property
    def words(self) -> ParameterWords:
        """The tuned parameters in words."""
        return ParameterWords(self.controller)

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the values of tuned parameters and followers by name [n], at points [n, p]."""
        return self.numbers_at(points)
