"""exp, log and pow of a kernel against 60 decimal digits, C99's table, and lane against lane."""

import math

import casadi as ca
import numpy as np
import pytest
from printed_functions import around, computed, law, same, worst

from clepsydra import Kernel, Signal, program_of
from clepsydra.engine.elementary_functions import ERROR_BOUND
from clepsydra.program.operation import LIBRARY
from clepsydra.program.step_law import Equations, step_law

SUBNORMAL_BOUND = 1.0
INFINITY, NAN = math.inf, math.nan

TURNS = np.log(2) * (np.arange(-1020, 1020) + 0.5)
RANDOM = np.random.default_rng(8)


@pytest.mark.parametrize(
    "x",
    [
        pytest.param(RANDOM.uniform(-708.0, 709.7, 1500), id="everywhere"),
        pytest.param(RANDOM.uniform(-1, 1, 500), id="around zero"),
        pytest.param(RANDOM.uniform(-1, 1, 500) * 2.0 ** RANDOM.integers(-70, 0, 500), id="tiny"),
        pytest.param(709.782712893384 - 1e-3 * np.arange(100), id="the largest"),
        pytest.param(around(TURNS, 3e-5, 1500, 1), id="where the exponent changes"),
    ],
)
def test_exp_is_within_its_bound(x):
    assert worst("exp", x) <= ERROR_BOUND["exp"]


@pytest.mark.parametrize(
    "x",
    [
        pytest.param(2.0 ** RANDOM.uniform(-1022, 1023, 600), id="everywhere"),
        pytest.param(2.0 ** RANDOM.uniform(-1074, -1022, 300), id="subnormal"),
        pytest.param(
            1 + RANDOM.uniform(-1, 1, 1000) * 2.0 ** RANDOM.integers(-52, -1, 1000), id="near one"
        ),
        pytest.param(
            around(np.sqrt(0.5) * np.array([0.5, 1, 2, 4]), 0.05, 1200, 2), id="at a root of 1/2"
        ),
    ],
)
def test_log_is_within_its_bound(x):
    assert worst("log", x) <= ERROR_BOUND["log"]


NEAR = np.where(
    RANDOM.random(600) < 0.5, RANDOM.uniform(0.708, 0.76, 600), RANDOM.uniform(1.3, 1.414, 600)
)
FAR = 2.0 ** RANDOM.uniform(-1022, 1023, 600)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("x", "y"),
    [
        pytest.param(FAR, RANDOM.uniform(-708, 709, 600) / np.log(FAR), id="everywhere"),
        pytest.param(NEAR, RANDOM.uniform(600, 708, 600) / np.log(NEAR), id="large results"),
        pytest.param(NEAR, RANDOM.uniform(-708, -600, 600) / np.log(NEAR), id="small results"),
        pytest.param(
            NEAR, around(TURNS[-100:], 3e-5, 600, 3) / np.log(NEAR), id="where the exponent changes"
        ),
        pytest.param(
            RANDOM.uniform(0, 100, 600), RANDOM.uniform(-3, 3, 600), id="what a plant asks for"
        ),
        pytest.param(FAR, 0.5, id="square roots"),
        pytest.param(RANDOM.uniform(0, 1e6, 600), 2.0, id="squares"),
        pytest.param(50.0, RANDOM.uniform(-1, 0, 600), id="equal-percentage valves"),
    ],
)
def test_pow_is_within_its_bound(x, y):
    x, y = np.broadcast_arrays(x, y)
    assert worst("pow", x, y) <= ERROR_BOUND["pow"]


def test_results_below_the_normal_range_are_within_one_unit():
    x = RANDOM.uniform(-745.1, -708.4, 800)
    assert worst("exp", x) <= SUBNORMAL_BOUND
    assert worst("pow", NEAR, RANDOM.uniform(-744, -708.5, 600) / np.log(NEAR)) <= SUBNORMAL_BOUND


def test_a_power_that_a_double_holds_is_returned_exactly():
    x = 2.0 ** RANDOM.uniform(-1074, 1023, 20000)
    assert np.array_equal(computed("pow", x, 1.0), x)
    whole = RANDOM.integers(1, 2**26, 20000).astype(float)
    assert np.array_equal(computed("pow", whole, 2.0), whole * whole)
    assert np.array_equal(computed("pow", whole * whole, 0.5), whole)
    exponents = np.arange(-1074.0, 1024.0)
    assert np.array_equal(
        computed("pow", np.full(2098, 2.0), exponents), np.ldexp(1.0, exponents.astype(int))
    )
    thirds = np.arange(-200.0, 200.0)
    assert np.array_equal(computed("pow", thirds, 3.0), thirds**3)


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        (0.0, 1.0),
        (-0.0, 1.0),
        (5e-324, 1.0),
        (INFINITY, INFINITY),
        (-INFINITY, 0.0),
        (NAN, NAN),
        (709.7827128933841, INFINITY),
        (1e308, INFINITY),
        (-745.1332191019411, 5e-324),
        (-745.1332191019412, 0.0),
        (-1e308, 0.0),
    ],
)
def test_exp_at_its_ends(x, expected):
    assert same(computed("exp", [x])[0], expected)


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        (0.0, -INFINITY),
        (-0.0, -INFINITY),
        (1.0, 0.0),
        (INFINITY, INFINITY),
        (-INFINITY, NAN),
        (-5e-324, NAN),
        (-1.0, NAN),
        (NAN, NAN),
    ],
)
def test_log_at_its_ends(x, expected):
    assert same(computed("log", [x])[0], expected)


