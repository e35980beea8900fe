"""The shaped plant: what a robust controller sees of the process through a pre-compensator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loop_shaping.precompensator import Precompensator
from clepsydra.designs.sampled.sampled_process import sampled_process
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.designs.states.measured_states import without_idle_states
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

#: The Riccati equations of more states take seconds.
MOST_STATES = 200
_PER_DECADE = 40


@dataclass(frozen=True, eq=False)
class ShapedPlant:
    """G_s = S⁻¹ G W₁ S, errors and outputs in shares of the ranges S of the measurements.

    Parameters
    ----------
    sizes : ndarray [q]
        Ranges of the controlled measurements, or one where they have none.
    period : float
        [s]

    Examples
    --------
    See `shaped_plant`.
    """

    system: SampledSystem
    precompensator: Precompensator
    sizes: np.ndarray
    period: float

    @property
    def crossover(self) -> float:
        """Lowest frequency at which the smallest singular value is one or less [rad/s]."""
        angles = np.geomspace(1e-6, np.pi, int(6.5 * _PER_DECADE))
        smallest = np.linalg.svd(self.system.response(angles), compute_uv=False)[:, -1]
        below = np.flatnonzero(smallest <= 1.0)
        return float(angles[below[0]] if len(below) else np.pi) / self.period


def shaped_plant(model: LinearModel, precompensator: Precompensator) -> ShapedPlant:
    """Return the process, sampled with its inputs held, behind a pre-compensator.

    Raises
    ------
    NotApplicable
        The process has a direct way from an input to an output, dead time that no sampled model
        holds, or too many states in all.

    Examples
    --------
    Four tanks and two integrals:

    >>> import clepsydra as cl
    >>> from clepsydra.designs.loop_shaping.precompensator import precompensator_of
    >>> plant = cl.load("quadruple-tank")
    >>> simc = cl.design.simc(plant)
    >>> found = shaped_plant(plant.linear, precompensator_of(simc, plant.linear))
    >>> len(found.system.A), round(found.crossover, 3)
    (6, 0.098)
    """
    point = operating_point_of(model)
    period = check_sampling_period(model)
    chosen = without_idle_states(model.select(precompensator.outputs, precompensator.inputs))
    if np.any(chosen.D != 0.0):
        raise NotApplicable("an input acts on an output at once, before it can be sampled")
    held, moved, shown = sampled_process(chosen, period)
    count = len(held) + len(precompensator.system.A)
    if count > MOST_STATES:
        raise NotApplicable(
            f"process and pre-compensator have {count} states, with what is on its way in dead "
            f"times, and its equations can be solved for {MOST_STATES}; sample more slowly"
        )
    spans = np.array([point.process.signal(name).span for name in chosen.outputs])
    sizes = np.where(np.isfinite(spans), spans, 1.0)
    process = SampledSystem(held, moved, shown, np.zeros((len(sizes), moved.shape[1])))
    A, B, C, D = precompensator.system.then(process)
    shaped = SampledSystem(A, B * sizes, C / sizes[:, None], D)
    return ShapedPlant(shaped, precompensator, sizes, period)
