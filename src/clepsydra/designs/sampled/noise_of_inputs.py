"""How far the noise of the sensors moves the inputs of a sampled loop."""

from __future__ import annotations

import numpy as np

from clepsydra.controllers.linear_step_law import LinearStepLaw
from clepsydra.designs.sampled.sampled_loop import SampledLoops


def noise_of_inputs(loops: SampledLoops, law: LinearStepLaw, noise: np.ndarray) -> np.ndarray:
    """Return the standard deviation of each input that the noise of the sensors makes [m].

    Parameters
    ----------
    loops : SampledLoops
    law : LinearStepLaw
        The linear model of its law.
    noise : ndarray [p, p]
        Covariance of what is measured, white from sample to sample, in the order of the
        controller's measurements.

    Returns
    -------
    ndarray [m]
        [input unit]; infinite where the loop is unstable.

    Examples
    --------
    A PI controller that hardly integrates moves its pump by its gain times the noise of 1 mV,
    which the tank hardly answers:

    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> loops = SampledLoops(controller, plant.linear)
    >>> found = noise_of_inputs(loops, loops.law(controller.values), 1e-6 * np.eye(2))
    >>> gains = [controller.values[f"level_{k}.proportional_gain"] for k in (1, 2)]
    >>> (found / 1e-3 / np.abs(gains)).round(1)
    array([1., 1.])
    """
    from scipy.linalg import matrix_balance, solve_discrete_lyapunov

    loop, moved = loops.around(law), loops.moved
    if not loop.is_stable:
        return np.full(moved.shape[1], np.inf)
    by_noise = np.vstack([moved @ law.D_measurement, law.B_measurement])
    to_inputs = np.hstack([law.D_measurement @ loops.measured, law.C])
    # Balanced, since metres beside volts are nearly singular to the direct method, which warns.
    balanced, (sizes, _) = matrix_balance(loop.A, permute=False, separate=True)
    scaled = by_noise / sizes[:, None]
    spread = solve_discrete_lyapunov(balanced, scaled @ noise @ scaled.T)
    spread = spread * np.outer(sizes, sizes)
    direct = law.D_measurement @ noise @ law.D_measurement.T
    variances = np.diag(to_inputs @ spread @ to_inputs.T + direct)
    deviations: np.ndarray = np.sqrt(np.maximum(variances, 0.0))
    return deviations
