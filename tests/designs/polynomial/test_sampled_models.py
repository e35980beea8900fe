"""Sampled transfer functions against python-control and SciPy, and what is refused."""

import itertools

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from clepsydra import InputError, NotApplicable
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.polynomial.element_sampling import sampled_element, sampled_transfer
from clepsydra.designs.polynomial.moment_matching import with_two_lags
from clepsydra.designs.polynomial.sampled_model import SampledModel


@pytest.mark.parametrize(
    ("above", "below"),
    [([2.0], [5.0, 1.0]), ([0.4, 1.0], [1.0, 0.3, 0.2]), ([3.0], [1.0, 0.5, 0.0])],
)
def test_the_held_transfer_function_is_that_of_python_control(above, below):
    model = sampled_transfer(above, below, delay=3, period=0.5)
    reference = control.sample_system(control.tf(above, below), 0.5, method="zoh")
    assert model.delay == 3
    assert pytest.approx(np.array(reference.den[0][0]), abs=1e-12) == model.A
    expected = np.array(reference.num[0][0])
    assert np.array(model.numerator)[-len(expected) :] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("late", [0.0, 0.3, 0.75, 2.6])
@pytest.mark.parametrize("poles", [(-0.4,), (-0.4, -1.5), (-0.3 + 0.8j, -0.3 - 0.8j)])
def test_a_part_of_a_sample_of_dead_time_is_exact(poles, late):
    """Against the differential equation under a random staircase that comes late."""
    element = TransferElement(1.7, poles, (-0.9,) if len(poles) == 2 else (), 0, late)
    model = sampled_element(element, 1.0)
    u = np.random.default_rng(4).normal(size=25)
    below = np.real(np.poly(poles))
    above = 1.7 * np.prod([-p for p in poles]).real * (
        np.array([1.0, 0.9]) / 0.9 if element.zeros else np.ones(1)
    )  # fmt: skip
    n = len(poles)
    A, C = np.diag(np.ones(n - 1), 1), np.zeros(n)
    A[-1], C[: len(above)] = -below[:0:-1], above[::-1]
    state, expected = np.zeros(n), []
    moments = np.unique(np.concatenate([np.arange(26.0), np.arange(25.0) + late % 1.0]))
    for start, stop in itertools.pairwise(moments):
        if start == int(start):
            expected.append(C @ state)
        place = int(np.floor(0.5 * (start + stop) - late))
        held = u[place] if 0 <= place < len(u) else 0.0

        def rate(_, x, held=held):
            return A @ x + np.eye(n)[-1] * held

        state = solve_ivp(rate, (start, stop), state, rtol=1e-10, atol=1e-12).y[:, -1]
    assert model.output(u) == pytest.approx(np.array(expected)[: len(u)], abs=1e-7)


def test_a_long_chain_is_reduced_to_its_moments():
    """Mean and spread of the impulse response of the reduced model are those of the chain."""
    element = TransferElement(3.0, (-0.5,) * 6 + (-0.2,), (-1.1,), 0, 2.3)
    reduced = with_two_lags(element, 1.0)

    def moments(g):
        mean = g.dead_time + sum(-1 / p for p in g.poles) - sum(-1 / z for z in g.zeros)
        return complex(mean).real, complex(
            sum(1 / p**2 for p in g.poles) - sum(1 / z**2 for z in g.zeros)
        ).real

    assert moments(reduced) == pytest.approx(moments(element), rel=1e-12)
    assert reduced.dead_time == round(reduced.dead_time)
    assert len(reduced.poles) == 2 and reduced.gain == 3.0
    # Frequency responses stay near up to the bandwidth.
    for omega in (0.01, 0.03, 0.06):
        given, found = (
            g.magnitude(omega) * np.exp(1j * g.phase(omega)) for g in (element, reduced)
        )
        assert abs(found / given - 1.0) < 0.03


def test_an_integrating_chain_keeps_its_integrator():
    reduced = with_two_lags(TransferElement(0.2, (-0.5,) * 4, (), 1), 1.0)
    assert reduced.integrators == 1 and reduced.dead_time == 4.0
    assert complex(reduced.poles[0]).real == pytest.approx(-0.25)


@pytest.mark.parametrize(
    ("element", "words"),
    [
        (TransferElement(1.0, (0.1, -1.0, -2.0), (), 0), "unstable"),
        (TransferElement(1.0, (-1.0,), (), 2), "integrates 2 times"),
        (TransferElement(1.0, (-1.0, -1.1, -1.2), (-0.01, -0.02), 0), "outweigh"),
        (TransferElement(1.0, (-1.0,), (), -1), "static gain is zero"),
        (TransferElement(1.0, (-1.0,), (-2.0,), 0), "at once"),
        (TransferElement(1.0, (-1.0,), (), 0, 500.0), "sample more slowly"),
    ],
)
def test_what_cannot_be_reduced_is_refused(element, words):
    with pytest.raises(NotApplicable, match=words):
        sampled_element(element, 1.0)


def test_slow_lags_sampled_fast_do_not_integrate():
    """Two of two hours at 1 s: A(1) is 2e-8, and each pole stands 1.4e-4 from 1."""
    lags = sampled_transfer([3.0], [7200.0**2, 14400.0, 1.0], delay=0, period=1.0)
    assert lags.static_gain == pytest.approx(3.0, rel=1e-4)


def test_responses_and_roots():
    model = SampledModel((0.2, 0.1), (-1.5, 0.6), 2, 0.5)
    u = np.random.default_rng(0).normal(size=(3, 40))
    y = np.zeros_like(u)
    for k in range(40):
        for j, b in enumerate(model.numerator, start=1):
            if k - j - 2 >= 0:
                y[:, k] += b * u[:, k - j - 2]
        for i, a in enumerate(model.denominator, start=1):
            if k >= i:
                y[:, k] -= a * y[:, k - i]
    assert model.output(u) == pytest.approx(y, abs=1e-12)
    assert model.zeros == pytest.approx([-0.5])
    assert model.static_gain == pytest.approx(3.0)
    z = np.exp(0.3j)
    expected = (0.2 / z + 0.1 / z**2) / (1 - 1.5 / z + 0.6 / z**2) / z**2
    assert model.response(z) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: SampledModel((1.0,), (-0.5,), 2.5, 1.0), "whole number of samples"),
        (lambda: SampledModel((1.0,), (-0.5,), -1, 1.0), "whole number of samples"),
        (lambda: SampledModel((0.0, 0.0), (-0.5,), 1, 1.0), "not zero"),
        (lambda: SampledModel((1.0,), (float("nan"),), 1, 1.0), "finite"),
        (lambda: SampledModel((1.0,), (-0.5,), 1, 0.0), "above 0 s"),
    ],
)
def test_models_that_are_none_are_refused(make, words):
    with pytest.raises(InputError, match=words):
        make()
