"""Arguments of the wrong type are refused in one short message."""

import numpy as np
import pytest

from clepsydra import InputError, Signal
from clepsydra.base.arguments import is_finite_number, require_type


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (3, "got 3,"),
        (None, "got None,"),
        ("x" * 1000, f"got '{'x' * 60}',"),
        (np.zeros((1000, 1000)), "got 'a ndarray',"),
        (InputError("a", "b", "c", "d"), "got 'an InputError',"),
    ],
)
def test_the_message_shows_what_was_given_but_no_whole_array(value, shown):
    with pytest.raises(InputError) as refusal:
        require_type(value, Signal, "plot", "a Signal", "give one")
    assert str(refusal.value).startswith(f"plot: {shown} expected a Signal; give one.")


def test_the_right_type_passes():
    require_type(Signal("level_1"), Signal, "plot", "a Signal", "give one")
    require_type("level_1", (str, Signal), "plot", "a Signal", "give one")


@pytest.mark.parametrize(
    ("value", "finite"),
    [(3, True), (-0.5, True), (10**400, False), (float("inf"), False), (True, False), ("3", False)],
)
def test_what_is_a_finite_number(value, finite):
    """A whole number that is too large for a floating-point one is none, and no crash."""
    assert is_finite_number(value) == finite
