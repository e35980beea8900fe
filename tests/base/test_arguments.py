"""Arguments of the wrong type are refused in one short message."""

import numpy as np
import pytest

from clepsydra import InputError, Signal
from clepsydra.base.arguments import require_type


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
