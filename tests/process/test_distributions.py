"""Distributions against closed forms: those of SciPy, and what can be written down."""

import math

import numpy as np
import pytest
from scipy import stats

from clepsydra import Signal
from clepsydra.process.distribution import (
    LEAST_SHARE,
    LogNormal,
    Measured,
    Normal,
    Scaled,
    Truncated,
    Uniform,
)

SHARES = np.concatenate([[LEAST_SHARE, 1e-9], np.linspace(0.001, 0.999, 333), [1 - LEAST_SHARE]])
# Two, a mean and a deviation, and where a log-normal has its logarithm.
CLOSED = [
    (Uniform(2.0, 5.0), stats.uniform(2.0, 3.0)),
    (Normal(3.0, 0.2), stats.norm(3.0, 0.2)),
    (Normal(-3.0, 0.2), stats.norm(-3.0, 0.2)),
    (LogNormal(3.0, 0.2), stats.lognorm(0.2, scale=3.0)),
    (Truncated(Normal(3.0, 0.2), 2.8, math.inf), stats.truncnorm(-1.0, np.inf, 3.0, 0.2)),
    (Truncated(Normal(0.9, 0.05), 0.0, 1.0), stats.truncnorm(-18.0, 2.0, 0.9, 0.05)),
    (Scaled("other", Normal(3.0, 0.2), 3.0, 6.0), stats.norm(6.0, 0.4)),
    (Scaled("other", Uniform(2.0, 5.0), 3.0, 0.6), stats.uniform(0.4, 0.6)),
]


@pytest.mark.parametrize(("own", "closed"), CLOSED, ids=lambda each: type(each).__name__)
def test_quantiles_and_shares_are_those_of_the_closed_form(own, closed):
    inner = SHARES[2:-1]
    # Both round shares, of which the density makes values.
    assert own.quantile(inner) == pytest.approx(closed.ppf(inner), rel=1e-11)
    values = closed.ppf(inner)
    found = [own.below(value) for value in values]
    assert found == pytest.approx(inner, rel=1e-10)
    low, high = own.ends
    assert low == pytest.approx(closed.support()[0]) and high == pytest.approx(closed.support()[1])


def test_a_negative_median_is_mirrored():
    own, mirror = LogNormal(-3.0, 0.2), LogNormal(3.0, 0.2)
    inner = SHARES[1:-1]
    assert own.quantile(inner) == pytest.approx(-mirror.quantile(1.0 - inner), rel=1e-7)
    assert own.below(-3.3) == pytest.approx(1.0 - mirror.below(3.3), rel=1e-12)
    assert own.ends == (-math.inf, 0.0) and own.below(1.0) == 1.0


#: Here the quantile of the share at an end is beyond it by rounding.
ROUNDED = [
    Truncated(Normal(0.362, 0.217), 0.32, 1.0),
    Truncated(Normal(0.332, 0.273), 0.11, 1.0),
    Uniform(-0.7, 0.1),
]


@pytest.mark.parametrize("own", [own for own, _ in CLOSED] + ROUNDED, ids=repr)
def test_quantiles_rise_and_stay_within_the_ends(own):
    found = own.quantile(SHARES)
    assert np.all(np.isfinite(found)) and np.all(np.diff(found) >= 0.0)
    assert own.ends[0] <= found[0] and found[-1] <= own.ends[1]


def test_measured_values_come_by_their_weights():
    own = Measured.of((3.0, 1.0, 2.0), (1.0, 5.0, 4.0))
    assert own.quantile(np.array([0.1, 0.499, 0.501, 0.899, 0.901, 1 - LEAST_SHARE])).tolist() == [
        1.0, 1.0, 2.0, 2.0, 3.0, 3.0,
    ]  # fmt: skip
    assert [own.below(value) for value in (0.9, 1.0, 2.5, 3.0)] == [0.0, 0.5, 0.9, 1.0]
    # At a step it is the lower one, of which that much lies at it or below.
    assert Measured.of((1.0, 2.0)).quantile(np.array([0.5])).item() == 1.0
    third = Measured.of((1.0, 2.0, 3.0)).quantile(np.arange(0.5, 300) / 300)
    assert np.unique(third, return_counts=True)[1].tolist() == [100, 100, 100]


def test_a_value_without_weight_never_comes():
    own = Measured.of((1.0, 2.0, 3.0), (0.0, 1.0, 0.0))
    assert set(own.quantile(SHARES)) == {2.0}


def test_what_nothing_lies_outside_of_stays_as_it_is():
    own = Normal(3.0, 0.2)
    assert own.truncated(0.0, math.inf) is own
    assert own.outside(0.0, math.inf) < LEAST_SHARE
    assert own.truncated(2.9, math.inf) == Truncated(own, 2.9, math.inf)
    assert Uniform(0.9, 1.1).truncated(0.0, 1.0) == Uniform(0.9, 1.0)


def test_words():
    gain = Signal("pump_1.gain", "m^3/(s V)", "cm^3/(s V)", low=0.0, initial=3.33e-6)
    assert Uniform(3.0e-6, 3.5e-6).words(gain) == "uniform, 3 to 3.5 cm³/(s V)"
    assert Normal(0.0, 1e-6).words(gain) == (
        "normal with a deviation of 1 cm³/(s V), about 0 cm³/(s V)"
    )
    assert (
        Truncated(Normal(3e-6, 9e-7), 0.0, math.inf)
        .words(gain)
        .endswith("about 3 cm³/(s V), of which 0 cm³/(s V) or more is left")
    )
    assert Scaled("pump_2.gain", Uniform(1.0, 3.0), 2.0, 3.33e-6).words(gain) == (
        "as pump_2.gain, about 3.33 cm³/(s V)"
    )
