"""The draws from which Sobol indices are found: Saltelli's design."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import Finding, InputError

#: With so many, the intervals of indices held in each of 400 scramblings (decision 82).
ROWS = 2048
#: Bits of a unit number.
_BITS = 32
#: Of all dimensions of a scrambled Sobol sequence that SciPy has, half are for each of A and B.
_MOST_COLUMNS = 10_600


@dataclass(frozen=True)
class SaltelliDesign:
    """The draws A, B, and for each group A with that group's columns of B.

    A and B are the two halves of one scrambled Sobol sequence in twice as many dimensions, so that
    both fill their space evenly and do not depend on each other (A. Saltelli et al., Comput. Phys.
    Commun. 181, 2010, section 5, doi:10.1016/j.cpc.2009.09.018). `scipy.stats.sobol_indices` draws
    so as well; here columns may vary together, as the areas of all tanks do, and count as one.

    Parameters
    ----------
    groups : mapping of str to tuple of int
        Which columns vary together, by the group's name; each column is in one group.
    seed : int
        Of the scrambling.
    rows : int
        Of each of the blocks, a power of two: only then the sequence is balanced.

    Raises
    ------
    InputError
        The rows are no power of two, or a column is in no group or in two.

    Examples
    --------
    >>> design = SaltelliDesign({"areas": (0, 2), "pump": (1,)}, rows=256, seed=7)
    >>> design.columns, design.draws
    (3, 1024)
    >>> numbers = design.unit_numbers().reshape(4, 256, 3)  # A, B, and with B's areas, B's pump
    >>> bool(np.all(numbers[2][:, [0, 2]] == numbers[1][:, [0, 2]]))
    True
    >>> bool(np.all(numbers[2][:, 1] == numbers[0][:, 1]))
    True
    """

    groups: Mapping[str, tuple[int, ...]]
    seed: int
    rows: int = ROWS

    def __post_init__(self) -> None:
        if self.rows < 2 or self.rows & (self.rows - 1):
            raise InputError(
                "rows of a sensitivity study", self.rows, "a power of two", "as 1024 or 4096"
            )
        columns = sorted(column for group in self.groups.values() for column in group)
        if not columns or columns != list(range(len(columns))) or not all(self.groups.values()):
            raise InputError(
                "groups of a sensitivity study",
                Finding(f"columns {columns}"),
                "each column from 0 on in one group, and a column in each group",
                "put every column into one group",
            )
        if len(columns) > _MOST_COLUMNS:
            raise InputError(
                "groups of a sensitivity study",
                Finding(f"{len(columns):,} columns"),
                f"at most {_MOST_COLUMNS:,}",
                "vary fewer things",
            )

    @property
    def columns(self) -> int:
        """How many numbers a draw takes."""
        return sum(len(group) for group in self.groups.values())

    @property
    def draws(self) -> int:
        """How many there are in all: rows × (groups + 2)."""
        return self.rows * (len(self.groups) + 2)

    def unit_numbers(self) -> np.ndarray:
        """Return the numbers of each draw [draws, columns], between 0 and 1 and neither of both.

        All rows of A come first, then those of B, then those of each group in its order.
        """
        from scipy.stats import qmc

        engine = qmc.Sobol(2 * self.columns, bits=_BITS, rng=np.random.default_rng(self.seed))
        # The middle of each cell: 0 itself would be −∞ in a normal distribution.
        halves = engine.random(self.rows) + 0.5 ** (_BITS + 1)
        first, second = halves[:, : self.columns], halves[:, self.columns :]
        blocks = [first, second]
        for group in self.groups.values():
            mixed = first.copy()
            mixed[:, list(group)] = second[:, list(group)]
            blocks.append(mixed)
        return np.concatenate(blocks)
