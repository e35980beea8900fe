"""The shared blocks at their edges."""

import math

import casadi as ca
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import PidForm
from clepsydra.controllers.blocks.anti_windup import next_in_force, tracking_share
from clepsydra.controllers.blocks.status import STATUS_BITS, read_status, status_word
from clepsydra.controllers.blocks.validity import is_number, is_time_step, limit, value_or_zero


def evaluated(law, *numbers):
    """Build the block as an SX function first, where expressions may be folded."""
    symbols = [ca.SX.sym(f"x{k}") for k in range(len(numbers))]
    return float(ca.Function("block", symbols, [law(*symbols)])(*numbers))


@pytest.mark.parametrize(
    ("value", "valid"),
    [
        (0.0, 1),
        (-1e300, 1),
        (1e300, 1),
        (math.nextafter(1e300, math.inf), 0),
        (math.inf, 0),
        (-math.inf, 0),
        (math.nan, 0),
    ],
)
def test_a_number_is_told_from_what_is_none(value, valid):
    assert evaluated(is_number, value) == valid
    assert evaluated(lambda x: value_or_zero(x, is_number(x)), value) == (value if valid else 0.0)


@pytest.mark.parametrize(
    ("value", "valid"), [(1e-9, 1), (0.0, 0), (-1.0, 0), (math.inf, 0), (math.nan, 0)]
)
def test_a_time_step_is_a_number_above_zero(value, valid):
    assert evaluated(is_time_step, value) == valid


def test_a_limit_that_is_not_a_number_is_passed_over():
    assert evaluated(limit, 4.0, math.nan, 3.0) == 3.0
    assert evaluated(limit, -4.0, -3.0, math.nan) == -3.0


@pytest.mark.parametrize(
    ("increment", "unlimited", "expected"),
    [
        (0.5, 12.0, 3.0),  # pushes on above the high limit
        (-0.5, 12.0, 2.5),  # comes back from it
        (-0.5, -1.0, 3.0),  # pushes on below the low limit
        (0.5, -1.0, 3.5),  # comes back from it
        (0.5, 7.0, 3.5),  # inside the limits
    ],
)
def test_conditional_integration_leaves_out_only_what_pushes_further(
    increment, unlimited, expected
):
    limited = min(max(unlimited, 0.0), 10.0)

    def following(integral, increment, unlimited, limited):
        s = {
            "integral_used": integral,
            "increment": increment,
            "proportional": unlimited - integral,
        }
        return next_in_force("conditional_integration", s, limited)

    assert evaluated(following, 3.0, increment, unlimited, limited) == expected


def test_the_share_is_never_above_one_even_at_a_tracking_time_of_zero():
    assert evaluated(tracking_share, 1.0, 0.0) == 1.0
    assert evaluated(tracking_share, 1.0, 8.0) == 0.125


def test_every_status_word_reads_back():
    symbols = ca.SX.sym("conditions", len(STATUS_BITS))
    word = ca.Function(
        "word",
        [symbols],
        [status_word({name: symbols[k] for k, name in enumerate(STATUS_BITS)})],
    )
    for number in range(2 ** len(STATUS_BITS)):
        held = [number >> k & 1 for k in range(len(STATUS_BITS))]
        assert int(word(held)) == number
        assert read_status(number) == tuple(
            name for name, one in zip(STATUS_BITS, held, strict=True) if one
        )


@pytest.mark.parametrize("anti_windup", ["foo", "", None, ["conditional_integration"]])
def test_a_law_with_an_unknown_anti_windup_is_refused(anti_windup):
    with refused(place="anti_windup", expected="one of back_calculation"):
        PidForm(anti_windup=anti_windup)
    with refused(place="anti_windup", expected="one of back_calculation"):
        cl.design.lqi(cl.load("quadruple-tank"), anti_windup=anti_windup)
