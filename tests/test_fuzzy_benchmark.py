"""The fuzzy benchmark's routes agree, and its page tells what was measured."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks import fuzzy, page
from benchmarks.experiments import Disagreement

# scikit-fuzzy, where it is installed, calls NumPy as it was.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:skfuzzy")


@pytest.fixture
def few_scenarios(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fuzzy, "SCENARIOS", 32)
    monkeypatch.setattr(fuzzy, "SAMPLES", 20)


@pytest.mark.thorough
@pytest.mark.usefixtures("few_scenarios")
def test_the_kernel_agrees_with_plain_python_and_is_told_on_the_page() -> None:
    found = fuzzy.measure(1)
    assert 0.0 < found.difference < 1e-13
    assert "| Clepsydra, whole step law, batch |" in page._fuzzy(found)


@pytest.mark.usefixtures("few_scenarios")
def test_ways_that_disagree_are_not_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    right = fuzzy._sums
    monkeypatch.setattr(fuzzy, "_sums", lambda *given: right(*given) + 1e-6)
    with pytest.raises(Disagreement, match="plain Python"):
        fuzzy.measure(1)


def test_the_centroid_below_straight_lines_is_that_of_the_trapezoid() -> None:
    """A triangle over 0 to 3 with its top at 1, clipped at a half from 0.5 to 2."""
    triangle = SimpleNamespace(degrees=lambda x: np.interp(x, [0.0, 1.0, 3.0], [0.0, 1.0, 0.0]))
    u = SimpleNamespace(sets={"T": triangle})
    parts = [(0.5 * 0.5 / 2, 1 / 3), (1.5 * 0.5, 1.25), (1.0 * 0.5 / 2, 2 + 1 / 3)]
    expected = sum(area * at for area, at in parts) / sum(area for area, _ in parts)
    points = np.array([0.0, 1.0, 3.0, 4.0])
    assert fuzzy._lines(u, {"T": 0.5}, points) == pytest.approx(expected, rel=1e-14)
