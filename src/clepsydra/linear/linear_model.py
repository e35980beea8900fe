"""The linear model of a process near an operating point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import control

    from clepsydra.linear.operating_point import OperatingPoint


@dataclass(frozen=True)
class LinearModel:
    """Δẋ = A Δx + B Δu + E Δd,  Δy = C Δx + D Δu, deviations from `point`, in SI.

    Parameters
    ----------
    A : ndarray [n, n]
    B : ndarray [n, m]
        Manipulated inputs.
    E : ndarray [n, k]
        Disturbances.
    C : ndarray [q, n]
    D : ndarray [q, m]
    states, inputs, disturbances, outputs : tuple of str
        Names, in the order of the matrices.
    point : OperatingPoint or None
        None for a model that did not come from a process.
    """

    A: np.ndarray
    B: np.ndarray
    E: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    disturbances: tuple[str, ...]
    outputs: tuple[str, ...]
    point: OperatingPoint | None = None
