"""The relative gain array over frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.relative_gain_array import relative_gain_array
from clepsydra.linear.response import frequency_response


def relative_gain_response(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return Λ(jω) = G ∘ (G⁻¹)ᵀ at each frequency, exact with dead time.

    Near the crossover of the loops it should be close to one on the pairs that are chosen;
    what it is at rest matters only to integral action.

    Parameters
    ----------
    model : LinearModel
    omegas : array_like [l]
        [rad/s]

    Returns
    -------
    ndarray [l, q, m], complex
        [1]

    Raises
    ------
    InputError
        A frequency is not finite or is a pole (use `relative_gains` for the limit at zero), or
        G is singular there: the frequency is a zero.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, chapter
    3.

    Examples
    --------
    >>> A, B = -np.eye(2), np.array([[2.0, 1.0], [1.0, 2.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.eye(2), np.zeros((2, 2)), ("a", "b"),
    ...                     ("u", "v"), (), ("y", "z"))
    >>> relative_gain_response(model, 0.1)[0].real.round(6).tolist()
    [[1.333333, -0.333333], [-0.333333, 1.333333]]
    """
    frequencies = np.atleast_1d(np.asarray(omegas, float))
    arrays = []
    for frequency, gain in zip(frequencies, frequency_response(model, frequencies), strict=True):
        try:
            arrays.append(relative_gain_array(gain))
        except InputError:
            raise InputError(
                f"relative gain array, ω = {frequency:.6g} rad/s",
                gain.tolist(),
                "a response of full rank",
                "leave the frequency out: some combination of the outputs answers to no input",
            ) from None
    return np.array(arrays).reshape(len(frequencies), len(model.outputs), len(model.inputs))
