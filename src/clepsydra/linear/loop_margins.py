"""Gain, phase and delay margins of one loop, and the peaks of its sensitivities."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.disk_margin import DiskMargin, disk_margin
from clepsydra.linear.frequency_grid import frequency_grid
from clepsydra.linear.frequency_peak import SensitivityPeak, highest
from clepsydra.linear.interconnection import feedback
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.response import transfer_at
from clepsydra.linear.stability import asymptotically_stable

# Gains beyond these cross nothing worth a margin: dead time crosses the axis for ever.
_SMALLEST, _LARGEST = 1e-4, 1e8
_UNSTABLE = SensitivityPeak(math.inf, math.nan)


class Crossing(NamedTuple):
    """A margin and the frequency at which the loop would then oscillate.

    Parameters
    ----------
    margin : float
        A factor on the gain [1], a phase [rad] or a dead time [s].
    frequency : float
        [rad/s]
    """

    margin: float
    frequency: float


@dataclass(frozen=True)
class LoopMargins:
    """What one loop withstands before it becomes unstable.

    Parameters
    ----------
    stable : bool
        Of the closed loop. Where it is not, the crossings say how the gain or the phase would
        have to change for a root to reach the axis, the peaks are infinite, and there is no
        margin: the properties are None.
    gain_crossings : tuple of Crossing
        Factors on the gain [1] that put L through -1: above one up, below one down. Those of
        10000 and more are left out.
    phase_crossings : tuple of Crossing
        At each |L| = 1 the phase of L above -180° [rad], -π to π.
    delay_crossings : tuple of Crossing
        At each |L| = 1 the additional dead time [s] that puts L through -1.
    sensitivity, complementary : SensitivityPeak
        max|S| and max|T|.
    """

    stable: bool
    gain_crossings: tuple[Crossing, ...]
    phase_crossings: tuple[Crossing, ...]
    delay_crossings: tuple[Crossing, ...]
    sensitivity: SensitivityPeak
    complementary: SensitivityPeak
    disk: DiskMargin

    @property
    def gain_margin_up(self) -> float | None:
        """The smallest factor above one that makes the loop unstable [1]; infinite for none."""
        up = [crossing.margin for crossing in self.gain_crossings if crossing.margin > 1.0]
        return min(up, default=math.inf) if self.stable else None

    @property
    def gain_margin_down(self) -> float | None:
        """The largest factor below one that makes the loop unstable [1]; zero for none."""
        down = [crossing.margin for crossing in self.gain_crossings if crossing.margin < 1.0]
        return max(down, default=0.0) if self.stable else None

    @property
    def phase_margin(self) -> float | None:
        """The smallest change of phase that makes the loop unstable [rad]; infinite for none."""
        changes = [abs(crossing.margin) for crossing in self.phase_crossings]
        return min(changes, default=math.inf) if self.stable else None

    @property
    def delay_margin(self) -> float | None:
        """The smallest additional dead time that makes the loop unstable [s]; infinite for none."""
        times = [crossing.margin for crossing in self.delay_crossings]
        return min(times, default=math.inf) if self.stable else None


def loop_margins(loop: LinearModel) -> LoopMargins:
    """Return the margins of one loop, closed by negative unity feedback, exact with dead time.

    Parameters
    ----------
    loop : LinearModel
        L, one input (the error) and one output.

    Raises
    ------
    InputError
        L has several channels or is not well posed, or its stability cannot be decided.

    Examples
    --------
    2/(s (s + 1) (s + 2)) stays stable until its gain is tripled, and crosses -180° at √2:

    >>> A, B = np.array([[0.0, 1, 0], [0, -1, 1], [0, 0, -2]]), np.array([[0.0], [0.0], [2.0]])
    >>> loop = LinearModel(A, B, B[:, :0], np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 1)),
    ...                    ("a", "b", "c"), ("error",), (), ("y",))
    >>> margins = loop_margins(loop)
    >>> round(margins.gain_margin_up, 9), round(margins.gain_crossings[0].frequency, 9)
    (3.0, 1.414213562)
    >>> round(math.degrees(margins.phase_margin), 2)
    32.61
    """
    if (len(loop.inputs), len(loop.outputs)) != (1, 1):
        got = f"{len(loop.outputs)} outputs and {len(loop.inputs)} inputs"
        remedy = "select the channel, the others closed by feedback"
        raise InputError("loop margins", got, "one input and one output", remedy)
    closed = feedback(loop)
    stable = asymptotically_stable(closed)
    grid = frequency_grid(loop, closed)
    sensitivity, complementary = sensitivity_peaks(closed, grid, stable)
    values = transfer_at(loop, 1j * grid)[:, 0, 0]
    at_unit_gain = [
        (omega, complex(_at(loop, 1j * omega)))
        for omega in _sign_changes(
            loop, grid, values, lambda value: np.log(np.maximum(np.abs(value), 1e-300))
        )
    ]
    return LoopMargins(
        stable=stable,
        gain_crossings=tuple(_gain_crossings(loop, grid, values)),
        phase_crossings=tuple(
            Crossing(float(np.angle(-value)), omega) for omega, value in at_unit_gain
        ),
        delay_crossings=tuple(
            Crossing(float(np.angle(-value) % (2.0 * np.pi)) / omega, omega)
            for omega, value in at_unit_gain
        ),
        sensitivity=sensitivity,
        complementary=complementary,
        disk=disk_margin(loop),
    )


def sensitivity_peaks(
    closed: LinearModel, grid: np.ndarray, stable: bool
) -> tuple[SensitivityPeak, SensitivityPeak]:
    """Return the peaks of σ_max of S = I - T and of T, the closed loop; infinite if unstable."""
    if not stable:
        return _UNSTABLE, _UNSTABLE
    identity = np.eye(len(closed.outputs))
    return (
        highest(closed, grid, lambda T: np.linalg.norm(identity - T, 2, axis=(1, 2))),
        highest(closed, grid, lambda T: np.linalg.norm(T, 2, axis=(1, 2))),
    )


def _at(loop: LinearModel, s: complex) -> Any:
    return transfer_at(loop, np.array([s]))[0, 0, 0]


def _gain_crossings(loop: LinearModel, grid: np.ndarray, values: np.ndarray) -> list[Crossing]:
    try:
        found = [(0.0, float(_at(loop, 0.0).real))]
    except InputError:  # the loop integrates
        found = []
    # A loop that is real up to rounding runs along the axis and does not cross it.
    across = np.where(np.abs(values.imag) > 1e-12 * np.abs(values), values, values.real)
    for omega in _sign_changes(loop, grid, across, lambda value: value.imag):
        found.append((omega, float(_at(loop, 1j * omega).real)))
    if loop.delays is None:
        found.append((math.inf, float(loop.D[0, 0])))
    return [
        Crossing(-1.0 / value, omega) for omega, value in found if -_LARGEST < value < -_SMALLEST
    ]


def _sign_changes(
    loop: LinearModel,
    grid: np.ndarray,
    values: np.ndarray,
    function: Callable[[np.ndarray], np.ndarray],
) -> list[float]:
    """Return the frequencies at which a function of L(jω) changes its sign."""
    from scipy.optimize import brentq

    # A value of exactly zero is passed over: the crossing is between its neighbours.
    signs = np.sign(function(values))
    sound = np.flatnonzero(signs)

    def at(omega: float) -> float:
        return float(function(_at(loop, 1j * omega)))

    return [
        float(brentq(at, grid[low], grid[high], xtol=1e-15 * grid[low], rtol=1e-14))
        for low, high in pairwise(sound.tolist())
        if signs[low] != signs[high] and max(abs(values[low]), abs(values[high])) > _SMALLEST / 10.0
    ]
