"""Plants and a controller that the tests of the interface share."""

import pytest

import clepsydra as cl


@pytest.fixture(scope="session")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="session")
def basin():
    """One level in % with a direct-acting controller."""
    return cl.load("equalisation-tank")


@pytest.fixture(scope="session")
def pi(plant):
    return cl.design.simc(plant)
