"""A search space of the parameters of a step law themselves: gains and times, say."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.base.words import time_text
from clepsydra.controllers.pid_keys import GAINS, SHORT_NAMES
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.gain_units import percent_gain
from clepsydra.designs.request import in_shown_unit
from clepsydra.process.joined_unit import BESIDE
from clepsydra.studies.tuning.search_space import SearchSpace


class LawSpace(SearchSpace):
    """The unit cube of the tuned parameters of one controller, whose values are the start.

    Raises
    ------
    InputError
        As `SearchSpace`, or a bound lies outside of what the law takes of a follower.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.tuning.parameters import TunedParameter
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> space = LawSpace(controller, (TunedParameter("level_1.proportional_gain", 0.3, 30.0),))
    >>> space.values_at(np.array([0.25]))
    {'level_1.proportional_gain': array([0.9486833])}
    >>> space.name_of("level_1.proportional_gain"), space.shown("level_1.proportional_gain", 3.0)
    ('level_1.gain', '3 %/%')
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        law = {each.name: each for each in self.controller.law.parameters}
        for tuned in self.parameters:
            for own in (law[name] for name in tuned.followers):
                if tuned.low < own.low or own.high < tuned.high:
                    given = f"bounds {tuned.low:g} to {tuned.high:g}"
                    ends = f"{own.low:g} to {own.high:g} {own.unit}"
                    expected = f"bounds within {ends}, for {own.name} is moved with it"
                    raise InputError(f"tuning, {tuned.name}", given, expected, "narrow the bounds")

    @property
    def numbers(self) -> Mapping[str, float]:
        """The parameters of the law with the controller's values."""
        return self.controller.values

    def law_values(self, numbers: Mapping[str, float]) -> dict[str, float]:
        """Return the numbers themselves."""
        return dict(numbers)

    def values_at(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the values of tuned parameters and followers by name [n], at points [n, p]."""
        return self.numbers_at(points)

    def name_of(self, number: str) -> str:
        """Return "level.gain" of a loop, as in a study file, or the law's own name."""
        owner, _, part = number.rpartition(".")
        return path(owner, SHORT_NAMES.get(part, part)) if number in self._loops else number

    def shown(self, number: str, value: float) -> str:
        """Return a value [the law's unit]; of a loop's gain without the sign of its action."""
        (signal,) = (each for each in self.controller.law.parameters if each.name == number)
        if self._is_gain(number):
            block, value = self._loops[number], abs(value)
            if block.measurement.has_range and block.moved.has_range:
                percent = percent_gain(value, block.measurement, block.moved)
                return f"{percent:.4g} %/%{BESIDE[GAINS[signal.part]]}"
        elif signal.unit == "s":
            return time_text(value)
        return in_shown_unit(signal, value, digits=4)

    def turns(self, number: str, value: float) -> bool:
        """Return whether `shown` leaves a negative sign out, and larger is smaller."""
        return self._is_gain(number) and value < 0.0

    def _is_gain(self, number: str) -> bool:
        return number in self._loops and number.rpartition(".")[2] in GAINS

    @cached_property
    def _loops(self) -> dict[str, PidBlock]:
        """The loop of each parameter that belongs to one."""
        blocks = [each for each in self.controller.law.blocks if isinstance(each, PidBlock)]
        return {parameter.name: block for block in blocks for parameter in block.parameters()}
