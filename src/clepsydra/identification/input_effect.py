"""Whether the input explains anything that the output does not do by itself."""

from __future__ import annotations

import numpy as np

from clepsydra.identification.noise_model import NoiseModel


def chance_of_no_effect(
    alone: np.ndarray,
    left: np.ndarray,
    *,
    further: int,
    parameters: int,
    noise: NoiseModel | None = None,
    rounding: float = 0.0,
) -> float:
    """Return the probability that an input without any effect explains as much.

    An F test of a model against the same model without its input. Where the residuals are
    coloured, both are whitened by their noise model first.

    Parameters
    ----------
    alone : ndarray [N]
        What the model without the input leaves.
    left : ndarray [N]
        What the model leaves.
    further : int
        How many parameters the input brought, with those that were searched.
    parameters : int
        All of the model.
    noise : NoiseModel or None
        The colour of `left`.
    rounding : float
        What is smaller is the arithmetic's, whatever the residuals are.

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal(200)
    >>> late = np.sign(np.sin(np.arange(200.0)))
    >>> chance_of_no_effect(noise + late, noise, further=2, parameters=4) < 1e-6
    True
    >>> chance_of_no_effect(1e-14 * late, 0.0 * late, further=2, parameters=4, rounding=1e-13) > 0.9
    True
    """
    from scipy.stats import f

    if noise is not None:
        alone, left = noise.whitened(alone), noise.whitened(left)
    freedom = len(left) - parameters
    least = len(left) * rounding**2
    unexplained = max(float(left @ left), least)
    explained = float(alone @ alone) - float(left @ left) - least
    if freedom < 1 or explained <= 0.0 or unexplained <= 0.0:
        return 1.0
    return float(f.sf(explained / further / (unexplained / freedom), further, freedom))
