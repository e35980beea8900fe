"""Zeros with the directions in which they block."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import origin_radius
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.roots import roots_of
from clepsydra.linear.zeros import normal_rank, reduced_system, zeros

# Far above what null vectors of a small matrix are rounded by, far below what anyone reads.
_ROUNDING = 1e-12


class ZeroDirection(NamedTuple):
    """A transmission zero z, with G(z) input_direction = 0 and output_directionᴴ G(z) = 0.

    Parameters
    ----------
    zero : complex
        [rad/s]
    input_direction : ndarray [m], complex
        The combination of inputs that no output shows; of length one.
    output_direction : ndarray [q], complex
        The combination of outputs that no input moves; of length one. For a zero in the right
        half-plane it is what first goes the wrong way, and its largest entry is the output that
        suffers.
    """

    zero: complex
    input_direction: np.ndarray
    output_direction: np.ndarray


def blocking_zeros(model: LinearModel) -> list[ZeroDirection]:
    """Return the zeros in the right half-plane with directions in shares of the ranges if known.

    Of a conjugate pair it is the one above.

    Examples
    --------
    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank-nonminimum-phase").linear
    >>> [round(found.zero.real, 4) for found in blocking_zeros(model)]
    [0.0128]
    """
    roots = roots_of(model)
    radius = origin_radius(roots.zeros_of.A)
    if not np.any(roots.zeros.real > radius):
        return []
    farthest = np.abs(roots.zeros).max() * (1.0 + 1e-6)
    return [
        found
        for found in zero_directions(in_known_ranges(roots.zeros_of) or roots.zeros_of)
        if found.zero.real > radius and found.zero.imag >= 0.0 and abs(found.zero) <= farthest
    ]


def zero_directions(model: LinearModel) -> list[ZeroDirection]:
    """Return each zero with its input and output direction, in the order of `zeros`.

    They are the null vectors of the Rosenbrock matrix [[A - z I, B], [C, D]] of the minimal
    realisation, so a zero that is a pole as well has them too. The largest entry is real and
    positive. Directions depend on units: `in_known_ranges(model)` gives those that compare.

    Returns
    -------
    list of ZeroDirection
        Of a zero that stands twice with two directions, two.

    Raises
    ------
    InputError
        The model has dead time: it may have infinitely many zeros.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section
    4.5.

    Examples
    --------
    (1 - s)/(s + 1)² from the first input to the first output, beside 1/(s + 1):

    >>> A = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    >>> B = np.array([[-1.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.eye(3)[[0, 2]], np.zeros((2, 2)), ("a", "b", "c"),
    ...                     ("u", "v"), (), ("y", "z"))
    >>> found = zero_directions(model)[0]
    >>> abs(found.zero - 1.0) < 1e-9, found.output_direction.real.round(6).tolist()
    (True, [1.0, 0.0])
    """
    roots = zeros(model)
    scaled, _ = reduced_system(model)
    n, full_rank = len(scaled.A), normal_rank(model)
    system = np.block([[scaled.A, scaled.B], [scaled.C, scaled.D]]).astype(complex)
    found = []
    for place, root in enumerate(roots):
        # A root that stands again takes the next null vector of the same matrix: with its last
        # digits, which are rounding, the null vectors of a second one would be any others.
        same = np.flatnonzero(np.abs(roots[: place + 1] - root) <= 1e-9 * abs(root))
        matrix = system.copy()
        matrix[:n, :n] -= roots[same[0]] / scaled.rate * np.eye(n)
        left, _, right = np.linalg.svd(matrix)
        null = n + full_rank - len(same)
        inputs = right.conj()[null, n:] / scaled.input_sizes
        outputs = left[n:, null] / scaled.output_sizes
        found.append(ZeroDirection(complex(root), unit_direction(inputs), unit_direction(outputs)))
    return found


def unit_direction(vector: np.ndarray) -> np.ndarray:
    """Return a complex vector at length one with its largest entry positive; zero stays zero.

    Of entries as large as each other the first is positive, and what is but rounding is zero, so
    that the direction does not depend on how the linear algebra happened to round.

    Examples
    --------
    >>> unit_direction(np.array([-1.0, 1.0 + 1e-15, -1e-17])).real.round(3)
    array([ 0.707, -0.707,  0.   ])
    >>> unit_direction(np.array([0.0, -2.0j])).real
    array([0., 1.])
    """
    sizes = np.abs(vector)
    length = np.linalg.norm(sizes)
    if length == 0.0:
        return np.asarray(vector, complex)
    largest = vector[int(np.argmax(sizes >= (1.0 - _ROUNDING) * sizes.max()))]
    turned = np.asarray(vector * (np.abs(largest) / largest) / length, complex)
    parts = turned.view(float)
    parts[np.abs(parts) < _ROUNDING] = 0.0
    return turned
