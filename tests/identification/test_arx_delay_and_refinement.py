"""The delay by J(d), and the simplex search against other optimisers and closed forms."""

import numpy as np
import pytest
from refusals import refused
from scipy.optimize import least_squares
from scipy.signal import cont2discrete, lsim

from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.identification.arx import fit_arx, fits_by_delay
from clepsydra.identification.simplex_refinement import (
    refined_coefficients,
    second_order_of_gain,
    simplex_fit,
)


@pytest.mark.parametrize("delay", [0, 2, 7])
def test_the_right_delay_is_chosen_under_noise(delay):
    random = np.random.default_rng(delay)
    model = SampledModel((0.05, 0.04), (-1.5, 0.56), delay, 1.0)
    u = random.normal(size=600)
    y = model.output(u) + 0.01 * random.normal(size=600)
    fits = fits_by_delay(u, y, order=2, delays=range(9))
    assert [fit.model.delay for fit in fits.values()] == [*fits] == [*range(9)]
    assert np.argmin([fit.cost for fit in fits.values()]) == delay


def test_every_delay_is_judged_by_the_same_samples():
    random = np.random.default_rng(1)
    u, y = random.normal(size=(2, 80))
    fits = fits_by_delay(u, y, order=1, delays=(0, 5))
    assert [len(fit.residuals) for fit in fits.values()] == [74, 74]
    # The longest delay leaves those of a fit to the whole record.
    whole = fit_arx(u, y, order=1, delay=5, period=1.0)
    assert fits[5].cost == pytest.approx(whole.cost, rel=1e-12)


def test_a_delay_after_which_the_record_tells_nothing_is_left_out():
    """The input moves in the last sample but five."""
    u, y = np.eye(40)[34], np.arange(40.0) ** 2
    assert [*fits_by_delay(u, y, order=1, delays=range(9))] == [*range(5)]


def step_record(minutes=80):
    """Return a step of the inflow of eight tanks in series, 3.08/(2 s + 1)^8, held each minute."""
    u = np.concatenate([np.zeros(1), np.full(minutes, 0.04)])
    chain = ([3.08], np.poly(np.full(8, -0.5)) * 2.0**8)
    return u, lsim(chain, u, np.arange(len(u)), interp=False)[1]


def test_the_simplex_finds_what_gradients_find():
    """Output error, all four coefficients, against Levenberg and Marquardt."""
    u, y = step_record()
    start = SampledModel((0.03, 0.03), (-1.777, 0.796), 5, 1.0)
    found = refined_coefficients(start, u, y)

    def difference(p):
        return SampledModel(tuple(p[2:]), tuple(p[:2]), 5, 1.0).output(u) - y

    other = least_squares(difference, [-1.777, 0.796, 0.03, 0.03], method="lm", xtol=1e-15,
                          ftol=1e-15, gtol=1e-15, x_scale=[1.0, 1.0, 0.03, 0.03])  # fmt: skip
    assert np.sum((found.output(u) - y) ** 2) == pytest.approx(2.0 * other.cost, rel=1e-6)
    assert [*found.denominator, *found.numerator] == pytest.approx(other.x, rel=1e-3)


def test_the_model_of_the_document_is_a_held_second_order_model_of_its_gain():
    """−1.7765, 0.7958, 0.03096, 0.02869, as another hand found it."""
    found = second_order_of_gain(*step_record(), gain=3.08, delay=5, period=1.0, start=(0.1, 1.0))
    assert found.denominator == pytest.approx((-1.7765, 0.7958), abs=6e-5)
    assert found.numerator == pytest.approx((0.03096, 0.02869), abs=6e-6)
    assert found.static_gain == pytest.approx(3.08, rel=1e-9)
    # k ω²/(s² + 2ζω s + ω²) with the same poles, held by SciPy.
    slow = np.poly(np.log(np.roots(found.A)))
    held, *_ = cont2discrete(([3.08 * slow[-1]], slow), 1.0)
    assert found.numerator == pytest.approx(held[0, 1:], rel=1e-9)


def test_a_search_that_cannot_end_is_refused():
    u = np.sin(np.arange(40.0))
    with refused(place="simplex search"):
        simplex_fit(
            lambda p: SampledModel((1e250,), (-50.0 + p[0],), 0, 1.0), np.array([1.0]), u, u[::-1]
        )
