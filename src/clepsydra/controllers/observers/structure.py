"""The structure of an observer: what it estimates, and which numbers of its matrices are used."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal

#: More quantities than this make a law that nobody can read or check on a plant.
MOST_ESTIMATES = 40


@dataclass(frozen=True, eq=False)
class ObserverStructure:
    """What an observer estimates, and where its matrices may differ from zero.

    A number of a matrix that is always zero is no parameter of the law: eight tanks in series
    have 8 × 8 numbers in Φ, of which half are zero.

    Parameters
    ----------
    estimated : tuple of Signal [N]
        The quantities, with their units; first the states of the process.
    transition : ndarray of bool [N, N]
        Where Φ has numbers.
    moved : ndarray of bool [N, m]
        Where Γ has numbers.
    shown : ndarray of bool [p, N]
        Where C has numbers.
    corrected : ndarray of bool [N, p]
        Where M has numbers.

    Raises InputError: there is nothing to estimate, or more than 40 quantities, or a shape does not
    fit.
    """

    estimated: tuple[Signal, ...]
    transition: np.ndarray
    moved: np.ndarray
    shown: np.ndarray
    corrected: np.ndarray

    def __post_init__(self) -> None:
        if not 1 <= self.size <= MOST_ESTIMATES:
            raise InputError(
                "observer, estimated",
                self.size,
                f"1 to {MOST_ESTIMATES} quantities",
                "estimate fewer states, or sample more slowly where dead time needs many",
            )
        N, m, p = self.size, self.inputs, self.measurements
        shapes = {"transition": (N, N), "moved": (N, m), "shown": (p, N), "corrected": (N, p)}
        for name, shape in shapes.items():
            if (found := np.shape(getattr(self, name))) != shape:
                raise InputError(
                    f"observer, {name}", found, f"a matrix of {shape}",
                    "give one row and one column for each quantity",
                )  # fmt: skip

    @property
    def size(self) -> int:
        """How many quantities are estimated."""
        return len(self.estimated)

    @property
    def inputs(self) -> int:
        """How many manipulated variables the observer hears of."""
        return int(np.shape(self.moved)[1])

    @property
    def measurements(self) -> int:
        """How many measurements correct it."""
        return int(np.shape(self.shown)[0])
