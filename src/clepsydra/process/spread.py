"""The uncertainty of one plant: what varies about which value, and what varies together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.pickled_fields import PickledFields
from clepsydra.base.signal import Signal
from clepsydra.process.distribution import Distribution

Matrix = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Correlated:
    """Parameters that are high or low together.

    Parameters
    ----------
    parameters : tuple of str
    matrix : tuple of tuple of float
        The correlation of each with each, of the normal numbers that stand behind them [1].
    """

    parameters: tuple[str, ...]
    matrix: Matrix

    def among(self, names: frozenset[str]) -> Correlated:
        """Return the same of those that are among some names."""
        kept = [place for place, name in enumerate(self.parameters) if name in names]
        matrix = tuple(tuple(self.matrix[row][column] for column in kept) for row in kept)
        return Correlated(tuple(self.parameters[place] for place in kept), matrix)


@dataclass(frozen=True)
class Spread(PickledFields):
    """How the parameters of a plant, and those of its disturbances that are named, vary.

    Parameters
    ----------
    signals : mapping
        What varies, in the order of the plant's parameters, then its disturbances; `initial` is
        the value of the plant itself.
    distributions : mapping
        Of each, in SI.
    followed : mapping
        What takes the unit numbers of another to that.
    correlated : tuple of Correlated

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> spread = process.uncertainty.about(process)
    >>> spread.words("tank_1.area"), len(spread.streams), spread.factors[0]
    ('uniform within 10 %, 25.2 to 30.8 cm²', 20, ('tank_1.area',))
    """

    signals: Mapping[str, Signal]
    distributions: Mapping[str, Distribution]
    followed: Mapping[str, str]
    correlated: tuple[Correlated, ...] = ()

    def distribution(self, name: str) -> Distribution:
        """Return how a parameter is distributed [SI].

        Raises
        ------
        KeyError
            It does not vary.
        """
        return self.distributions[name]

    def words(self, name: str) -> str:
        """Return how a parameter is distributed, in words and in the unit that the reader sees."""
        return self.distributions[name].words(self.signals[name])

    def stream(self, name: str) -> str:
        """Return whose unit numbers a parameter takes: mostly its own."""
        return self.followed.get(name, name)

    @cached_property
    def streams(self) -> tuple[str, ...]:
        """What has unit numbers of its own, a row each of what `factors` group."""
        return tuple(name for name in self.signals if name not in self.followed)

    @cached_property
    def rows(self) -> tuple[tuple[int, ...], ...]:
        """The rows of the unit numbers that belong to each factor: several of what is correlated.

        An index of sensitivity exchanges them at once.
        """
        together = {name: each.parameters for each in self.correlated for name in each.parameters}
        place = {name: row for row, name in enumerate(self.streams)}
        found = dict.fromkeys(together.get(name, (name,)) for name in self.streams)
        return tuple(tuple(place[name] for name in names) for names in found)

    @cached_property
    def factors(self) -> tuple[tuple[str, ...], ...]:
        """What varies independently of all else: groups of parameters that vary together."""
        heads = [{self.streams[row] for row in rows} for rows in self.rows]
        return tuple(
            tuple(name for name in self.signals if self.stream(name) in head) for head in heads
        )

    @cached_property
    def roots(self) -> tuple[tuple[tuple[int, ...], np.ndarray], ...]:
        """The rows of each correlated group with the lower triangle L of its matrix L Lᵀ."""
        place = {name: row for row, name in enumerate(self.streams)}
        return tuple(
            (tuple(place[name] for name in each.parameters), np.linalg.cholesky(each.matrix))
            for each in self.correlated
        )
