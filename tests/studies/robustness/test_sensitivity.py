"""Sobol indices against theory, published numbers and SciPy."""

import math

import numpy as np
import pytest
import scipy.stats
from refusals import refused
from scipy.stats import binom, sobol_indices

from clepsydra.studies.robustness.saltelli import SaltelliDesign
from clepsydra.studies.robustness.sensitivity import LEAST_ROWS, SobolIndex, sensitivities

#: Of the Ishigami function with a = 7 and b = 0.1: T. Ishigami and T. Homma 1990; Saltelli et al.,
#: Global Sensitivity Analysis, 2008, printed to four digits.
ISHIGAMI = {"x1": (0.3139, 0.5576), "x2": (0.4424, 0.4424), "x3": (0.0, 0.2437)}


def ishigami(numbers):
    x1, x2, x3 = math.pi * (2.0 * numbers.T - 1.0)
    return np.sin(x1) + 7.0 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def singles(count):
    return {f"x{n + 1}": (n,) for n in range(count)}


def indices(found):
    return np.array([[each[name].value for name in each] for each in (found.first, found.total)])


def test_indices_of_the_ishigami_function_are_the_published_ones():
    design = SaltelliDesign(singles(3), rows=2**14, seed=11)
    found = sensitivities(design, {"y": ishigami(design.unit_numbers())})["y"]
    for name, (first, total) in ISHIGAMI.items():
        # The standard error of random rows is below 0.01 here, that of a Sobol sequence less.
        assert found.first[name].value == pytest.approx(first, abs=0.01)
        assert found.total[name].value == pytest.approx(total, abs=0.01)
        assert found.first[name].low <= first <= found.first[name].high
        assert found.total[name].low <= total <= found.total[name].high
    assert (found.rows, found.left_out, found.varies, found.known) == (2**14, 0, True, True)


def test_what_is_added_has_shares_of_the_squared_weights():
    weights = np.array([1.0, 2.0, 4.0, 0.0])
    design = SaltelliDesign(singles(4), rows=2**13, seed=3)
    scores = 1e6 + design.unit_numbers() @ weights  # far from zero, as levels in pascals are
    found = sensitivities(design, {"y": scores})["y"]
    shares = weights**2 / np.sum(weights**2)
    assert indices(found) == pytest.approx(np.array([shares, shares]), abs=0.01)
    assert found.first["x4"] == found.total["x4"] == SobolIndex(0.0, 0.0, 0.0)


def test_columns_of_a_group_count_as_one():
    """A product acts together; within its group nothing of that is left."""
    design = SaltelliDesign({"pair": (2, 0), "other": (1,)}, rows=2**13, seed=5)
    numbers = design.unit_numbers() - 0.5
    found = sensitivities(design, {"y": numbers[:, 0] * numbers[:, 2] + 0.5 * numbers[:, 1]})["y"]
    pair, other = 1.0 / 144.0, 0.25 / 12.0  # variances: (1/12)², 0.5²/12
    shares = np.array([pair, other]) / (pair + other)
    assert indices(found) == pytest.approx(np.array([shares, shares]), abs=0.01)
    alone = SaltelliDesign(singles(3), rows=2**13, seed=5)
    numbers = alone.unit_numbers() - 0.5
    found = sensitivities(alone, {"y": numbers[:, 0] * numbers[:, 2]})["y"]
    assert indices(found) == pytest.approx(np.array([[0, 0, 0], [1, 0, 1]]), abs=0.03)


def test_indices_are_those_of_scipy():
    design = SaltelliDesign(singles(3), rows=256, seed=2)
    scores = np.stack([ishigami(design.unit_numbers()), design.unit_numbers().sum(axis=1) ** 3])
    blocks = scores.reshape(2, 5, 256)
    theirs = sobol_indices(
        func={"f_A": blocks[:, 0], "f_B": blocks[:, 1], "f_AB": np.moveaxis(blocks[:, 2:], 1, 0)},
        n=256,
    )
    ours = sensitivities(design, {"a": scores[0], "b": scores[1]})
    for n, name in enumerate("ab"):
        assert indices(ours[name]) == pytest.approx(
            np.array([theirs.first_order[n], theirs.total_order[n]]), rel=1e-9, abs=1e-12
        )


def test_intervals_are_those_of_scipy():
    """Of the same resamples: counts of rows and what is left out give what evaluation gives."""
    design = SaltelliDesign(singles(3), rows=128, seed=4)
    first, second, *mixed = ishigami(design.unit_numbers()).reshape(5, 128)
    mean = np.mean([first, second])
    first, second, mixed = first - mean, second - mean, np.array(mixed) - mean

    def evaluated(rows):
        a, b, m = first[rows], second[rows], mixed[:, rows]
        variance = np.var([a, b])
        return (
            np.array([np.mean(b * (m - a), axis=1), 0.5 * np.mean((a - m) ** 2, axis=1)]) / variance
        )

    theirs = scipy.stats.bootstrap(
        [np.arange(128)],
        evaluated,
        method="BCa",
        n_resamples=999,
        vectorized=False,
        rng=np.random.default_rng((4, 1)),
    ).confidence_interval
    ours = sensitivities(design, {"y": ishigami(design.unit_numbers())})["y"]
    for kind, each in enumerate((ours.first, ours.total)):
        for n, index in enumerate(each.values()):
            assert index.low == pytest.approx(theirs.low[kind, n], rel=1e-9)
            assert index.high == pytest.approx(theirs.high[kind, n], rel=1e-9)


