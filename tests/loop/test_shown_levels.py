"""Levels as a run shows them, of vessels with a height and of those without."""

from types import SimpleNamespace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.loop.shown_levels import shown_levels


@pytest.mark.parametrize(("high", "shown"), [(5.0, [0.0, -1.0]), (np.inf, [-1e-3, -1.0])])
def test_only_what_is_little_beside_the_height_is_no_level(high, shown):
    level = cl.Signal("pond.level", "m", low=0.0, high=high)
    process = SimpleNamespace(state=(level,), levels=(level.name,))
    found = shown_levels(process, {level.name: np.array([-1e-3, -1.0])})
    assert found[level.name].tolist() == shown
