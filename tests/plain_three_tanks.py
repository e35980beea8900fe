"""Model (2) of the document on three tanks in three decimals, and gains and poles of it by hand."""

import numpy as np


def characteristic(K):
    """Of (2) in three decimals under some gains, by hand."""
    b, a21, a32, a22, a33 = 64.94, 0.032, 0.026, 0.058, 0.037
    minor = np.array([1.0, a22 + a33, a22 * a33 - a32**2])
    coupled = np.array([a21**2, a21**2 * a33])
    plain = np.polysub(np.polymul([1.0, a21], minor), coupled)
    fed = K[0] * minor + [0.0, K[1] * a21, K[1] * a21 * a33 + K[2] * a21 * a32]
    return np.polyadd(plain, b * fed)


def gains_for(wanted):
    """K that makes a characteristic polynomial, which is affine in K."""
    start = characteristic(np.zeros(3))
    slopes = np.array([characteristic(own) - start for own in np.eye(3)])
    return np.linalg.solve(slopes[:, 1:].T, (wanted - start)[1:])


def optimal_poles(weight):
    """Of Q33 = 10000 and an R, (2) in three decimals, by the stable half of a spectrum."""
    plain = characteristic(np.zeros(3))
    both = np.polymul(plain, plain * [-1, 1, -1, 1])
    both[-1] += 1e4 / weight * (64.94 * 0.032 * 0.026) ** 2
    roots = np.roots(both)
    return roots[roots.real < 0]
