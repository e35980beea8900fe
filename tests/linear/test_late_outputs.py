"""Outputs that are told late: they are what they were, at every frequency."""

import numpy as np
import pytest

from clepsydra.linear.late_outputs import late_outputs, with_late_outputs
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.response import frequency_response

RATES = np.array([0.02, 0.05])


@pytest.fixture
def tanks() -> LinearModel:
    """Two tanks side by side, each with an inflow of its own, and their sum."""
    C = np.array([[1.0, 0.0], [0.0, 2.0], [1.0, 1.0]])
    return LinearModel(
        -np.diag(RATES), np.eye(2), np.zeros((2, 0)), C, np.zeros((3, 2)),
        ("one.level", "two.level"), ("first", "second"), (), ("one", "two", "both"),
    )  # fmt: skip


def test_a_late_output_has_the_phase_of_its_dead_time(tanks):
    s = 1j * np.array([0.001, 0.02, 0.7])
    found = frequency_response(with_late_outputs(tanks, {"two": 40.0}), s.imag)
    assert found[:, 1, 1] == pytest.approx(2.0 / (s + RATES[1]) * np.exp(-40.0 * s), rel=1e-12)
    assert found[:, 0, 0] == pytest.approx(1.0 / (s + RATES[0]), rel=1e-12)


def test_lateness_is_taken_off_and_put_on_again(tanks):
    ages = {"two": 40.0, "both": 12.5}
    late = with_late_outputs(tanks, ages)
    found = late_outputs(late)
    assert found.ages == ages
    assert np.array_equal(found.prompt.matrix, tanks.matrix)
    assert np.array_equal(with_late_outputs(found.prompt, ages).matrix, late.matrix)


def test_a_part_of_the_outputs_has_their_lateness_alone(tanks):
    late = with_late_outputs(tanks, {"two": 40.0, "both": 12.5})
    assert late.select(["both"]).times.tolist() == [12.5]
    assert late.select(["one"]).delays is None