def c99_power(x, y):
    """C99, F.9.4.4, for arguments whose power is 0, ±1, ∞ or not a number, or a small whole one."""
    if y == 0 or x == 1:
        return 1.0
    if math.isnan(x) or math.isnan(y):
        return NAN
    if math.isinf(y):
        if abs(x) == 1:
            return 1.0
        return INFINITY if (abs(x) > 1) == (y > 0) else 0.0
    odd = y == math.floor(y) and math.floor(y) % 2 == 1
    if x == 0 or math.isinf(x):
        size = 0.0 if (x == 0) == (y > 0) else INFINITY
        return math.copysign(size, x) if odd else size
    if x < 0 and y != math.floor(y):
        return NAN
    return None


SPECIAL = [0.0, 0.5, 1.0, 2.0, 2.5, 3.0, 5e-324, 2.0**53 - 1, 2.0**53, 1e300, INFINITY]


def test_pow_follows_the_special_cases_of_c99():
    pairs = [
        (x, y)
        for x in [*SPECIAL, *(-v for v in SPECIAL), NAN]
        for y in [*SPECIAL, *(-v for v in SPECIAL), NAN]
        if c99_power(x, y) is not None
    ]
    assert len(pairs) > 250
    x, y = np.array(pairs).T
    for (a, b), value in zip(pairs, computed("pow", x, y), strict=True):
        assert same(value, c99_power(a, b)), f"pow({a}, {b}) = {value}"


@pytest.mark.parametrize(
    ("x", "y", "expected"),
    [
        (-2.0, 3.0, -8.0),
        (-2.0, -3.0, -0.125),
        (-2.0, 4.0, 16.0),
        (-1.0, 2.0**53 - 1, -1.0),
        (-1.0, 2.0**53, 1.0),
        (-1.0, 1e300, 1.0),
        (2.0, 1024.0, INFINITY),
        (-2.0, 1025.0, -INFINITY),
        (2.0, -1074.0, 5e-324),
        (-2.0, -1077.0, -0.0),
        (0.5, 1e300, 0.0),
        (1.0 - 2.0**-53, 1e300, 0.0),
        (1.0 + 2.0**-52, 1e300, INFINITY),
        (5e-324, -1e300, INFINITY),
    ],
)
def test_signs_and_overflow_of_pow(x, y, expected):
    assert same(computed("pow", [x], [y])[0], expected)


@pytest.mark.parametrize("name", ["exp", "log", "pow"])
def test_casadi_differs_by_one_unit_at_most(name):
    """Both are within 0.7 units of the truth, so no double lies between them."""
    random = np.random.default_rng(5)
    x, y = random.uniform(0, 100, 2000), random.uniform(-3, 3, 2000)
    given = [x, y][: LIBRARY[name]]
    _, outputs, _ = law(name).function.map(2000)(
        np.zeros((0, 2000)), np.vstack(given), np.zeros((0, 2000))
    )
    theirs = np.array(outputs)[0]
    ours = computed(name, *given)
    assert np.all(np.abs(ours - theirs) <= np.spacing(np.maximum(np.abs(ours), np.abs(theirs))))


def bits(values):
    return np.where(np.isnan(values), np.nan, values).view(np.int64)


@pytest.mark.parametrize("name", sorted(ERROR_BOUND))
def test_one_lane_and_many_agree_bit_for_bit(name):
    random = np.random.default_rng(4)
    x = np.concatenate([2.0 ** random.uniform(-1074, 1023, 3000), random.normal(size=3000) * 300])
    y = random.normal(size=6000) * 2.0 ** random.integers(-10, 10, 6000)
    x = np.where(random.random(6000) < 0.1, np.round(x), x)
    y = np.where(random.random(6000) < 0.3, np.round(y), y)
    given = [x, y][: LIBRARY[name]]
    many = bits(computed(name, *given))
    for lanes in (1, 3, 16):
        assert np.array_equal(bits(computed(name, *given, lanes=lanes)), many)


@pytest.mark.thorough
def test_calls_that_are_replaced_and_calls_that_are_kept_agree_bit_for_bit():
    """Forty uses are more than are replaced by their code; the constant base is folded there."""
    many = step_law(
        "many",
        inputs=[Signal("x")],
        parameters=[],
        state=[],
        outputs=[Signal(f"y{i}") for i in range(40)],
        equations=lambda s: Equations(
            {}, {f"y{i}": ca.power(2.5, s["x"] + 1e-3 * i) for i in range(40)}
        ),
    )
    x = np.random.default_rng(6).uniform(-300, 300, 37)
    for lanes in (1, 8):
        kernel = Kernel(program_of(many), individual=["x"], lanes=lanes)
        run = kernel.run(1, inputs={"x": x[:, None]}, threads=1)
        for i in range(40):
            expected = computed("pow", np.full(37, 2.5), x + 1e-3 * i)
            assert np.array_equal(run.output(f"y{i}")[:, 0], expected)
