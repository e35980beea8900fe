"""What a predictive law knows of its process beforehand: tables."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.program.routines.predictive_plan import PlanningTables

#: A plan of more moves is beyond what a PLC solves in a scan.
MOST_MOVES = 40


@dataclass(frozen=True, eq=False)
class Prediction:
    """The errors of the controlled outputs over a horizon, as moves make them.

    The n moves v are what each of m inputs will be above its last value, held over blocks of
    samples and ordered block by block. What is known is z: the N estimated deviations, the
    deviations of the q setpoints, and those of the last inputs, all from the operating point.
    Everything is in the units of the process.

    Parameters
    ----------
    blocks : tuple of int
        The samples of each.
    curves, slopes : ndarray [q, n, n], [q, n, N + q + m]
        Σ_k e_j(k)² = vᵀ C_j v + 2 (S_j z)ᵀ v + what no move changes.
    bounded : tuple of int
        Which of what is estimated has a bound.
    reached, moved : ndarray [bounded, blocks, N + q + m], [bounded, blocks, n]
        These at the end of each block are reached · z + moved · v.

    Examples
    --------
    See `designs.predictive.horizon.prediction_of`.
    """

    blocks: tuple[int, ...]
    curves: np.ndarray
    slopes: np.ndarray
    bounded: tuple[int, ...]
    reached: np.ndarray
    moved: np.ndarray

    @property
    def samples(self) -> int:
        """Samples of the horizon."""
        return sum(self.blocks)

    def tables(self, bounded: list[Signal]) -> PlanningTables:
        """Return the tables of a plan, with the ranges of what has a bound."""
        return PlanningTables(
            curves=_flat(self.curves),
            slopes=_flat(self.slopes),
            lengths=ca.DM(self.blocks),
            reached=_flat(self.reached),
            moved=_flat(self.moved),
            spans=ca.DM([level.span for level in bounded]),
        )


def _flat(tables: np.ndarray) -> ca.DM:
    """Return tables of the same columns below each other."""
    return ca.DM(tables.reshape(-1, tables.shape[-1]))


@dataclass(frozen=True, eq=False)
class TabledObserver:
    """A current observer whose numbers are tables of the law.

    Parameters
    ----------
    estimated : tuple of Signal [N]
        First the states of the process.
    transition, input_effect, observation, correction : ndarray
        Φ [N, N], Γ [N, m], C [p, N] and M [N, p]: x̂ + M (y − C x̂) now, Φ x̂ + Γ u expected.
    """

    estimated: tuple[Signal, ...]
    transition: np.ndarray
    input_effect: np.ndarray
    observation: np.ndarray
    correction: np.ndarray
