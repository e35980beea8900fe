"""A matrix whose numbers are signals of a law: declared, named and multiplied in one place."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers.signals import gain, per
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True, eq=False)
class Matrix:
    """What each of some signals does to each of others, by the name ROW.MATRIX.COLUMN.

    `rows`, `columns`: what is acted on, and what acts; `words`: of a number, with {to} for its row
    and {by} for its column; `per`: further units in the denominator; `used`: where it has numbers:
    one that is always zero is no parameter of the law; `digits`: that a design gives to a number.

    Examples
    --------
    >>> pump, levels = Signal("pump", "V"), [Signal("level_1", "m"), Signal("level_2", "m")]
    >>> feedback = Matrix("feedback", [pump], levels, "gain from {by} to {to}")
    >>> [(number.name, number.unit, number.description) for number in feedback.signals()][1]
    ('pump.feedback.level_2', 'V/m', 'gain from level_2 to pump')
    >>> feedback.times(feedback.named(np.array([[2.0, 3.0]])), [ca.SX(10), ca.SX(1)])
    [SX(23)]
    """

    name: str
    rows: Sequence[Signal]
    columns: Sequence[Signal]
    words: str
    per: tuple[str, ...] = ()
    used: np.ndarray | None = None
    digits: int = 6

    @property
    def places(self) -> list[list[int]]:
        """Row and column of each number, row by row."""
        used = np.ones((len(self.rows), len(self.columns))) if self.used is None else self.used
        return np.argwhere(used).tolist()

    def signals(self) -> list[Signal]:
        """Return the numbers as parameters, row by row."""
        found = []
        for j, k in self.places:
            to, by = self.rows[j], self.columns[k]
            words = self.words.format(to=to.name, by=by.name)
            number = gain(self._name(j, k), per(to, by, *self.per), 0.0, words)
            found.append(replace(number, matrix=self.name, digits=self.digits))
        return found

    def last(self) -> list[Signal]:
        """Return the numbers as states that keep those of the last sample."""
        return [
            replace(number, description=f"{number.description} in the last sample")
            for number in self.signals()
        ]

    def named(self, values: Any) -> dict[str, Any]:
        """Return the numbers of an array or an expression [rows, columns] by name."""
        return {self._name(j, k): values[j, k] for j, k in self.places}

    def times(
        self, s: Symbols, values: Sequence[ca.SX], start: Sequence[ca.SX] | None = None
    ) -> list[ca.SX]:
        """Return the matrix times values, added to a start of each row.

        `s`: the numbers by name; `values`: for each column; `start`: for each row; zero if left
        out.
        """
        found = [ca.SX(0)] * len(self.rows) if start is None else list(start)
        for j, k in self.places:
            found[j] = found[j] + s[self._name(j, k)] * values[k]
        return found

    def _name(self, row: int, column: int) -> str:
        return effect(self.rows[row], self.name, self.columns[column])


def column(s: Symbols, part: str, owners: Iterable[Signal]) -> ca.SX:
    """Return one part of each of some signals as a vector."""
    return ca.vertcat(*(s[path(owner, part)] for owner in owners))
