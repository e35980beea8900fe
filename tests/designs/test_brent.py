"""Brent's searches take the steps of SciPy's, to the last bit."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from clepsydra.designs.models.brent import lowest_between, root_between

FUNCTIONS = (
    lambda a, x: a[0] * x**3 + a[1] * x**2 + a[2] * x + a[3],
    lambda a, x: math.exp(a[0] * x) - abs(a[1]) - 1.0 + a[2] * x,
    lambda a, x: math.atan(5.0 * (x - a[0])) + 0.3 * a[1],
    lambda a, x: math.floor(10.0 * (x - a[0])) + 0.5 * a[1],  # a jump, and flat between
)


def told(function, numbers):
    """Return a function of one number, and the list of what it is asked for."""
    asked = []
    return lambda x: (asked.append(float(x)), function(numbers, x))[1], asked


def drawn(seed):
    """Return functions with the ends between which to look."""
    draws = np.random.default_rng(seed)
    for place in range(200):
        low, high = sorted(draws.normal(0.0, 3.0, 2).tolist())
        yield FUNCTIONS[place % len(FUNCTIONS)], draws.normal(size=4).tolist(), low, high


@pytest.mark.parametrize("accuracy", [(2e-12, 4.0 * 2.0**-52), (1e-15, 1e-15), (1e-3, 1e-3)])
def test_a_root_is_found_by_the_steps_of_scipy(accuracy):
    absolute, relative = accuracy
    count = 0
    for function, numbers, low, high in drawn(1):
        (ours, asked), (theirs, wanted) = told(function, numbers), told(function, numbers)
        if function(numbers, low) * function(numbers, high) > 0.0:
            with pytest.raises(ValueError, match="no change of sign"):
                root_between(ours, low, high)
            continue
        found = root_between(ours, low, high, absolute=absolute, relative=relative)
        assert found == brentq(theirs, low, high, xtol=absolute, rtol=relative)
        assert asked == wanted
        count += 1
    assert count > 30


@pytest.mark.parametrize("accuracy", [1e-3, 1e-9, 1e-12])
def test_a_lowest_place_is_found_by_the_steps_of_scipy(accuracy):
    for function, numbers, low, high in drawn(2):
        (ours, asked), (theirs, wanted) = told(function, numbers), told(function, numbers)
        options = {"xatol": accuracy}
        found = minimize_scalar(theirs, bounds=(low, high), method="bounded", options=options)
        assert lowest_between(ours, low, high, accuracy) == found.x
        assert asked == wanted


def test_a_root_at_an_end_is_found_there():
    assert root_between(lambda x: x, 0.0, 2.0) == 0.0
    assert root_between(lambda x: x - 2.0, 0.0, 2.0) == 2.0