def test_rows_with_a_broken_loop_are_left_out_as_a_whole():
    design = SaltelliDesign(singles(3), rows=1024, seed=6)
    scores = ishigami(design.unit_numbers())
    broken = scores.copy()
    # Draws 5 of A, 5 and 9 of B, and 700 of the last block: rows 5, 9 and 700.
    broken[[5, 1024 + 5, 1024 + 9, 4 * 1024 + 700]] = [math.inf, math.nan, -math.inf, math.inf]
    found = sensitivities(design, {"whole": scores, "broken": broken})
    assert (found["broken"].rows, found["broken"].left_out) == (1021, 3)
    assert found["whole"].left_out == 0
    blocks = np.delete(scores.reshape(5, 1024), [5, 9, 700], axis=1)
    a, b, mixed = blocks[0], blocks[1], blocks[2:]
    mean = np.mean([a, b])
    variance = np.var([a, b])
    first = np.mean((b - mean) * (mixed - a), axis=1) / variance
    total = 0.5 * np.mean((mixed - a) ** 2, axis=1) / variance
    assert indices(found["broken"]) == pytest.approx(np.array([first, total]), rel=1e-9)
    assert str(found["broken"]).endswith("of 1,024 rows, 3 have a draw without a finite score")


@pytest.mark.parametrize(
    ("rows", "broken", "known"),
    [
        (64, 0, True),
        (64, 1, False),
        (32, 0, False),
        (1024, 512, True),
        (1024, 513, False),
    ],
)
def test_too_few_rows_give_no_indices(rows, broken, known):
    design = SaltelliDesign(singles(2), rows=rows, seed=1)
    scores = design.unit_numbers().sum(axis=1)
    scores[:broken] = math.inf
    found = sensitivities(design, {"y": scores})["y"]
    assert found.known == known == bool(found.first)
    assert (found.rows, found.left_out) == (rows - broken, broken)
    assert LEAST_ROWS == 64


@pytest.mark.parametrize("value", [0.0, 0.1, -1e300])
def test_a_score_that_does_not_vary_has_no_share_of_anything(value):
    design = SaltelliDesign(singles(2), rows=128, seed=1)
    found = sensitivities(design, {"y": np.full(design.draws, value)})["y"]
    assert not found.varies and found.known
    assert np.array_equal(indices(found), np.zeros((2, 2)))
    assert str(found) == "the score does not vary"


@pytest.mark.parametrize("scale", [1e-300, 1e-9, 1e300])
def test_the_unit_of_a_score_is_nothing(scale):
    design = SaltelliDesign(singles(3), rows=256, seed=8)
    scores = ishigami(design.unit_numbers())
    found = sensitivities(design, {"one": scores, "other": scale * scores})
    assert indices(found["other"]) == pytest.approx(indices(found["one"]), rel=1e-9, abs=1e-12)


def test_which_other_scores_there_are_is_nothing():
    design = SaltelliDesign(singles(3), rows=128, seed=9)
    scores = ishigami(design.unit_numbers())
    both = sensitivities(design, {"square": scores**2, "y": scores})
    assert both["y"] == sensitivities(design, {"y": scores})["y"]


@pytest.mark.thorough
def test_intervals_hold():
    """At least 95 % of them, of 200 scramblings; more, since so many rows are spread evenly."""
    held = np.zeros((2, 3))
    for seed in range(200):
        design = SaltelliDesign(singles(3), rows=2048, seed=seed)
        found = sensitivities(design, {"y": ishigami(design.unit_numbers())})["y"]
        for n, (name, true) in enumerate(ISHIGAMI.items()):
            for kind, each in enumerate((found.first, found.total)):
                held[kind, n] += each[name].low <= true[kind] <= each[name].high
    assert np.all(held >= binom.ppf(1e-3, 200, 0.95))


def test_the_design_has_each_block_with_the_columns_of_its_group():
    design = SaltelliDesign({"a": (3, 0), "b": (1,), "c": (2,)}, rows=64, seed=1)
    assert (design.columns, design.draws) == (4, 320)
    first, second, *mixed = design.unit_numbers().reshape(5, 64, 4)
    for columns, block in zip(design.groups.values(), mixed, strict=True):
        others = [n for n in range(4) if n not in columns]
        assert np.array_equal(block[:, columns], second[:, columns])
        assert np.array_equal(block[:, others], first[:, others])
    assert not np.any(first == second)


def test_the_design_fills_its_space_and_comes_from_its_seed():
    design = SaltelliDesign(singles(5), rows=256, seed=12)
    numbers = design.unit_numbers()
    assert np.array_equal(numbers, design.unit_numbers())
    assert not np.any(numbers == SaltelliDesign(singles(5), rows=256, seed=13).unit_numbers())
    # Each is the middle of one of 2³² cells, so that none is 0, which a normal draw has at −∞.
    assert np.all((numbers * 2.0**33) % 2.0 == 1.0)
    for column in np.hstack(np.split(numbers[:512], 2)).T:  # one in each of 256 even steps
        assert np.array_equal(np.sort(np.floor(256 * column)), np.arange(256))


@pytest.mark.parametrize(
    "groups",
    [
        {},
        {"a": ()},
        {"a": (0,), "b": (0,)},
        {"a": (0, 2)},
        {"a": (0,), "b": ()},
        {"a": tuple(range(10_601))},
    ],
)
def test_groups_that_are_no_partition_are_refused(groups):
    with refused(place="groups of a sensitivity study"):
        SaltelliDesign(groups, rows=64, seed=1)


@pytest.mark.parametrize("rows", [0, 1, 100, 1023])
def test_rows_that_are_no_power_of_two_are_refused(rows):
    with refused(place="rows of a sensitivity study"):
        SaltelliDesign(singles(1), rows=rows, seed=1)


def test_scores_of_another_design_are_refused():
    design = SaltelliDesign(singles(2), rows=64, seed=1)
    with pytest.raises(ValueError, match="320 scores for a design of 256 draws"):
        sensitivities(design, {"y": np.zeros(320)})
